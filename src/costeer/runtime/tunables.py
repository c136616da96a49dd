"""What an experimenter may change while a person drives: names, units and ranges."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base.array import Real
from costeer.base.packing import leaf_names
from costeer.loop.step import LoopParameters


class Tunable(NamedTuple):
    """One number that can be changed during a drive.

    Attributes:
        name: Short, as pages and records say it.
        leaf: Where it lies in `LoopParameters`.
        unit: SI, "-" if there is none.
        low: Smallest value.
        high: Largest value.
        label: For people.
    """

    name: str
    leaf: str
    unit: str
    low: Real
    high: Real
    label: str


_METHOD = "controller"

TUNABLES = (
    Tunable(
        "strength_factor",
        f"{_METHOD}.actuation.strength_factor",
        "-",
        0.0,
        1.0,
        "strength factor on K_h",
    ),
    Tunable(
        "change_duration",
        f"{_METHOD}.trajectory.change_duration",
        "s",
        2.0,
        12.0,
        "duration of a lane change",
    ),
    Tunable(
        "lateral_error_gain",
        f"{_METHOD}.guidance.lateral_error_gain",
        "N·m/m",
        0.0,
        3.0,
        "K_y, lateral error",
    ),
    Tunable(
        "heading_error_rate_gain",
        f"{_METHOD}.guidance.heading_error_rate_gain",
        "N·m·s/rad",
        0.0,
        8.0,
        "K_yd, heading-error rate",
    ),
    Tunable(
        "steering_angle_gain",
        f"{_METHOD}.guidance.steering_angle_gain",
        "N·m/rad",
        0.0,
        6.0,
        "K_theta, steering angle",
    ),
    Tunable(
        "slip_angle_gain",
        f"{_METHOD}.guidance.slip_angle_gain",
        "N·m/rad",
        0.0,
        100.0,
        "K_alpha, slip angle",
    ),
    Tunable(
        "preview_time",
        f"{_METHOD}.preview.preview_time",
        "s",
        0.5,
        3.0,
        "preview time",
    ),
    Tunable(
        "threshold",
        f"{_METHOD}.inference.threshold",
        "-",
        0.05,
        0.999,
        "crossing probability that triggers",
    ),
    Tunable(
        "inconsistency_threshold",
        f"{_METHOD}.consistency.inconsistency_threshold",
        "W",
        0.0,
        1.0,
        "threshold of Table III",
    ),
    Tunable(
        "hold_time",
        f"{_METHOD}.consistency.hold_time",
        "s",
        0.0,
        1.0,
        "hold of the verdict",
    ),
    Tunable(
        "steepness",
        f"{_METHOD}.strength.steepness",
        "1/s",
        1.0,
        8.0,
        "lambda of the fade",
    ),
    Tunable(
        "replan_gain",
        f"{_METHOD}.replanning.replan_gain",
        "-",
        0.01,
        0.5,
        "K_h below which to plan anew",
    ),
    Tunable(
        "torque_limit",
        f"{_METHOD}.actuation.torque_limit",
        "N·m",
        0.0,
        5.0,
        "largest guidance torque",
    ),
)
"""In the order in which pages list them; the limits of the wheel itself stay fixed."""

_BY_NAME = {tunable.name: tunable for tunable in TUNABLES}
_LEAVES = leaf_names(LoopParameters())


def tunable_named(name: str) -> Tunable:
    """The tunable of that name.

    Raises:
        ValueError: If there is none.
    """
    if name not in _BY_NAME:
        known = ", ".join(_BY_NAME)
        raise ValueError(f"'{name}' cannot be tuned; choose one of {known}")
    return _BY_NAME[name]


def place_of(tunable: Tunable) -> int:
    """Where it lies in packed `LoopParameters`."""
    return _LEAVES.index(tunable.leaf)


def checked_value(tunable: Tunable, value: Real) -> Real:
    """The value, if it may be set.

    Raises:
        ValueError: If it is out of range or no number.
    """
    if not (math.isfinite(value) and tunable.low <= value <= tunable.high):
        unit = "" if tunable.unit == "-" else f" {tunable.unit}"
        raise ValueError(
            f"{tunable.name} is {value:g}; give a number from {tunable.low:g} to "
            f"{tunable.high:g}{unit}"
        )
    return value
