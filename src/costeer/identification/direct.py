"""What a recording shows without a filter: durations, speed, glances.

Each estimate comes with an interval for few samples, or with the reason for its lack.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import beta, chi2, t

from costeer.drivers.gaze import GazeParameters
from costeer.drivers.longitudinal import LongitudinalParameters
from costeer.identification.parameters import Estimate
from costeer.identification.signals import Drive, Signal
from costeer.identification.stretches import (
    Change,
    apart_from,
    completed,
    step_response,
    stretches,
)


class _Response(NamedTuple):
    """Logarithm of measured over planned duration: linear in the planned one's.

    Attributes:
        at: Planned duration that the offset is for [s].
        offset: Logarithm of measured over planned there [-].
        slope: Of the logarithm of measured by that of planned duration [-].
    """

    at: float
    offset: float
    slope: float


_RESPONSE = _Response(at=7.0, offset=-0.035, slope=1.10)

TAIL = 0.025
"""Probability on each side of an interval."""
GLANCE_YAW = 0.13
"""Head yaw from which a head is turned [-]: five standard deviations of drift and
tracker noise, half the usual amplitude."""
DECIDED_BEFORE = 8.0
"""Glances so long before a lane change belong to it [s]."""
LOOKED_BEFORE = 5.5
"""A glance that begins so long before the yaw threshold counts for the change [s]."""
SETTLED_AFTER = 4.0
"""After a lane change there are no other glances for so long [s]."""
SPEED_SETTLES = 15.0
"""The speed is left from the recording's start and from overtaking by then [s]."""
FEWEST_CHANGES = 2
FEWEST_SPEEDS = 2.0


def _none(name: str, unit: str, reason: str) -> Estimate:
    nan = float("nan")
    return Estimate(name=name, value=nan, low=nan, high=nan, unit=unit, how=reason)


def path_duration(drive: Drive, change: Change) -> float:
    """Duration of the quintic that fits a lane change best [s]; NaN if none does.

    Start and end of the quintic are free, and so are the places in the lanes.

    Args:
        drive: The recording.
        change: A completed one.
    """
    around = round(3.0 / drive.dt)
    rows = slice(max(change.start - around, 0), change.end + around)
    time = np.arange(rows.start, min(rows.stop, len(drive.lane))) * drive.dt
    position = drive.lateral_position[rows]
    middle, guess = (
        change.crossing * drive.dt,
        1.5 * drive.dt * (change.end - change.start),
    )

    def misfit(x: Signal) -> Signal:
        progress = (time - x[0]) / np.exp(x[1]) + 0.5
        return np.asarray(x[2] + x[3] * step_response(progress) - position)

    first = np.array([middle, np.log(guess), position[0], position[-1] - position[0]])
    found = least_squares(misfit, first)
    return float(np.exp(found.x[1])) if found.success else float("nan")


def planned_duration(measured: float) -> float:
    """Duration that was planned for a path that lasts so long [s].

    Driver and car follow a plan with a lag: they cut short what is quick and draw out
    what is slow. The relation is that of thirty pilot drivers (seed 900001) with
    planned durations of 4 to 12 s, the default car, manual driving.

    Args:
        measured: Duration of the quintic that fits the path [s].
    """
    logarithm = math.log(measured / _RESPONSE.at) - _RESPONSE.offset
    return _RESPONSE.at * math.exp(logarithm / _RESPONSE.slope)


def change_duration(drive: Drive, found: list[Change]) -> Estimate:
    """Median planned duration of the lane changes, with a t interval of its logarithm.

    Args:
        drive: The recording.
        found: All crossings.
    """
    name, unit = "decision.change_duration", "s"
    paths = np.array([path_duration(drive, c) for c in completed(drive, found)])
    logs = np.log([planned_duration(d) for d in paths[np.isfinite(paths)]])
    if logs.size < FEWEST_CHANGES:
        return _none(
            name, unit, f"{logs.size} lane changes; needs {FEWEST_CHANGES} or more"
        )
    half = t.isf(TAIL, logs.size - 1) * logs.std(ddof=1) / np.sqrt(logs.size)
    mean = float(logs.mean())
    low, high = np.exp([mean - half, mean + half]).tolist()
    how = f"quintics fitted to {logs.size} lane changes, t interval"
    return Estimate(name, float(np.exp(mean)), low, high, unit, how)


def _free_rows(drive: Drive, found: list[Change]) -> list[slice]:
    """Stretches of free driving after the speed has settled; none if not known."""
    if drive.free is None:
        return []
    apart = drive.free & apart_from(drive, found, DECIDED_BEFORE, SETTLED_AFTER)
    settling = round(SPEED_SETTLES / drive.dt)
    return [
        slice(rows.start + settling, rows.stop)
        for rows in stretches(apart, settling + 1)
    ]


