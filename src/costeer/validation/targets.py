"""The twelve human ranges of manual driving, M1 to M12, and what is held to them.

Where a range is from stands beside it; a range that nobody printed says assumed. How
long lane changes last depends on the domain of driving, and the targets with it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.population import SIMULATOR, TRAFFIC

TRIALS = "trials"
CHANGES = "changes"
"""Tables of manual driving: a row per driver, a row per lane change."""

MEAN = "mean"
MEDIAN = "median"
DEVIATION = "standard deviation"


class Target(NamedTuple):
    """A human value that the population should meet in manual driving.

    Attributes:
        name: M1 to M12.
        quantity: What it is.
        unit: Of the value as printed.
        low: Smallest accepted value.
        high: Largest accepted value.
        source: Of the range.
        set_by: What in the drivers moves the value, as the end of a sentence.
    """

    name: str
    quantity: str
    unit: str
    low: Real
    high: Real
    source: str
    set_by: str


class Measure(NamedTuple):
    """From which values a target is computed, and how.

    Attributes:
        table: `TRIALS` or `CHANGES`.
        column: Of that table.
        statistic: `MEAN`, `MEDIAN` or `DEVIATION` over drivers or lane changes.
        label: Of an axis, without the unit.
        factor: Value as printed of one unit of the column.
    """

    table: str
    column: str
    statistic: str
    label: str
    factor: Real = 1.0


_ON_ROAD = "assumed; the order of on-the-road tests (Verster and Roth 2011)"
_STEERING = "assumed; the measure is that of Markkula and Engström (2006)"
_NGSIM = "NGSIM US-101 and I-80, lane changes of cars"
_ASSUMED = "assumed; order of simulator studies"
_FIXED_BASE = f"{_ASSUMED} (docs/decisions/0016)"
_JAIN = "Jain et al. (2015), Brain4Cars, ten drivers"
_WANDER = "the wander of the aim and the noise of eyes and hands"
_PLAN = "the planned duration of lane changes and its spread"

_ON_REAL_ROADS = (
    Target("M1", "SDLP, mean over drivers", "m", 0.15, 0.25, _ON_ROAD, _WANDER),
    Target(
        "M2",
        "SDLP, sd between drivers",
        "m",
        0.03,
        0.05,
        _ON_ROAD,
        "the spread of the wander between drivers, and chance within a trial",
    ),
    Target(
        "M3",
        "steering reversals (3 deg, 0.6 Hz), mean",
        "1/min",
        3.0,
        10.0,
        _STEERING,
        "the noise of eyes and hands",
    ),
    Target(
        "M4", "lane-change duration (0.1 m/s), median", "s", 5.0, 6.3, _NGSIM, _PLAN
    ),
    Target("M5", "lane-change duration (0.1 m/s), sd", "s", 1.2, 2.0, _NGSIM, _PLAN),
    Target(
        "M6",
        "peak steering-wheel angle, median",
        "deg",
        3.0,
        12.0,
        _ASSUMED,
        "the planned duration and the noise of eyes and hands",
    ),
    Target(
        "M7",
        "driver torque RMS, mean over drivers",
        "N·m",
        0.2,
        0.7,
        _ASSUMED,
        "the self-aligning torque, and steering against the arms' own damping",
    ),
    Target(
        "M8",
        "overshoot, median",
        "m",
        0.1,
        0.4,
        _ASSUMED,
        "how the driver's own path ends, and the wander of the aim",
    ),
    Target("M9", "peak lateral speed, median", "m/s", 0.75, 1.1, _NGSIM, _PLAN),
    Target("M10", "onset (0.1 m/s) to crossing, median", "s", 2.0, 3.0, _NGSIM, _PLAN),
    Target(
        "M11",
        "changes with a glance to that side",
        "%",
        80.0,
        90.0,
        _JAIN,
        "the share of lane changes with a glance",
    ),
    Target(
        "M12",
        "6 s of straight driving with a false glance",
        "%",
        12.0,
        18.0,
        _JAIN,
        "the rate of glances without a lane change",
    ),
)

_IN_A_SIMULATOR = {
    "M4": (4.6, 5.6),
    "M5": (0.7, 1.2),
    "M9": (0.81, 1.19),
    "M10": (1.85, 2.8),
}
"""Ranges of what NGSIM gives on real roads: a median of 5.1 s within a tenth, a spread
of its own, and speed and crossing scaled in time by 5.1 / 5.5, the median of NGSIM."""


def _in_a_simulator(target: Target) -> Target:
    if target.name not in _IN_A_SIMULATOR:
        return target
    low, high = _IN_A_SIMULATOR[target.name]
    return target._replace(low=low, high=high, source=_FIXED_BASE)


TARGETS = {
    SIMULATOR: tuple(map(_in_a_simulator, _ON_REAL_ROADS)),
    TRAFFIC: _ON_REAL_ROADS,
}
"""M1 to M12, in this order, by the domain of driving."""

_DEG = 180.0 / math.pi

MEASURES = {
    "M1": Measure(TRIALS, "sdlp", MEAN, "SDLP"),
    "M2": Measure(TRIALS, "sdlp", DEVIATION, "SDLP"),
    "M3": Measure(TRIALS, "swrr", MEAN, "Steering reversals"),
    "M4": Measure(CHANGES, "duration_by_speed", MEDIAN, "Duration (0.1 m/s)"),
    "M5": Measure(CHANGES, "duration_by_speed", DEVIATION, "Duration (0.1 m/s)"),
    "M6": Measure(CHANGES, "peak_steering_angle", MEDIAN, "Peak wheel angle", _DEG),
    "M7": Measure(TRIALS, "driver_torque_rms", MEAN, "Driver torque RMS"),
    "M8": Measure(CHANGES, "overshoot", MEDIAN, "Overshoot"),
    "M9": Measure(CHANGES, "peak_lateral_speed", MEDIAN, "Peak lateral speed"),
    "M10": Measure(CHANGES, "onset_to_crossing", MEDIAN, "Onset to crossing"),
    "M11": Measure(CHANGES, "glance", MEAN, "Changes with a glance", 100.0),
    "M12": Measure(TRIALS, "false_glance_share", MEAN, "False glances", 100.0),
}
"""By the name of the target."""


def target_statistic(measure: Measure, values: NDArray[np.float64]) -> Real:
    """What is held to the range, of values in the table's unit.

    Args:
        measure: Which statistic, and the factor to the unit printed.
        values: Without missing ones, shape `(value,)`.

    Returns:
        In the unit printed; NaN without values enough.
    """
    if values.size < (2 if measure.statistic == DEVIATION else 1):
        return math.nan
    if measure.statistic == MEDIAN:
        return measure.factor * float(np.median(values))
    if measure.statistic == MEAN:
        return measure.factor * float(values.mean())
    return measure.factor * float(values.std(ddof=1))
