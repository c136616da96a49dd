"""A study in a moment: made-up trials instead of simulated ones."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from costeer.loop.scenario import TrialSetup
from costeer.records.record import TrialRecord
from costeer.study.configuration import StudySettings
from costeer.study.run import StudyOutcome, run_study
from tests.study.synthetic import synthetic_record

# 1800 m hold one overtaking event with its two lane changes.
SMALL = StudySettings(
    participants=2,
    conditions=("manual", "strong-rapid", "weak-gentle"),
    intention="scripted",
    length=1800.0,
)
NUM_TRIALS = 6


@lru_cache(maxsize=64)
def _drive(condition: str, participant: int, seed: int, length: float) -> TrialRecord:
    return synthetic_record(condition, participant, seed, length)


def made_up(setup: TrialSetup) -> TrialRecord:
    """A record that depends on the setup alone, as a simulated one does."""
    return _drive(setup.condition, setup.participant, setup.seed, float(setup.length))


def held_up(setup: TrialSetup, gate: str) -> TrialRecord:
    """As `made_up`, but after the first ten participants only once a file is there."""
    while setup.participant > 10 and not Path(gate).exists():
        time.sleep(0.01)
    return made_up(setup)


def plain_report(folder: Path, tell: Callable[[str], None] = print) -> None:
    """A report that depends on the tables alone."""
    tell("plain")
    tables = (folder / "trials.csv").read_bytes()
    (folder / "report.html").write_text(hashlib.sha256(tables).hexdigest())


def run_small(
    out: Path, settings: StudySettings = SMALL, jobs: int = 1
) -> StudyOutcome:
    """The small study, whole."""
    return run_study(out, settings, jobs=jobs, report=plain_report, simulate=made_up)


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below the folder, by its path there."""
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }
