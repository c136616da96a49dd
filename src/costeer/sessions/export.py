"""A study with people for other programs: CSV, BIDS, MATLAB, MCAP, an artifact."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from costeer.base.files import prepare_folder
from costeer.records.record import read_record
from costeer.sessions.answered import answer_rows, answers_in
from costeer.sessions.fields import FIELDS, PARTICIPANTS_FILE, QUESTIONNAIRES_FILE
from costeer.sessions.people import people_in
from costeer.sessions.session import Session
from costeer.sessions.tables import participant_rows, write_all
from costeer.study.people import Drive, People

FORMATS = ("csv", "bids", "matlab", "mcap", "autoui", "all")


def export_session(folder: Path, to: str, out: Path) -> People:
    """Write the data of a session for other programs.

    Only trials that count are written; `exclusions.csv` says of the others.

    Args:
        folder: Of the session.
        to: One of `FORMATS`; `all` writes each into a folder of its own.
        out: A new or empty folder: one that is written over could keep the data of
            somebody who has withdrawn since.

    Returns:
        Whose data were written.

    Raises:
        ValueError: If there is no such format, the folder is not empty, or the session
            cannot be exported.
        OSError: If a file cannot be read or written.
        ModuleNotFoundError: If a package that MCAP needs is not installed.
    """
    if to not in FORMATS:
        raise ValueError(f"--format is {to}; choose one of {', '.join(FORMATS)}")
    _check_out(folder, out)
    if to != "all":
        return _WRITERS[to](folder, out)
    for name, write in _WRITERS.items():
        (out / name).mkdir()
        people = write(folder, out / name)
    return people


def _check_out(folder: Path, out: Path) -> None:
    """Refuse a folder that holds something.

    Raises:
        ValueError: If it does.
        OSError: If it cannot be made.
    """
    if out.is_dir() and any(out.iterdir()):
        raise ValueError(
            f"--out is {out}, which is not empty; give a new folder: an older export "
            "may hold data of who has withdrawn since, delete it"
        )
    if folder.resolve() in (out.resolve(), *out.resolve().parents):
        raise ValueError(f"--out is {out}, within the study; give a folder outside")
    prepare_folder(out, ".export", "export")


def _csv(folder: Path, out: Path) -> People:
    return write_all(folder, out)


def _matlab(folder: Path, out: Path) -> People:
    from costeer.export.matlab import write_matlab

    people = _people(folder)
    for drive in people.all_drives:
        write_matlab(read_record(drive.record), out / f"{_stem(drive)}.mat")
    return people


def _mcap(folder: Path, out: Path) -> People:
    from costeer.export.mcap import write_mcap

    people = _people(folder)
    for drive in people.all_drives:
        write_mcap(read_record(drive.record), out / f"{_stem(drive)}.mcap")
    return people


def _stem(drive: Drive) -> str:
    return f"{drive.participant}-{drive.name}"


def _people(folder: Path) -> People:
    session = Session(folder)
    try:
        return people_in(session, answers_in(session))
    finally:
        session.close()


def _bids(folder: Path, out: Path) -> People:
    from costeer.export.bids import BidsStudy, BidsTable, BidsTrial, write_bids

    session = Session(folder)
    try:
        answered = answers_in(session)
        people = people_in(session, answered)
        persons = participant_rows(session, people)
        answers = answer_rows(answered)
        title = session.plan.title
    finally:
        session.close()
    demographics = _demographics(answers)
    rows = [row | demographics.get(row["participant"], {}) for row in persons]
    with tempfile.TemporaryDirectory() as room:
        write_all(folder, Path(room))
        study = BidsStudy(
            name=title,
            version=version("costeer"),
            readme=_README.format(title=title),
            participants=BidsTable(rows, _about(PARTICIPANTS_FILE) | _DEMOGRAPHICS),
            answers=BidsTable(answers, _about(QUESTIONNAIRES_FILE)),
            trials=[
                BidsTrial(d.participant, d.name, d.record, _kept(d.record))
                for d in people.all_drives
            ],
            tables=sorted(Path(room).glob("*.csv")),
        )
        write_bids(study, out)
    return people


def _autoui(folder: Path, out: Path) -> People:
    from costeer.export.autoui import Artifact, write_artifact

    session = Session(folder)
    try:
        people = people_in(session, answers_in(session))
        title = session.plan.title
    finally:
        session.close()
    with tempfile.TemporaryDirectory() as room:
        write_all(folder, Path(room))
        artifact = Artifact(
            title=title,
            version=version("costeer"),
            records={f"{_stem(d)}.parquet": d.record for d in people.drives},
            tables=sorted(Path(room).glob("*.csv")),
        )
        write_artifact(artifact, out)
    return people


def _kept(record: Path) -> tuple[Path, ...]:
    """The record and, if there is one, the trace of the wheel."""
    trace = record.with_suffix(".wheel.parquet")
    return (record, trace) if trace.is_file() else (record,)


def _about(file: str) -> dict[str, dict[str, str]]:
    """What the columns of a table are, as BIDS has it."""
    return {
        each.column: {"Description": f"{each.meaning} ({each.range})"}
        | ({"Units": each.unit} if each.unit != "-" else {})
        for each in FIELDS[file]
        if each.column != "participant"
    }


_DEMOGRAPHICS = {
    "age": {"Description": "as told in the questionnaire", "Units": "year"},
    "gender": {"Description": "as told in the questionnaire"},
}


def _demographics(answers: list[dict[str, object]]) -> dict[object, dict[str, object]]:
    found: dict[object, dict[str, object]] = {}
    for row in answers:
        if row["instrument"] == "demographics" and row["item"] in _DEMOGRAPHICS:
            own = found.setdefault(row["participant"], {})
            own[str(row["item"])] = row["value"]
    return found


_README = """{title}

A study of haptic guidance in a driving simulator, written by costeer. Participants are
pseudonyms; there is no name, no e-mail and no date of birth in it.

motion/: a trial each, 60 samples per second, a column for each channel of channels.tsv.
x is along the road, y to the left, angles are counter-clockwise seen from above.
beh/: every answer of a participant in long form.
sourcedata/: the trial records as Parquet, and the wheel at 960 Hz where there was one.
derivatives/costeer/: tables of measures, exclusions and events; codebook.csv explains
every column.
"""

_WRITERS: dict[str, Callable[[Path, Path], People]] = {
    "csv": _csv,
    "bids": _bids,
    "matlab": _matlab,
    "mcap": _mcap,
    "autoui": _autoui,
}
