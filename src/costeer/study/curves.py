"""Steering on curves: what of the wheel's angle is more than the road asks for."""

from __future__ import annotations

import numpy as np

from costeer.plant.parameters import CarParameters
from costeer.study.definitions import Columns, Measure, Signal, incomplete, unknown
from costeer.study.manoeuvres import rms

STRAIGHT = "the road has no curves"


def curve_angle(
    car: CarParameters, curvature: Signal, lateral: Signal, speed: Signal
) -> Signal:
    """Steering-wheel angle with which a car stays on its line [rad], `(time,)`.

    That of the linear single-track car in steady state: ratio times
    (wheelbase + understeer gradient times speed squared) times curvature.

    Args:
        car: Its parameters.
        curvature: Of the left lane's centre [1/m], left positive.
        lateral: Position from it [m], left positive.
        speed: Along the car's axis [m/s].
    """
    wheelbase = car.front_distance + car.rear_distance
    softer = car.rear_distance / car.front_cornering_stiffness
    softer -= car.front_distance / car.rear_cornering_stiffness
    gradient = car.mass / wheelbase * softer
    line = curvature / (1.0 - curvature * lateral)
    return np.asarray(car.steering_ratio * (wheelbase + gradient * speed**2) * line)


def beyond_curve(columns: Columns, car: CarParameters) -> Signal | str:
    """Steering-wheel angle less that of the curve [rad]; or why it is not known."""
    reason = incomplete(
        columns,
        "road_curvature",
        "steering_wheel_angle",
        "lateral_position",
        "longitudinal_velocity",
    )
    if reason:
        return reason
    curvature = np.asarray(columns["road_curvature"])
    if not np.any(curvature):
        return STRAIGHT
    asked = curve_angle(
        car,
        curvature,
        np.asarray(columns["lateral_position"]),
        np.asarray(columns["longitudinal_velocity"]),
    )
    return np.asarray(columns["steering_wheel_angle"] - asked)


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
