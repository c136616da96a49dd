"""A participant who withdraws: everything is deleted, and only a count stays."""

from __future__ import annotations

from pathlib import Path

from costeer.devices.head.calibration import calibration_file
from costeer.sessions.session import Session

ROOMS = ("records", "practice", "aborted")
"""Folders with files of participants."""

REPORTS = "reports"
"""Folder with a folder for each series of trials that has a report of its own."""


def withdraw(session: Session, participant: str) -> int:
    """Delete all of a participant: rows, files, free pages; a count stays.

    Tables and report in the folder go too; `costeer report` makes them again. So does
    the calibration of the head under this pseudonym, which lies with the user's own
    files and not in the study.

    Returns:
        How many files were deleted.

    Raises:
        ValueError: If there is none.
        OSError: If something could not be deleted.
    """
    session.person(participant)
    files = [*files_of(session, participant), *made_of_all(session.folder)]
    for file in files:
        file.unlink()
    session.forget(participant)
    return len(files)


def files_of(session: Session, participant: str) -> list[Path]:
    """Every file of a participant: drives, streams, traces, the head's calibration."""
    found = [calibration_file(participant)]
    for room in ROOMS:
        found += sorted((session.folder / room).glob(f"{participant}-*"))
    return [file for file in found if file.is_file()]


def made_of_all(folder: Path) -> list[Path]:
    """Tables, figures and reports in a folder, which hold rows of everybody."""
    return [*_made_in(folder), *made_apart(folder)]


def made_apart(folder: Path) -> list[Path]:
    """Tables, figures and reports of other series of trials."""
    rooms = sorted((folder / REPORTS).glob("*/"))
    return [file for room in rooms for file in _made_in(room)]


def _made_in(room: Path) -> list[Path]:
    made = [*room.glob("*.csv"), *(room / "figures").glob("*.*")]
    return [*made, *room.glob("report.html")]


def num_withdrawn(session: Session) -> int:
    """How many have withdrawn; who they were is not known any more."""
    return len(session.store.rows("SELECT number FROM withdrawn"))
