"""Drives of people for tables, tests and report: a study without `study.yaml`.

Where they come from does not matter here: a session with its plan and answers, or a
plain folder of records with pseudonyms.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import read_record
from costeer.study.answers import answer_tests
from costeer.study.folder import StudyFolder, configuration_hash
from costeer.study.measures import (
    Row,
    lane_change_rows,
    scenario_measure_rows,
    trial_row,
    trigger_rows,
)
from costeer.study.outcome import StudyTests
from costeer.study.quantities import WORKLOAD, WORKLOAD_ITEMS
from costeer.study.trial_tables import TrialRows, write_csv, write_trial_tables

Who = int | str
"""A participant: the number of a virtual driver, or the pseudonym of a person."""

EXCLUSIONS_FILE = "exclusions.csv"


class Drive(NamedTuple):
    """One trial that counts.

    Attributes:
        participant: Pseudonym.
        condition: Of Table IV.
        record: Its file.
        order: Place among the participant's trials, from 1; None if it is not known.
        scores: Of the NASA-TLX after it, by column of `trials.csv`.
        items: Answers to its six items, by name.
        label: Names it among all trials of the participant; empty without a plan.
        scenario: That was driven on; empty without a plan.
        occasion: How often its condition was planned on its scenario so far, from 1.
    """

    participant: str
    condition: str
    record: Path
    order: int | None = None
    scores: Mapping[str, float] = {}
    items: Mapping[str, float] = {}
    label: str = ""
    scenario: str = ""
    occasion: int = 1

    @property
    def series(self) -> Series:
        """What it is compared within."""
        return self.scenario, self.occasion

    @property
    def name(self) -> str:
        """Of the trial, for files."""
        return self.label or self.condition


Series = tuple[str, int]
"""Scenario and occasion: drives of one series are compared with each other."""


class Exclusion(NamedTuple):
    """A drive that is not in the tables, or one that there should be.

    Attributes:
        participant: Pseudonym.
        step: Of the session; empty without one.
        condition: Of the drive.
        attempt: Number of the attempt; empty for a drive that there is not.
        state: `excluded`, `aborted`, `dropped out`, `skipped`, `missing` or
            `unreadable`.
        reason: Why.
        utc: When the attempt began, ISO 8601 in UTC; empty if it is not known.
        label: Of the trial, as in `trials.csv`; empty without a plan.
        scenario: Of the trial; empty without a plan.
        occasion: Of its condition on its scenario, from 1.
    """

    participant: str
    step: str
    condition: str
    attempt: str
    state: str
    reason: str
    utc: str = ""
    label: str = ""
    scenario: str = ""
    occasion: int = 1

    @property
    def series(self) -> Series:
        """Of the trial."""
        return self.scenario, self.occasion


class People(NamedTuple):
    """People who drove.

    Attributes:
        study: The folder and what was planned.
        drives: Trials that count, in the order of the tables.
        exclusions: What does not, and what there is not.
        said: Sentences for the methods, on participants and devices.
        num_withdrawn: Participants who withdrew; nothing else is known of them.
        again: Trials of the same scenario whose condition was driven before; they are
            compared with that one alone.
        apart: Other series, each for a report of its own, by name.
        which: A sentence on which of several series this is; empty if it is the only
            one.
    """

    study: StudyFolder
    drives: tuple[Drive, ...]
    exclusions: tuple[Exclusion, ...] = ()
    said: tuple[str, ...] = ()
    num_withdrawn: int = 0
    again: tuple[Drive, ...] = ()
    apart: Mapping[str, People] = {}
    which: str = ""

    @property
    def all_drives(self) -> tuple[Drive, ...]:
        """Trials of this and all other series."""
        others = [each for part in self.apart.values() for each in part.drives]
        found = dict.fromkeys(each.record for each in self.drives)
        more = [d for d in (*self.again, *others) if d.record not in found]
        return (*self.drives, *{each.record: each for each in more}.values())

    @property
    def records(self) -> dict[tuple[Who, str], Path]:
        """Path of each record by participant and condition."""
        return {(each.participant, each.condition): each.record for each in self.drives}


def people_study(folder: Path, configuration: Mapping[str, Any]) -> StudyFolder:
    """What stands for `study.yaml`; Any: plain JSON values."""
    plain = dict(configuration)
    return StudyFolder(folder, plain, configuration_hash(plain))


def in_order(drives: Iterable[Drive]) -> tuple[Drive, ...]:
    """Drives by participant and in the order of Table IV, each cell once.

    Raises:
        ValueError: If two drives claim the same cell.
    """
    place = {name: at for at, name in enumerate(CONDITION_NAMES)}
    ordered = sorted(
        drives, key=lambda each: (natural(each.participant), place[each.condition])
    )
    cells: dict[tuple[str, str, Series], Drive] = {}
    for each in ordered:
        cell = each.participant, each.condition, each.series
        other = cells.setdefault(cell, each)
        if other is not each:
            raise ValueError(
                f"{other.record.name} and {each.record.name} are both of participant "
                f"{each.participant}, {each.condition}; one trial of each condition "
                "counts: exclude one, or move it out of the folder"
            )
    return tuple(ordered)


def natural(name: str) -> tuple[tuple[str, int], ...]:
    """Key that puts P2 before P10."""
    parts = re.findall(r"(\D*)(\d*)", name)
    return tuple((word, int(digits or 0)) for word, digits in parts)


def write_people_tables(folder: Path, people: People) -> None:
    """Write the three tables of a study and `exclusions.csv`.

    The columns are those of a virtual study; the scores of the NASA-TLX come last.

    Args:
        folder: To write in.
        people: Whose drives.

    Raises:
        ValueError: If no trial counts, or a record cannot be read.
        OSError: If a file cannot be read or written.
    """
    if not people.drives:
        raise ValueError(
            f"{people.study.path} has no trial that counts; drive one to its end, or "
            "include one that was excluded"
        )
    write_trial_tables(folder, [_rows_of(each) for each in people.all_drives])
    write_exclusions(folder, people.exclusions)


def write_exclusions(folder: Path, exclusions: Sequence[Exclusion]) -> None:
    """Write `exclusions.csv`."""
    rows = [each._asdict() for each in exclusions]
    write_csv(folder / EXCLUSIONS_FILE, rows, Exclusion._fields)


def _rows_of(drive: Drive) -> TrialRows:
    found = read_record(drive.record)
    about = {"participant": drive.participant, "condition": drive.condition}
    record = found._replace(metadata={**found.metadata, **about})
    scores = {each.name: drive.scores.get(each.name) for each in WORKLOAD}
    which = {
        "label": drive.label,
        "scenario": drive.scenario,
        "occasion": drive.occasion,
    }
    told = which if drive.label else {}
    ended = {"ended_by": ended_by(record.metadata)} if drive.label else {}

    def labelled(rows: list[Row]) -> list[dict[str, object]]:
        return [{**row, **told} for row in rows]

    return TrialRows(
        measures={**trial_row(record, drive.order), **scores, **told, **ended},
        lane_changes=labelled(lane_change_rows(record)),
        triggers=labelled(trigger_rows(record)),
        scenario=labelled(scenario_measure_rows(record)),
    )


def ended_by(metadata: Mapping[str, object]) -> str:
    """What ended a drive: course, collision or server; empty if it is not told."""
    markers = metadata.get("markers")
    ends = [
        str(each.get("name", ""))
        for each in (markers if isinstance(markers, list | tuple) else ())
        if isinstance(each, Mapping) and each.get("kind") == "ended"
    ]
    return ends[-1] if ends else ""


def tested_answers(people: People) -> StudyTests | None:
    """Tests of the six items of the NASA-TLX by condition; None without answers."""
    rows = [
        (each.participant, each.condition, item.name, each.items[item.name])
        for item in WORKLOAD_ITEMS
        for each in people.drives
        if item.name in each.items
    ]
    if not rows:
        return None
    names = ("participant", "condition", "item", "value")
    columns = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
    return answer_tests(columns)
