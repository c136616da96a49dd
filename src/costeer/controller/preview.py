"""Errors at the preview point and the planned wheel (Fig. 4, Eq. (5)).

The column terms of Eq. (4) belong to the planned motion, see docs/paper.md. Target
quantities are taken at the car and only the error is extrapolated by the preview
time; looking the path up at the preview point instead is the other reading
(`look_ahead`), in which the car turns in before its path does.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.bezier import path_point
from costeer.controller.signals import LANE_CHANGING, Preview, Target
from costeer.plant.parameters import (
    CarParameters,
    steady_front_slip_angle,
    steady_sideslip_angle,
    steady_steering_wheel_angle,
)
from costeer.sensing.measurement import Measurement


class PreviewParameters(NamedTuple):
    """Where the errors are taken.

    Attributes:
        preview_time: T_p, how far the error is extrapolated [s]. Source: assumed,
            between two public tunings of the same lineage, 1.4 and 1.5 s.
        look_ahead: Take the path at the preview point instead of at the car [-].
            Source: assumed, false; the other reading of Fig. 4.
    """

    preview_time: Real = 1.5
    look_ahead: Flag = False


@compiled
def lateral_error(
    parameters: PreviewParameters,
    target: Target,
    measurement: Measurement,
    heading_error: Real,
) -> Real:
    """e_y at the preview point, car minus target [m].

    Args:
        parameters: Preview time and reading.
        target: At the car.
        measurement: Where the car is and points.
        heading_error: psi - psi_d [rad].
    """
    distance = measurement.longitudinal_velocity * parameters.preview_time
    offset = measurement.lateral_position - target.lateral_position
    at_car = offset + distance * heading_error
    ahead = path_point(target.path, measurement.longitudinal_position + distance)
    changing = target.mode == LANE_CHANGING
    aim = xp.select(changing, ahead.lateral_position, target.lateral_position)
    at_point = measurement.lateral_position + distance * measurement.yaw_angle - aim
    return xp.select(parameters.look_ahead, at_point, at_car)


@compiled
def preview(
    parameters: PreviewParameters,
    car: CarParameters,
    target: Target,
    measurement: Measurement,
) -> Preview:
    """Car minus target and the wheel that the planned motion needs.

    Args:
        parameters: Preview time and reading.
        car: Nominal car, for the steady relations of angle, slip and curvature.
        target: Planned motion at the car.
        measurement: The car's motion.
    """
    speed, curvature = measurement.longitudinal_velocity, target.curvature
    planned_yaw = target.heading - steady_sideslip_angle(car, speed, curvature)
    heading_error = measurement.yaw_angle - planned_yaw
    angle = steady_steering_wheel_angle(car, speed, curvature)
    slip = steady_front_slip_angle(car, speed, curvature)
    return Preview(
        lateral_error=lateral_error(parameters, target, measurement, heading_error),
        heading_error=heading_error,
        heading_error_rate=measurement.yaw_rate - speed * curvature,
        steering_angle_error=measurement.steering_wheel_angle - angle,
        slip_angle_error=measurement.front_slip_angle - slip,
        planned_steering_angle=angle,
        planned_steering_rate=steady_steering_wheel_angle(
            car, speed, target.curvature_rate
        ),
        planned_slip_angle=slip,
    )
