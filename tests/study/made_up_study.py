"""Tables of a study with made-up numbers, shaped as a real one's."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.outcome import StudyTests
from costeer.study.statistics import study_tests

Columns = dict[str, NDArray[np.generic]]

TRIAL_MEASURES = ("sdlp", "swrr", "driver_torque_rms")
CHANGE_MEASURES = (
    "overshoot",
    "steering_velocity_rms",
    "peak_steering_angle",
    "duration",
)


def made_up_study(
    num_participants: int = 12,
    conditions: Sequence[str] = CONDITION_NAMES,
    num_changes: int = 8,
    seed: int = 1,
    effect: float = 0.5,
) -> tuple[Columns, Columns]:
    """Return trials and lane changes of participants who differ from each other.

    Args:
        num_participants: How many, numbered from 1.
        conditions: What each drove.
        num_changes: Lane changes per trial.
        seed: Of all numbers.
        effect: How much each condition adds to the one before.
    """
    rng = np.random.default_rng(seed)
    who, where = np.divmod(
        np.arange(num_participants * len(conditions)), len(conditions)
    )
    trials: Columns = {"participant": who + 1, "condition": np.array(conditions)[where]}
    changes = {name: np.repeat(column, num_changes) for name, column in trials.items()}
    changes["index"] = np.tile(np.arange(num_changes), who.size)
    for table, measures, repeats in (
        (trials, TRIAL_MEASURES, 1),
        (changes, CHANGE_MEASURES, num_changes),
    ):
        for measure in measures:
            person = rng.normal(size=num_participants)[who]
            cell = person + effect * where + rng.normal(size=who.size)
            noise = rng.normal(size=who.size * repeats)
            table[measure] = 10.0 + np.repeat(cell, repeats) + noise
    return trials, changes


@cache
def usual_outcome() -> StudyTests:
    """What is found in the study that most tests look at."""
    return study_tests(*made_up_study())


def without(table: Columns, rows: NDArray[np.bool_]) -> Columns:
    """Return the table without these rows."""
    return {name: column[~rows] for name, column in table.items()}
