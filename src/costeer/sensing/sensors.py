"""60 Hz sensors: the world's state becomes a measurement.

The simulator's own signals are exact, as in the paper's driving simulator; only the
head tracker is noisy and loses the face now and then. Delay: a torque computed from a
measurement acts one control step later (loop/step.py).
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.alignment import NO_BEND, Bend
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
        loss_rate: How often the tracker loses a face that looks ahead [1/s]. Source:
            assumed, a lab's tracker.
        turned_loss_rate: The same for a head that is turned far [1/s]. Source:
            assumed; face trackers need both eyes.
        turned_yaw: Head yaw from which a head is turned far [-]. Source: assumed, 50
            deg of 90.
        loss_time: Mean time until the face is found again [s]. Source: assumed.
    """

    head_yaw_deviation: Real = 1.0 / 90.0
    loss_rate: Real = 0.01
    turned_loss_rate: Real = 0.3
    turned_yaw: Real = 50.0 / 90.0
    loss_time: Real = 0.3


class HeadTracker(NamedTuple):
    """What the head tracker says.

    Attributes:
        head_yaw: In [-1, 1]; the last one seen while the face is lost [-].
        valid: Whether it sees the face.
    """

    head_yaw: Real
    valid: Flag


class TrackerNoise(NamedTuple):
    """Random numbers of one control step.

    Attributes:
        normal: Standard normal, error of the angle.
        uniform: In [0, 1), whether the face is lost or found.
    """

    normal: Real
    uniform: Real


@compiled
def initial_tracker() -> HeadTracker:
    """A face that looks ahead."""
    return HeadTracker(head_yaw=0.0, valid=True)


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
def track_head(
    sensors: SensorParameters,
    state: HeadTracker,
    head_yaw: Real,
    noise: TrackerNoise,
    dt: Real,
) -> HeadTracker:
    """What the tracker says one step later; a lost face keeps its last angle.

    Args:
        sensors: Noise and losses.
        state: What it said before.
        head_yaw: The driver's [-].
        noise: Draws of this step.
        dt: Control step [s].
    """
    far = (head_yaw > sensors.turned_yaw) | (head_yaw < -sensors.turned_yaw)
    rate = xp.select(far, sensors.turned_loss_rate, sensors.loss_rate)
    kept = noise.uniform >= dt * rate
    found = noise.uniform < dt / sensors.loss_time
    valid = xp.select(state.valid, kept, found)
    seen = measured_head_yaw(sensors, head_yaw, noise.normal)
    return HeadTracker(head_yaw=xp.select(valid, seen, state.head_yaw), valid=valid)


@compiled
def measure(
    car: CarParameters,
    road: RoadParameters,
    world: WorldState,
    driver_torque: Real,
    head: HeadTracker,
    bend: Bend = NO_BEND,
) -> Measurement:
    """One sample of all sensors.

    Args:
        car: Its geometry turns the signals into the front slip angle.
        road: Its lanes.
        world: As it is now.
        driver_torque: At the wheel now [N·m].
        head: What the tracker says; an angle that is not finite is not valid.
        bend: Of the road at the car.
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
        head_yaw=head.head_yaw,
        head_yaw_valid=head.valid & xp.isfinite(head.head_yaw),
        lane=lane,
        side=side,
        distance_to_adjacent_lane=distance_to_adjacent_lane(
            road, vehicle.lateral_position, lane, side
        ),
        road_curvature=bend.curvature,
        road_curvature_slope=bend.slope,
    )
