"""60 Hz sensors: the world's state becomes a measurement.

The simulator's own signals are exact, as in the paper's driving simulator; only the
head tracker is noisy. Delay: a torque computed from a measurement acts one control
step later (loop/step.py).
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.plant.road import adjacent_side, distance_to_adjacent_lane, lane_at
from costeer.plant.vehicle import (
    VehicleInput,
    accelerations,
    front_lateral_force,
    front_slip_angle,
    rear_lateral_force,
)
from costeer.plant.world import WorldState
from costeer.sensing.measurement import Measurement


class SensorParameters(NamedTuple):
    """Errors of the sensors.

    Attributes:
        head_yaw_deviation: Standard deviation of the head tracker's noise [-].
            Source: assumed, 1.0 deg of 90, the mean error measured for the webcam
            tracker within 30 deg.
    """

    head_yaw_deviation: Real = 1.0 / 90.0


@compiled
def measured_head_yaw(
    sensors: SensorParameters, head_yaw: Real, tracker_normal: Real
) -> Real:
    """Head yaw as the tracker sees it, within [-1, 1] [-].

    Args:
        sensors: Noise of the tracker.
        head_yaw: The driver's [-].
        tracker_normal: A draw from the standard normal distribution.
    """
    return xp.clip(head_yaw + sensors.head_yaw_deviation * tracker_normal, -1.0, 1.0)


@compiled
def measure(
    car: CarParameters,
    road: RoadParameters,
    world: WorldState,
    driver_torque: Real,
    head_yaw: Real,
) -> Measurement:
    """One sample of all sensors.

    Args:
        car: Its geometry turns the signals into the front slip angle.
        road: Its lanes.
        world: As it is now.
        driver_torque: At the wheel now [N·m].
        head_yaw: As the tracker sees it [-].
    """
    vehicle, wheel = world.vehicle, world.column
    road_wheel_angle = wheel.steering_wheel_angle / car.steering_ratio
    motion = VehicleInput(car=car, road_wheel_angle=road_wheel_angle, drive_command=0.0)
    forward, left = accelerations(
        vehicle,
        motion,
        front_lateral_force(vehicle, motion),
        rear_lateral_force(vehicle, motion),
    )
    lane = lane_at(road, vehicle.lateral_position)
    side = adjacent_side(road, lane)
    return Measurement(
        longitudinal_position=vehicle.longitudinal_position,
        lateral_position=vehicle.lateral_position,
        yaw_angle=vehicle.yaw_angle,
        yaw_rate=vehicle.yaw_rate,
        longitudinal_velocity=vehicle.longitudinal_velocity,
        longitudinal_acceleration=forward,
        lateral_velocity=vehicle.lateral_velocity,
        lateral_acceleration=left,
        steering_wheel_angle=wheel.steering_wheel_angle,
        steering_wheel_rate=wheel.steering_wheel_rate,
        front_slip_angle=front_slip_angle(
            car,
            vehicle.longitudinal_velocity,
            vehicle.lateral_velocity,
            vehicle.yaw_rate,
            road_wheel_angle,
        ),
        driver_torque=driver_torque,
        head_yaw=head_yaw,
        head_yaw_valid=xp.isfinite(head_yaw),
        lane=lane,
        side=side,
        distance_to_adjacent_lane=distance_to_adjacent_lane(
            road, vehicle.lateral_position, lane, side
        ),
    )
