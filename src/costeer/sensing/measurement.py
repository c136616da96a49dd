"""What can be known of the world: the record that controller and driver see."""

from __future__ import annotations

from typing import Any, NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import (
    adjacent_side,
    cruising_lane,
    distance_to_adjacent_lane,
    lane_centre,
    lane_exists,
)


class Measurement(NamedTuple):
    """One 60 Hz sample of everything that is measured.

    Attributes:
        longitudinal_position: Along the road [m].
        lateral_position: From the left lane's centre, left positive [m].
        yaw_angle: From the road's direction [rad].
        yaw_rate: [rad/s].
        longitudinal_velocity: In the car's direction [m/s].
        longitudinal_acceleration: At the centre of gravity [m/s²].
        lateral_velocity: At the centre of gravity [m/s].
        lateral_acceleration: At the centre of gravity [m/s²].
        steering_wheel_angle: [rad].
        steering_wheel_rate: [rad/s].
        front_slip_angle: From the signals above and the car's geometry [rad].
        driver_torque: At the wheel; known to the simulator, docs/paper.md [N·m].
        head_yaw: Normalised to [-1, 1], left positive [-].
        head_yaw_valid: Whether the tracker sees the head.
        lane: That the car is in, counted from the right [-].
        side: Of the adjacent lane, -1 right, +1 left [-].
        distance_to_adjacent_lane: To the line shared with that lane [m].
        road_curvature: Of the road's reference line, the left lane's centre, at the
            car; left positive [1/m].
        road_curvature_slope: Its change along the road [1/m²].
    """

    longitudinal_position: Real
    lateral_position: Real
    yaw_angle: Real
    yaw_rate: Real
    longitudinal_velocity: Real
    longitudinal_acceleration: Real
    lateral_velocity: Real
    lateral_acceleration: Real
    steering_wheel_angle: Real
    steering_wheel_rate: Real
    front_slip_angle: Real
    driver_torque: Real
    head_yaw: Real
    head_yaw_valid: Flag
    lane: Real
    side: Real
    distance_to_adjacent_lane: Real
    road_curvature: Real = 0.0
    road_curvature_slope: Real = 0.0


@compiled
def facing_beyond(road: RoadParameters, measurement: Measurement) -> Measurement:
    """The same sample with what is on the other side taken for the adjacent lane."""
    side = -measurement.side
    return measurement._replace(
        side=side,
        distance_to_adjacent_lane=distance_to_adjacent_lane(
            road, measurement.lateral_position, measurement.lane, side
        ),
    )


@compiled
def towards(road: RoadParameters, measurement: Measurement, side: Real) -> Measurement:
    """The sample with the lane on a side, if there is one, taken for the adjacent lane.

    Args:
        road: Its lanes.
        measurement: Of the sensors.
        side: -1 right, +1 left; 0: as it is [-].
    """
    other = facing_beyond(road, measurement)
    turned = (side == other.side) & lane_exists(road, measurement.lane + side)
    distance = xp.select(
        turned, other.distance_to_adjacent_lane, measurement.distance_to_adjacent_lane
    )
    return measurement._replace(
        side=xp.select(turned, side, measurement.side),
        distance_to_adjacent_lane=distance,
    )


def standing_start(road: RoadParameters) -> Measurement:
    """A car at 20 m/s in the middle of its lane."""
    lane = cruising_lane(road)
    zeros: dict[str, Any] = dict.fromkeys(Measurement._fields, 0.0)
    return Measurement(**zeros)._replace(
        lateral_position=lane_centre(road, lane),
        longitudinal_velocity=20.0,
        head_yaw_valid=True,
        lane=lane,
        side=adjacent_side(road, lane),
        distance_to_adjacent_lane=road.lane_width / 2.0,
    )