def effective_number(time: Signal, correlation_time: float) -> float:
    """How many independent samples have a mean as sure as these [-].

    Args:
        time: Of the samples [s], shape `(time,)`; gaps are fine.
        correlation_time: The correlation falls by e in this time [s].
    """
    lags = np.abs(time[:, None] - time[None, :])
    return float(1.0 / np.exp(-lags / correlation_time).mean())


def preferred_speed(drive: Drive, found: list[Change]) -> Estimate:
    """Mean speed of free driving, with a t interval for correlated samples.

    Args:
        drive: The recording.
        found: All crossings.
    """
    name, unit = "longitudinal.preferred_speed", "m/s"
    if drive.free is None:
        return _none(name, unit, "needs the column event or lead_distance")
    each_second = round(1.0 / drive.dt)
    every = [np.arange(r.start, r.stop, each_second) for r in _free_rows(drive, found)]
    index = np.concatenate(every) if every else np.zeros(0, dtype=int)
    usual = LongitudinalParameters()
    number = effective_number(index * drive.dt, usual.speed_time) if index.size else 0.0
    if number < FEWEST_SPEEDS:
        return _none(
            name,
            unit,
            f"{index.size} s of free driving; needs about "
            f"{2.0 * FEWEST_SPEEDS * usual.speed_time:g} s away from leaders",
        )
    speed = drive.speed[index]
    spread = float(speed.var() / (1.0 - 1.0 / number))
    if spread == 0.0:
        return _none(name, unit, "the speed never varies: nobody drives it")
    mean = float(speed.mean())
    half = float(t.isf(TAIL, number - 1.0) * np.sqrt(spread / number))
    how = f"mean of {index.size} s, worth {number:.1f} independent samples, t interval"
    return Estimate(name, mean, mean - half, mean + half, unit, how)


def glances(yaw: Signal, dt: float) -> tuple[Signal, Signal]:
    """When glances begin [s] and to which side (-1, +1).

    Args:
        yaw: Of the head, shape `(time,)` [-].
        dt: Sampling step [s].
    """
    turned = stretches(np.abs(yaw) > GLANCE_YAW, 2)
    times = np.array([rows.start * dt for rows in turned])
    return times, np.array([np.sign(yaw[rows].mean()) for rows in turned])


def false_rate(drive: Drive, found: list[Change]) -> Estimate:
    """Rate of glances to one side without a lane change, exact Poisson interval.

    Args:
        drive: The recording.
        found: All crossings.
    """
    name, unit = "gaze.false_rate", "1/s"
    if drive.head_yaw is None:
        return _none(name, unit, "needs the column head_yaw")
    rows = stretches(apart_from(drive, found, DECIDED_BEFORE, SETTLED_AFTER))
    times, _ = glances(drive.head_yaw, drive.dt)
    spans = [(r.start * drive.dt, r.stop * drive.dt) for r in rows]
    count = int(sum(np.sum((times >= a) & (times < b)) for a, b in spans))
    total = sum(b - a for a, b in spans) - count * GazeParameters().duration
    if total <= 0.0:
        return _none(name, unit, "no time away from lane changes")
    exposure = 2.0 * total
    low = float(chi2.isf(1.0 - TAIL, 2 * count)) / 2.0 if count else 0.0
    high = float(chi2.isf(TAIL, 2 * count + 2)) / 2.0
    how = f"{count} glances in {total:.0f} s, exact Poisson interval"
    return Estimate(name, count / exposure, low / exposure, high / exposure, unit, how)


def glance_share(drive: Drive, found: list[Change]) -> Estimate:
    """Share of lane changes with a glance before, exact binomial interval.

    Args:
        drive: The recording.
        found: All crossings.
    """
    name, unit = "decision.glance_share", "-"
    if drive.head_yaw is None:
        return _none(name, unit, "needs the column head_yaw")
    seen = completed(drive, found)
    if not seen:
        return _none(name, unit, "no completed lane change")
    times, sides = glances(drive.head_yaw, drive.dt)
    with_glance = 0
    for change in seen:
        first, last = (
            change.start * drive.dt - LOOKED_BEFORE,
            change.crossing * drive.dt,
        )
        inside = (times >= first) & (times <= last) & (sides == change.direction)
        with_glance += bool(inside.any())
    without = len(seen) - with_glance
    low = float(beta.ppf(TAIL, with_glance, without + 1)) if with_glance else 0.0
    high = float(beta.isf(TAIL, with_glance + 1, without)) if without else 1.0
    how = f"{with_glance} of {len(seen)} lane changes, exact binomial interval"
    return Estimate(name, with_glance / len(seen), low, high, unit, how)


def direct_estimates(drive: Drive, found: list[Change]) -> list[Estimate]:
    """All that a recording shows without a filter.

    Args:
        drive: The recording.
        found: All crossings.
    """
    return [
        change_duration(drive, found),
        preferred_speed(drive, found),
        false_rate(drive, found),
        glance_share(drive, found),
    ]
