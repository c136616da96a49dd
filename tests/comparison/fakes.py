"""A comparison in a moment: made-up trials instead of simulated ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from costeer.comparison.design import ComparisonSettings
from costeer.loop.scenario import TrialSetup
from costeer.methods.registry import method_named
from costeer.records.columns import TrialRecord
from tests.study.synthetic import synthetic_record

SMALL = ComparisonSettings(
    methods=("manual", "ibhs"),
    scenarios=("expressway", "cut-in"),
    participants=12,
    length=1800.0,
)
NUM_TRIALS = 2 * 2 * 12
NUM_BLOCKS = 2 * 2 * 2


@lru_cache(maxsize=64)
def _drive(condition: str, participant: int, seed: int, length: float) -> TrialRecord:
    return synthetic_record(condition, participant, seed, length)


def made_up(setup: TrialSetup) -> TrialRecord:
    """A record that depends on the setup alone, as a simulated one does."""
    method = method_named(setup.method)
    condition = setup.condition if method.assists else "manual"
    record = _drive(condition, setup.participant, setup.seed, float(setup.length))
    columns = record.columns
    # Traffic of the scenario: in a cut-in, every third driver hits what cuts in.
    hit = setup.scenario == "cut-in" and setup.participant % 3 == 0
    contact = np.zeros(len(columns["time"]), np.int8)
    if hit and not method.assists:
        contact[-30:] = 3
    return record._replace(
        metadata={**record.metadata, "method": method.name},
        columns={**columns, "contact": contact},
    )


def counted() -> tuple[list[TrialSetup], Callable[[TrialSetup], TrialRecord]]:
    """A list, and a simulation that enters what it was asked for."""
    asked: list[TrialSetup] = []

    def simulate(setup: TrialSetup) -> TrialRecord:
        asked.append(setup)
        return made_up(setup)

    return asked, simulate


def after(calls: int, error: BaseException) -> Callable[[TrialSetup], TrialRecord]:
    """A simulation that fails when it is called once more than `calls` times."""
    asked, simulate = counted()

    def failing(setup: TrialSetup) -> TrialRecord:
        if len(asked) == calls:
            raise error
        return simulate(setup)

    return failing
