"""Steering on curves: what of the wheel's angle is more than the road asks for."""

from __future__ import annotations

from typing import Any

import numpy as np

from costeer.plant.alignment import line_curvature
from costeer.plant.parameters import CarParameters, steady_steering_wheel_angle
from costeer.study.definitions import Columns, Measure, Signal, incomplete, unknown
from costeer.study.manoeuvres import rms

STRAIGHT = "the road has no curves"

_NEEDED = (
    "road_curvature",
    "lateral_position",
    "longitudinal_velocity",
    "steering_wheel_angle",
)


def beyond_curve(columns: Columns, car: CarParameters) -> Signal | str:
    """Steering-wheel angle less that of steady cornering along the line [rad].

    Or why it is not known.
    """
    reason = incomplete(columns, *_NEEDED)
    if reason:
        return reason
    given: Any = [np.asarray(columns[name]) for name in _NEEDED]  # Any: for numbers too
    curvature, position, speed, angle = given
    if not np.any(curvature):
        return STRAIGHT
    line = line_curvature(curvature, position)
    return np.asarray(angle - steady_steering_wheel_angle(car, speed, line))


def angle_beyond_curve(columns: Columns, car: CarParameters) -> dict[str, Measure]:
    """Root mean square and peak of the angle less that of the curve."""
    names = ("steering_beyond_curve_rms", "steering_beyond_curve_peak")
    beyond = beyond_curve(columns, car)
    if isinstance(beyond, str):
        return dict.fromkeys(names, unknown("rad", beyond))
    if not beyond.size:
        return dict.fromkeys(names, unknown("rad", "the stretch holds no sample"))
    values = (rms(beyond), float(np.abs(beyond).max()))
    return {n: Measure(v, "rad") for n, v in zip(names, values, strict=True)}
