"""Virtual drivers in manual driving beside human values: M1 to M12.

Only manual driving is looked at here, so that what guidance does to these drivers
stays a prediction. Human ranges: docs/decisions/0005-drivers.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.population import USUAL, Population
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.conditions import MANUAL
from costeer.records.columns import TrialRecord
from costeer.study.measures import lane_change_rows, trial_row
from costeer.validation.glances import (
    false_glance_share,
    first_glance_lead,
    glance_before_change,
)
from costeer.validation.targets import (
    MEASURES,
    TARGETS,
    TRIALS,
    Measure,
    Target,
    target_statistic,
)
from costeer.validation.threads import in_threads

Row = dict[str, Any]  # Any: as the study's tables

AGAIN = "manual-again"
"""Condition of a second manual trial: the same drivers, other noise."""

PLANNED_CHANGES = 8
"""Lane changes that the course asks of a driver: four events, out and back."""


class TargetCheck(NamedTuple):
    """One target beside what the population gives.

    Attributes:
        target: The human range.
        value: Of the population, NaN if it could not be computed.
        met: Whether it lies in the range.
    """

    target: Target
    value: Real
    met: bool


class ManualDriving(NamedTuple):
    """What a population did in manual driving.

    Attributes:
        trials: A row per driver.
        changes: A row per lane change.
        planned_changes: Lane changes that the course asks for.
        population: Who drove; its domain says which targets it is held to.
    """

    trials: list[Row]
    changes: list[Row]
    planned_changes: int
    population: Population = USUAL


def manual_record(
    seed: int,
    participant: int,
    condition: str = MANUAL,
    population: Population = USUAL,
) -> TrialRecord:
    """Drive one manual trial.

    Args:
        seed: Of the population.
        participant: Number of the driver.
        condition: Other conditions have other noise; the driver is the same.
        population: Who is drawn from.
    """
    return simulate_trial(
        TrialSetup(
            participant=participant,
            seed=seed,
            driver=population.name,
            condition=condition,
            strength_factor=0.0,
            intention="off",
        )
    )


def manual_trial(
    seed: int,
    participant: int,
    condition: str = MANUAL,
    population: Population = USUAL,
) -> tuple[Row, list[Row]]:
    """Drive one manual trial; return its row and its lane changes' rows."""
    return measured(manual_record(seed, participant, condition, population))


def measured(record: TrialRecord) -> tuple[Row, list[Row]]:
    """The row of a manual trial and its lane changes' rows, with glances."""
    changes = lane_change_rows(record)
    for change in changes:
        change["glance"] = glance_before_change(record, change)
        change["first_glance_lead"] = first_glance_lead(record, change)
    return trial_row(record) | _extent(record), changes


def _extent(record: TrialRecord) -> Row:
    """False glances, and how far the driver strayed."""
    lateral = record.columns["lateral_position"]
    return {
        "false_glance_share": false_glance_share(record),
        "lateral_minimum": float(lateral.min()),
        "lateral_maximum": float(lateral.max()),
    }


def drive_population(
    seed: int,
    num_drivers: int,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
    condition: str = MANUAL,
    population: Population = USUAL,
) -> ManualDriving:
    """Let a population drive manually, one trial each.

    Args:
        seed: Of the population.
        num_drivers: How many.
        jobs: Threads.
        progress: Called with the number of trials just done.
        condition: Other conditions have other noise; the drivers are the same.
        population: Who is drawn from.
    """
    done = in_threads(
        lambda number: manual_trial(seed, number, condition, population),
        range(1, num_drivers + 1),
        jobs,
        progress,
    )
    return gathered(done, population)


def gathered(
    done: Sequence[tuple[Row, list[Row]]], population: Population = USUAL
) -> ManualDriving:
    """The driving of a population from the rows of its trials, one a driver."""
    trials = [trial for trial, _ in done]
    changes = [change for _, own in done for change in own]
    return ManualDriving(trials, changes, PLANNED_CHANGES * len(done), population)


def rows_of(driving: ManualDriving, measure: Measure) -> list[Row]:
    """The table of a measure."""
    return driving.trials if measure.table == TRIALS else driving.changes


def compare(driving: ManualDriving) -> list[TargetCheck]:
    """Every target of the population's domain beside what the population gives."""
    found = []
    for target in TARGETS[driving.population.domain]:
        measure = MEASURES[target.name]
        values = columns_of(rows_of(driving, measure))(measure.column)
        value = target_statistic(measure, values)
        found.append(TargetCheck(target, value, _within(target, value)))
    return found


def _within(target: Target, value: Real) -> bool:
    return target.low <= value <= target.high


def missed_by(comparison: TargetCheck) -> Real:
    """How far the value lies outside the range, in the target's unit; 0 inside."""
    target, value = comparison.target, comparison.value
    return max(target.low - value, value - target.high, 0.0)


def missed_share(comparison: TargetCheck) -> Real:
    """The same as a share of the limit that is missed [-]; 0 inside."""
    target = comparison.target
    limit = target.low if comparison.value < target.low else target.high
    return missed_by(comparison) / limit


def columns_of(rows: list[Row]) -> Callable[[str], NDArray[np.float64]]:
    """A function that gives a column without its missing values."""

    def column(name: str) -> NDArray[np.float64]:
        values = np.array([row[name] for row in rows], dtype=np.float64)
        return values[np.isfinite(values)]

    return column
