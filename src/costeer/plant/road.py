"""Lanes of a straight road. Lanes count from the right; y = 0 is the left lane."""

from __future__ import annotations

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.parameters import RoadParameters


@compiled
def lane_centre(road: RoadParameters, lane: Real) -> Real:
    """Lateral position of a lane's centre [m]."""
    return (lane - (road.num_lanes - 1.0)) * road.lane_width


@compiled
def lane_at(road: RoadParameters, lateral_position: Real) -> Real:
    """Number of the lane at a lateral position [-]; the outer lanes reach outwards."""
    lanes_from_left = xp.floor(0.5 - lateral_position / road.lane_width)
    return xp.clip(road.num_lanes - 1.0 - lanes_from_left, 0.0, road.num_lanes - 1.0)


@compiled
def lane_exists(road: RoadParameters, lane: Real) -> Flag:
    """Whether the road has a lane of this number."""
    return (lane >= 0.0) & (lane <= road.num_lanes - 1.0)


@compiled
def adjacent_side(road: RoadParameters, lane: Real) -> Real:
    """Side of the adjacent lane [-]: -1 right, +1 left.

    With lanes on both sides: the overtaking side, unless the car is on the outermost
    lane of that side.
    """
    exists = lane_exists(road, lane + road.overtaking_side)
    return xp.select(exists, road.overtaking_side, -road.overtaking_side)


@compiled
def distance_to_adjacent_lane(
    road: RoadParameters, lateral_position: Real, lane: Real, side: Real
) -> Real:
    """Distance of the centre of gravity to the line shared with a lane beside [m].

    Args:
        road: Its lane width.
        lateral_position: Of the car [m].
        lane: That the car is in [-].
        side: Of the adjacent lane, -1 right or +1 left [-].
    """
    offset = lateral_position - lane_centre(road, lane)
    return road.lane_width / 2.0 - side * offset


@compiled
def cruising_lane(road: RoadParameters) -> Real:
    """Number of the lane that is driven in when nobody is overtaken [-]."""
    return xp.select(road.overtaking_side < 0.0, road.num_lanes - 1.0, 0.0)
