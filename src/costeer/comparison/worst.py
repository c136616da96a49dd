"""The worst drive of each method, driven again and kept as a record to replay."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.comparison.design import Cell, ComparisonSettings, Plan, setup_of
from costeer.comparison.folder import ComparisonFolder, cell_name
from costeer.comparison.measures import COLUMNS
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results, gathered
from costeer.plant.place import BARRIER, CAR
from costeer.records.columns import TrialRecord
from costeer.records.record import read_record, write_record
from costeer.study.lane_keeping import lane_departures
from costeer.study.measures import prepared
from costeer.study.trial_tables import write_csv
from costeer.study.trials import Simulate

WORST = "worst"
WORST_FILE = "worst.csv"
MOST_WORST = 12
"""Records that are kept [-]."""

HASH_FIELD = "comparison_hash"
"""Metadata of a record that binds it to the comparison."""


class WorstCase(NamedTuple):
    """A row of `worst.csv`.

    Attributes:
        method: Whose.
        scenario: Where.
        mistake: With what mistake.
        participant: Number of the driver.
        num_collisions: In the drive.
        num_lane_departures: In the drive.
        what: The first thing that happened: "car", "barrier" or "departure".
        time: When [s].
        position: Where along the road [m].
        record: File in `worst/`.
    """

    method: str
    scenario: str
    mistake: str
    participant: int
    num_collisions: int
    num_lane_departures: int
    what: str
    time: float
    position: float
    record: str


class _Drive(NamedTuple):
    """A drive in which something happened, the worst first in order."""

    collisions: float
    departures: float
    cell: Cell
    participant: int

    @property
    def badness(self) -> tuple[float, float, int, int]:
        """Sorts the worst first; ties by their place in the tables."""
        place = self.cell.number, self.participant
        return (-self.collisions, -self.departures, *place)


def worst_drives(results: Results, plan_cells: Sequence[Cell]) -> list[_Drive]:
    """Of each method the worst drive without and the worst with a mistake.

    A collision is worse than any number of departures; a drive without either is not
    among them.
    """
    hit = COLUMNS.index("num_collisions")
    left = COLUMNS.index("num_lane_departures")
    kept: dict[tuple[str, bool], _Drive] = {}
    for cell in plan_cells:
        table = results.values.get((cell.course.name, cell.mistake, cell.entrant.name))
        for place, row in enumerate(np.nan_to_num(table) if table is not None else ()):
            drive = _Drive(float(row[hit]), float(row[left]), cell, place + 1)
            if drive.collisions + drive.departures <= 0.0:
                continue
            key = cell.entrant.name, cell.mistake != NONE
            if key not in kept or drive.badness < kept[key].badness:
                kept[key] = drive
    return sorted(kept.values(), key=lambda drive: drive.badness)[:MOST_WORST]


def write_worst(
    folder: ComparisonFolder,
    settings: ComparisonSettings,
    plan: Plan,
    simulate: Simulate,
) -> None:
    """Drive the worst cases again, and write their records and `worst.csv`.

    A record that is there already is kept.

    Raises:
        OSError: If a file cannot be written.
    """
    home = folder.path / WORST
    home.mkdir(exist_ok=True)
    cases = []
    for drive in worst_drives(gathered(folder), plan.cells):
        name = f"{cell_name(drive.cell)}-{drive.participant:05d}.parquet"
        record = _believed(home / name, folder.hash)
        if record is None:
            made = simulate(setup_of(settings, drive.cell, drive.participant))
            about = {**made.metadata, HASH_FIELD: folder.hash}
            record = made._replace(metadata=about)
            write_record(home / name, record)
        cases.append(_case(drive, record, name))
    for old in home.glob("*.parquet"):
        if old.name not in [each.record for each in cases]:
            old.unlink()
    rows = [each._asdict() for each in cases]
    write_csv(folder.path / WORST_FILE, rows, WorstCase._fields)


def _believed(path: Path, hashed: str) -> TrialRecord | None:
    """The record on disk if it is whole and of this comparison."""
    try:
        record = read_record(path)
    except (ValueError, FileNotFoundError):
        return None
    return record if record.metadata.get(HASH_FIELD) == hashed else None


def _case(drive: _Drive, record: TrialRecord, name: str) -> WorstCase:
    what, row = first_event(record)
    columns = record.columns
    return WorstCase(
        method=drive.cell.entrant.name,
        scenario=drive.cell.course.name,
        mistake=drive.cell.mistake,
        participant=drive.participant,
        num_collisions=int(drive.collisions),
        num_lane_departures=int(drive.departures),
        what=what,
        time=float(columns["time"][row]),
        position=float(columns["longitudinal_position"][row]),
        record=name,
    )


def first_event(record: TrialRecord) -> tuple[str, int]:
    """The first collision of a record, else its first departure, and its row."""
    contact = np.ma.filled(np.ma.asarray(record.columns["contact"]), 0)
    hit = np.flatnonzero(contact >= BARRIER)
    if hit.size:
        row = int(hit[0])
        return ("car" if contact[row] == CAR else "barrier"), row
    trial = prepared(record)
    if isinstance(trial.segments, str):
        return "", 0
    found = lane_departures(
        trial.columns, trial.speed, trial.segments, trial.parameters
    )
    return ("departure", found[0].start) if found else ("", 0)
