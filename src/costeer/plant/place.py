"""What the place where the car is does to it: the road's bend, wind, strip, barrier."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.alignment import Bend
from costeer.plant.parameters import RoadParameters

STRIP_PERIOD = 0.6
"""Distance of the grooves of a rumble strip [m]: 32 Hz at 70 km/h. Source: assumed, in
the range of what is milled, 0.3 to 0.6 m."""

STRIP_BEGINS, STRIP_WIDTH = 0.10, 0.40
"""Of the rumble strip, outwards from the outer line [m]. Source: assumed."""

NO_CONTACT, STRIP, BARRIER, CAR = 0.0, 1.0, 2.0, 3.0
"""What the car touches."""


class Place(NamedTuple):
    """What acts on the car because of where it is, held over a control step.

    Attributes:
        bend: Of the road.
        side_force: Of the wind, left positive [N].
        rumble: Amplitude of the torque of a rumble strip at the wheel [N·m].
        stopped: Whether the car has hit something and stands.
    """

    bend: Bend = Bend()
    side_force: Real = 0.0
    rumble: Real = 0.0
    stopped: Flag = False


NOWHERE = Place()
"""A straight road on which nothing acts on the car."""


@compiled
def beyond_line(road: RoadParameters, lateral_position: Real, width: Real) -> Real:
    """How far the outer side of the car is beyond the outer line [m].

    Args:
        road: Its lanes.
        lateral_position: Of the car's middle [m].
        width: Of the car [m].
    """
    left = lateral_position - road.lane_width / 2.0
    right = -lateral_position - (road.num_lanes - 0.5) * road.lane_width
    return xp.maximum(left, right) + width / 2.0


@compiled
def ground_contact(road: RoadParameters, beyond: Real) -> Real:
    """What the car touches that belongs to the road: nothing, strip or barrier [-].

    Args:
        road: Its shoulder.
        beyond: The outer line, of the car's side [m].
    """
    inner = beyond - STRIP_BEGINS
    on_strip = (inner > 0.0) & (inner < STRIP_WIDTH) & (road.rumble > 0.0)
    ground = xp.select(on_strip, STRIP, NO_CONTACT)
    return xp.select(beyond >= road.shoulder, BARRIER, ground)


@compiled
def rumble_torque(place: Place, position: Real) -> Real:
    """Torque of the strip's grooves at the wheel [N·m]: up and down along the road.

    Args:
        place: With its amplitude.
        position: Of the car along the road [m].
    """
    turns = position / STRIP_PERIOD
    share = turns - xp.floor(turns)
    away = xp.select(share < 0.5, share, 1.0 - share)
    return place.rumble * (4.0 * away - 1.0)
