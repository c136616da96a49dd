"""All emergencies driven, in threads; the worst are kept as records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from costeer.base.files import prepare_folder
from costeer.emergencies.design import (
    Emergency,
    Settings,
    planned,
    setup_of,
    undisturbed,
)
from costeer.emergencies.outcome import EmergencyRow, drive_of, outcome_of
from costeer.loop.scenario import loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.records.columns import TrialRecord
from costeer.records.record import write_record
from costeer.scale.jobs import run_jobs
from costeer.study.trial_tables import write_csv

ROWS_FILE = "emergencies.csv"
WORST = "worst"
MOST_WORST = 6
"""Records of the worst cases that are kept."""


def drive_all(
    settings: Settings, jobs: int, advance: Callable[[int], None]
) -> list[EmergencyRow]:
    """Drive all emergencies.

    Args:
        settings: Which drivers and conditions.
        jobs: Threads.
        advance: Called with the number of drives that have just been finished.

    Raises:
        ValueError: If a drive cannot be run.
        JobsStoppedError: If the work came to no end.
    """
    drives = planned(settings)
    alone = list(dict.fromkeys(map(undisturbed, drives)))

    def told(_: object) -> None:
        advance(1)

    def without(drive: Emergency) -> TrialRecord:
        return simulate_trial(setup_of(settings, drive, with_obstacle=False))

    records = dict(zip(alone, run_jobs(without, alone, jobs, told), strict=True))

    def driven(drive: Emergency) -> EmergencyRow | None:
        record = simulate_trial(setup_of(settings, drive))
        return outcome_of(drive, record, records[undisturbed(drive)])

    found = run_jobs(driven, drives, jobs, told)
    return [row for row in found if row is not None]


def num_drives(settings: Settings) -> int:
    """How many trials `drive_all` runs [-]."""
    drives = planned(settings)
    return len(drives) + len(set(map(undisturbed, drives)))


def worst_of(rows: Sequence[EmergencyRow]) -> list[EmergencyRow]:
    """Collisions that had the most time, first; one of each condition and situation."""
    hit = [row for row in rows if row.collided]
    hit.sort(key=lambda row: (-row.time_to_collision, row.participant))
    kept: dict[tuple[str, int], EmergencyRow] = {}
    for row in hit:
        kept.setdefault((row.condition, row.meant_situation), row)
    ordered = sorted(kept.values(), key=lambda row: -row.time_to_collision)
    return ordered[:MOST_WORST]


def worst_name(row: EmergencyRow) -> str:
    """Name of the record of a worst case."""
    return (
        f"{row.condition}-situation-{row.meant_situation}-"
        f"{row.suggested_speed * 3.6:.0f}kmh-{row.time_to_collision:g}s-driver-"
        f"{row.participant}.parquet"
    )


def write_outcome(
    folder: Path, settings: Settings, rows: Sequence[EmergencyRow]
) -> None:
    """Write the table of all drives and the records of the worst.

    Args:
        folder: Of `prepare`.
        settings: As they were driven.
        rows: All drives.

    Raises:
        OSError: If a file cannot be written.
    """
    write_csv(folder / ROWS_FILE, [row._asdict() for row in rows], EmergencyRow._fields)
    home = folder / WORST
    home.mkdir(exist_ok=True)
    for old in home.glob("*.parquet"):
        old.unlink()
    for row in worst_of(rows):
        record = simulate_trial(setup_of(settings, drive_of(row)))
        write_record(home / worst_name(row), record)


def prepare(folder: Path, settings: Settings) -> None:
    """Make the folder before minutes of work, if the drives can be.

    Raises:
        ValueError: If a drive cannot be, or the folder holds something else.
        OSError: If it cannot be made.
    """
    for condition in settings.conditions:
        first = next(d for d in planned(settings) if d.condition == condition)
        loop_parameters(setup_of(settings, first))
    prepare_folder(folder, ROWS_FILE, "report on emergencies")
