"""Everything of a study but its records, made again: tables, tests, figures, report."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

from costeer.records.metadata import PERSON
from costeer.records.record import read_record
from costeer.study.folder import read_study, record_path
from costeer.study.locks import locked
from costeer.study.material import find_records
from costeer.study.people import People, write_people_tables
from costeer.study.report import write_report
from costeer.study.run import remake_tables, settings_in
from costeer.study.trial_tables import TRIALS_FILE
from costeer.study.trials import study_trials


def remake_report(
    folder: Path,
    tell: Callable[[str], None],
    people: People | None = None,
    beside: Path | None = None,
) -> Path:
    """Make tables, tests, figures and `report.html` of a study again.

    The tables of a study with people stay as they are: they hold answers that no
    record knows. Those of virtual drivers are measured again from the records.

    Args:
        folder: Of the study.
        tell: Called with a few words before each step.
        people: Whose drives these are, where there is no `study.yaml`.
        beside: Folder of virtual drivers to compare with.

    Returns:
        Path of `report.html`.

    Raises:
        ValueError: If it is no study, in use, or has no trial that can be read.
        OSError: If a file cannot be read or written.
    """
    if people is not None:
        tell("measures")
        write_people_tables(folder, people)
        return write_report(folder, tell, people, beside)
    read_study(folder)
    if not holds_human_trials(folder):
        tell("measures")
        remake_tables(folder)
    with locked(folder):
        return write_report(folder, tell, beside=beside)


def holds_human_trials(folder: Path) -> bool:
    """Whether the first record of the folder that can be read is a person's."""
    for path in find_records(folder).values():
        try:
            return read_record(path, ()).metadata["driver_kind"] == PERSON
        except ValueError:
            continue  # cut short by a crash: the next one tells
    return False


def trials_without_record(folder: Path) -> list[str]:
    """Name the records of a study of virtual drivers that are missing or damaged.

    Args:
        folder: Of the study, after its report was made.

    Returns:
        Paths within the folder, each with what is wrong.

    Raises:
        ValueError: If it is no study.
        OSError: If a file cannot be read.
    """
    if holds_human_trials(folder):
        return []
    with (folder / TRIALS_FILE).open(encoding="utf-8", newline="") as file:
        there = {(row["participant"], row["condition"]) for row in csv.DictReader(file)}
    missing = []
    for trial in study_trials(settings_in(read_study(folder))):
        if (str(trial.participant), trial.condition) not in there:
            path = record_path(folder, trial.participant, trial.condition)
            state = "damaged or of another study" if path.exists() else "missing"
            missing.append(f"{path.relative_to(folder)} ({state})")
    return missing
