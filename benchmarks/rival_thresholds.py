"""Thresholds of the methods that `ibhs` is compared with, from pilot drivers alone.

    python -m benchmarks.rival_thresholds

Two are set for equal false triggers in manual driving, one in 20 km: the time to lane
crossing of `lane-crossing-time` and the integral of `inclusion`. Pilot drivers drive
the course without assistance; what each method would have triggered on is reckoned from
the records. A trigger is false if the driver does not cross to that side within 5 s,
as for the network (training/triggers.py). Of the thresholds that keep to the rate, the
one with the largest median lead is taken, also as for the network. In the 5 s after a
crossing nothing is judged: under each method a path would run then, and the torque that
ends a lane change is none that asks for another.

Two are set as the δ of `ibhs` was (docs/decisions/0006-threshold.md), twice the 99.9th
percentile of the gap over samples with opposed torques in runs in which driver and
system want the same: `pseudo-work` on the runs of that decision; `cooperative-status`,
which plans no lane change, on those of lane keeping.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from costeer.controller.hands import HandsParameters
from costeer.loop.parameters import DT
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.inclusion import IntentParameters
from costeer.scale.jobs import default_jobs, run_jobs
from costeer.training.operating import best_place, counts_at, operating_counts
from costeer.training.recordings import recordings_of
from costeer.training.triggers import TriggerParameters
from costeer.training.verdicts import DriverVerdicts, by_driver
from costeer.validation.pilot import (
    FACTOR,
    PERCENTILE,
    agreeing_setups,
    opposed_gaps,
)

NUM_MANUAL = 100
"""Pilot drivers of manual driving, 8 km each."""

NUM_AGREEING = 30
"""Pilot drivers of agreeing runs, as for δ."""

FALSE_PER_KM = 1.0 / 20.0

UNDISPUTED = 100.0
"""A threshold that no run reaches [W·m]."""

ARRIVING = 5.0
"""After a crossing nothing is judged for so long [s]."""

LONGEST = 20.0
"""Times to lane crossing beyond this are one [s]."""

Columns = dict[str, NDArray[Any]]  # Any: kinds differ
Numbers = NDArray[np.float64]
Score = Callable[[Columns, Numbers], Numbers]


def crossing_times(columns: Columns, side: Numbers) -> Numbers:
    """Time to the line on a side at the present velocity, negative, `(time,)` [s].

    Args:
        columns: Of a record.
        side: Of the adjacent lane, `(time,)` [-].
    """
    yaw = columns["yaw_angle"]
    along = columns["longitudinal_velocity"] * np.sin(yaw)
    velocity = side * (along + columns["lateral_velocity"] * np.cos(yaw))
    distance = columns["distance_to_adjacent_lane"]
    time = np.full(len(yaw), LONGEST)
    np.divide(distance, velocity, out=time, where=velocity > distance / LONGEST)
    return -time


def intents(columns: Columns, side: Numbers) -> Numbers:
    """Leaky integral of the driver's own torque towards a side, `(time,)` [N·m·s].

    Args:
        columns: Of a record of manual driving on a straight road.
        side: Of the adjacent lane, `(time,)` [-].
    """
    arms, memory = HandsParameters(), IntentParameters().memory
    angle, rate = columns["steering_wheel_angle"], columns["steering_wheel_rate"]
    carried = (arms.inertia * np.diff(rate) + arms.damping * np.diff(angle)) / DT
    own = columns["driver_torque"] + np.append(0.0, carried)
    integral: Numbers = lfilter([DT], [1.0, DT / memory - 1.0], own)
    return side * integral


def manual_setup(participant: int) -> TrialSetup:
    """The course without assistance, driven by one pilot driver."""
    return TrialSetup(
        participant=participant,
        seed=PILOT_SEED,
        condition="pilot-manual",
        strength_factor=0.0,
        intention="off",
    )


def scored(setup: TrialSetup) -> list[tuple[Any, Numbers, Numbers]]:
    """A manual drive and both scores of it. Any: a recording."""
    record = simulate_trial(setup)
    (recording,) = recordings_of(record, f"pilot driver {setup.participant}")
    side = recording.side.astype(float)
    if len(side) != len(record.columns["time"]):
        raise ValueError(f"pilot driver {setup.participant}: rows were left out")
    given = record.columns, side
    after = np.ones(round(ARRIVING / DT))
    arriving = np.convolve(recording.crossing != 0, after)[: len(side)] > 0.5
    scores = crossing_times(*given), intents(*given)
    one, other = (np.where(arriving, np.nan, score) for score in scores)
    return [(recording, one, other)]


def report(
    name: str,
    unit: str,
    drivers: list[DriverVerdicts],
    parameters: TriggerParameters,
    thresholds: Numbers,
) -> None:
    """Print the threshold of one trigger and what it gives.

    Args:
        name: Of the threshold.
        unit: Of the threshold.
        drivers: With their scores.
        parameters: Debounce.
        thresholds: To choose from, ascending.
    """
    counts = operating_counts(drivers, parameters, thresholds)
    place = best_place(counts, FALSE_PER_KM)
    if place is None:
        print(f"{name}: no threshold keeps to one false trigger in 20 km")
        return
    found = counts_at(counts, place)
    leads = np.array(found.leads)
    print(
        f"{name}: {abs(thresholds[place]):.2f} {unit}; {found.false} false triggers in "
        f"{found.kilometres:.0f} km, median lead {np.median(leads):.2f} s, "
        f"{np.count_nonzero(leads == 0.0)} of {len(leads)} crossings missed"
    )


def thresholds_of_manual_driving() -> None:
    """Print what manual driving sets."""
    setups = [manual_setup(n) for n in range(1, NUM_MANUAL + 1)]
    found = run_jobs(scored, setups, default_jobs(), lambda _: None)
    every = [one for drive in found for one in drive]
    recordings = [one[0] for one in every]
    usual = TriggerParameters()
    print(f"{NUM_MANUAL} pilot drivers, seed {PILOT_SEED}, manual driving")
    report(
        "lane-crossing-time, trigger.crossing_time",
        "s",
        by_driver(recordings, [one[1] for one in every]),
        usual,
        -np.arange(1500, 0, -1) / 100.0,
    )
    report(
        "inclusion, intent.threshold",
        "N·m·s",
        by_driver(recordings, [one[2] for one in every]),
        usual._replace(trigger_samples=1),
        np.arange(1, 1001) / 100.0,
    )


def agreeing(method: str, leaf: str) -> list[TrialSetup]:
    """Runs in which driver and system want the same; the gain never fades.

    Args:
        method: Its name.
        leaf: Its threshold, set out of reach.
    """
    every = [s for n in range(1, NUM_AGREEING + 1) for s in agreeing_setups(n)]
    return [s._replace(method=method, parameters=((leaf, UNDISPUTED),)) for s in every]


def gap_threshold(setups: list[TrialSetup]) -> float:
    """Twice the 99.9th percentile of the gap [W·m]."""
    gaps = run_jobs(opposed_gaps, setups, default_jobs(), lambda _: None)
    every = np.concatenate(gaps)
    found = FACTOR * float(np.percentile(every, PERCENTILE))
    return found if len(every) else math.nan


def main() -> None:
    """Print all thresholds."""
    thresholds_of_manual_driving()
    print(f"{NUM_AGREEING} pilot drivers, seed {PILOT_SEED}, agreeing runs")
    leaf = "consistency.inconsistency_threshold"
    found = gap_threshold(agreeing("pseudo-work", leaf))
    print(f"pseudo-work, {leaf}: {found:.3f} W·m")
    leaf = "cooperation.initiative_threshold"
    every = agreeing("cooperative-status", leaf)
    found = gap_threshold([setup for setup in every if not setup.events])
    print(f"cooperative-status, {leaf}: {found:.3f} W·m")


if __name__ == "__main__":
    main()
