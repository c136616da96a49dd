"""Virtual drivers in manual driving beside human values: M1 to M12.

Only manual driving is looked at here, so that what guidance does to these drivers
stays a prediction. Human ranges: docs/decisions/0005-drivers.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.loop.columns import TrialRecord
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.study.jobs import JobsStoppedError, run_jobs
from costeer.study.measures import lane_change_rows, trial_row
from costeer.validation.glances import (
    false_glance_share,
    first_glance_lead,
    glance_before_change,
)

Row = dict[str, Any]  # Any: as the study's tables


class Target(NamedTuple):
    """A human value that the population should meet in manual driving.

    Attributes:
        name: M1 to M12.
        quantity: What it is.
        unit: Of the value as printed.
        low: Smallest accepted value.
        high: Largest accepted value.
    """

    name: str
    quantity: str
    unit: str
    low: Real
    high: Real


PLANNED_CHANGES = 8
"""Lane changes that the course asks of a driver: four events, out and back."""

TARGETS = (
    Target("M1", "SDLP, mean over drivers", "m", 0.15, 0.25),
    Target("M2", "SDLP, sd between drivers", "m", 0.03, 0.05),
    Target("M3", "steering reversals (3 deg, 0.6 Hz), mean", "1/min", 3.0, 10.0),
    Target("M4", "lane-change duration (0.1 m/s), median", "s", 5.0, 6.3),
    Target("M5", "lane-change duration (0.1 m/s), sd", "s", 1.2, 2.0),
    Target("M6", "peak steering-wheel angle, median", "deg", 3.0, 12.0),
    Target("M7", "driver torque RMS, mean over drivers", "N·m", 0.2, 0.7),
    Target("M8", "overshoot, median", "m", 0.1, 0.4),
    Target("M9", "peak lateral speed, median", "m/s", 0.75, 1.1),
    Target("M10", "onset (0.1 m/s) to crossing, median", "s", 2.0, 3.0),
    Target("M11", "changes with a glance to that side", "%", 80.0, 90.0),
    Target("M12", "6 s of straight driving with a false glance", "%", 12.0, 18.0),
)


class Comparison(NamedTuple):
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
    """

    trials: list[Row]
    changes: list[Row]
    planned_changes: int


def manual_trial(seed: int, participant: int) -> tuple[Row, list[Row]]:
    """Drive one manual trial; return its row and its lane changes' rows."""
    setup = TrialSetup(
        participant=participant, seed=seed, condition="manual", intention="off"
    )
    record = simulate_trial(setup)
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
) -> ManualDriving:
    """Let a population drive manually, one trial each.

    Args:
        seed: Of the population.
        num_drivers: How many.
        jobs: Threads.
        progress: Called with the number of trials just done.
    """
    numbers = range(1, num_drivers + 1)
    try:
        done = run_jobs(
            lambda number: manual_trial(seed, number),
            numbers,
            jobs,
            lambda _: progress(1) if progress is not None else None,
        )
    except JobsStoppedError as stopped:
        raise (stopped.__cause__ or stopped) from None
    trials = [trial for trial, _ in done]
    changes = [change for _, own in done for change in own]
    return ManualDriving(trials, changes, PLANNED_CHANGES * num_drivers)


def compare(driving: ManualDriving) -> list[Comparison]:
    """Every target beside what the population gives."""
    trial, change = columns_of(driving.trials), columns_of(driving.changes)
    values = {
        "M1": _mean(trial("sdlp")),
        "M2": _deviation(trial("sdlp")),
        "M3": _mean(trial("swrr")),
        "M4": _median(change("duration_by_speed")),
        "M5": _deviation(change("duration_by_speed")),
        "M6": math.degrees(_median(change("peak_steering_angle"))),
        "M7": _mean(trial("driver_torque_rms")),
        "M8": _median(change("overshoot")),
        "M9": _median(change("peak_lateral_speed")),
        "M10": _median(change("onset_to_crossing")),
        "M11": 100.0 * _mean(change("glance")),
        "M12": 100.0 * _mean(trial("false_glance_share")),
    }
    return [
        Comparison(target, values[target.name], _within(target, values[target.name]))
        for target in TARGETS
    ]


def _within(target: Target, value: Real) -> bool:
    return target.low <= value <= target.high


def missed_by(comparison: Comparison) -> Real:
    """How far the value lies outside the range, in the target's unit; 0 inside."""
    target, value = comparison.target, comparison.value
    return max(target.low - value, value - target.high, 0.0)


def columns_of(rows: list[Row]) -> Callable[[str], NDArray[np.float64]]:
    """A function that gives a column without its missing values."""

    def column(name: str) -> NDArray[np.float64]:
        values = np.array([row[name] for row in rows], dtype=np.float64)
        return values[np.isfinite(values)]

    return column


def _mean(values: NDArray[np.float64]) -> Real:
    return float(values.mean()) if values.size else math.nan


def _median(values: NDArray[np.float64]) -> Real:
    return float(np.median(values)) if values.size else math.nan


def _deviation(values: NDArray[np.float64]) -> Real:
    return float(values.std(ddof=1)) if values.size > 1 else math.nan
