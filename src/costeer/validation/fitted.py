"""A fitted driver drives the same trial again: does that look like the recording?

Whatever the likelihood cannot see (the model's structure, parameters held at their
usual values) shows here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from costeer.base.described import described
from costeer.drivers.driver import DriverParameters
from costeer.identification.fit import DriverFit
from costeer.identification.recording import vehicle_of
from costeer.loop.parameters import DT
from costeer.loop.scenario import (
    FASTEST,
    SLOWEST,
    TrialSetup,
)
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CarParameters
from costeer.records.columns import TrialRecord
from costeer.scale.jobs import run_jobs
from costeer.study.definitions import Columns, Measure
from costeer.study.segments import Segments
from costeer.study.trial_measures import prepare, trial_measures

REPEATS = 20
"""Trials that a check simulates."""
FLAGGED = 2.0
"""Standard deviations from which a measure is flagged [-]."""
FIT_SEED = 900_003
"""Seed of the noise in these trials."""

_LONGEST = 20_000.0
_MEASURES = ("sdlp", "swrr", "driver_torque_rms")
_DURATION = "lane_change_duration"


class Check(NamedTuple):
    """One measure of the recording beside the fitted driver's.

    Attributes:
        measure: Its name as in `trials.csv`; `lane_change_duration` is their mean.
        unit: Of all values.
        recorded: In the recording.
        mean: Over simulated trials.
        deviation: Standard deviation between simulated trials.
        flagged: Whether the recording is more than two of them away.
        reason: Why it could not be compared; empty if it could.
    """

    measure: str
    unit: str
    recorded: float
    mean: float
    deviation: float
    flagged: bool
    reason: str


def check_fit(
    record: TrialRecord,
    fit: DriverFit,
    jobs: int = 1,
    repeats: int = REPEATS,
    advance: Callable[[int], None] = lambda _: None,
    car: str | CarParameters | None = None,
) -> list[Check]:
    """Compare a recording with trials of the fitted driver.

    Args:
        record: The recording that was fitted.
        fit: Of it.
        jobs: Trials at a time.
        repeats: How many trials, each with other noise.
        advance: Called with 1 after each trial.
        car: That was driven; None takes the record's.

    Raises:
        ValueError: If the recording's speed is outside the simulator's range.
    """
    setup = same_trial(record, car)
    recorded = measured(record.columns)
    simulated = run_jobs(
        lambda number: measured(simulate(setup, fit.driver, number)),
        range(1, repeats + 1),
        jobs,
        lambda _: advance(1),
    )
    return [
        _compared(name, measure, [each[name] for each in simulated])
        for name, measure in recorded.items()
    ]


def same_trial(
    record: TrialRecord, car: str | CarParameters | None = None
) -> TrialSetup:
    """The manual trial that is most like a recording: length, speed, car, leaders.

    Raises:
        ValueError: If its speed is outside the simulator's range.
    """
    columns = record.columns
    speed = float(np.mean(columns["longitudinal_velocity"]))
    if not SLOWEST <= speed <= FASTEST:
        raise ValueError(
            f"the recording's mean speed is {speed * 3.6:.3g} km/h; a check by "
            f"simulation needs {SLOWEST * 3.6:.4g} to {FASTEST * 3.6:.4g} km/h"
        )
    driven, column = vehicle_of(record, car)
    return TrialSetup(
        seed=FIT_SEED,
        condition="manual",
        method="manual",
        intention="off",
        change_duration=math.nan,
        length=min(speed * DT * len(columns["time"]), _LONGEST),
        speed=speed,
        car=driven,
        events=_has_leaders(columns),
        parameters=tuple((f"column.{d.name}", d.value) for d in described(column)),
    )


def _has_leaders(columns: Columns) -> bool:
    if "event" in columns:
        return bool(np.any(np.ma.filled(np.ma.asarray(columns["event"]), 0) != 0))
    if "lead_distance" in columns:
        return bool(np.isfinite(columns["lead_distance"]).any())
    segments = prepare(columns).segments
    return isinstance(segments, Segments) and bool(segments.changes)


def simulate(setup: TrialSetup, driver: DriverParameters, number: int) -> Columns:
    """Columns of one trial of a driver.

    Args:
        setup: Of the trial.
        driver: Who drives, whatever the setup says.
        number: Of the trial: each has other noise.
    """
    own = setup._replace(driver=driver, participant=number)
    return simulate_trial(own).columns


def measured(columns: Columns) -> dict[str, Measure]:
    """The measures that are compared, by name."""
    trial = prepare(columns)
    every = trial_measures(trial)
    found = {name: every[name] for name in _MEASURES}
    segments = trial.segments
    changes = segments.changes if isinstance(segments, Segments) else ()
    if changes:
        mean = float(np.mean([c.end_time - c.start_time for c in changes]))
        found[_DURATION] = Measure(value=mean, unit="s")
    else:
        found[_DURATION] = Measure(math.nan, "s", "no completed lane change")
    return found


def _compared(name: str, recorded: Measure, simulated: list[Measure]) -> Check:
    values = np.array([each.value for each in simulated if not each.reason])
    reason = recorded.reason or ("" if values.size > 1 else "not in the simulation")
    mean, deviation = math.nan, math.nan
    if values.size > 1:
        mean, deviation = float(values.mean()), float(values.std(ddof=1))
    return Check(
        measure=name,
        unit=recorded.unit,
        recorded=recorded.value,
        mean=mean,
        deviation=deviation,
        flagged=not reason and abs(recorded.value - mean) > FLAGGED * deviation,
        reason=reason,
    )
