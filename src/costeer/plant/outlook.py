"""What one meets in a lane: the next cars ahead and behind, seen from any car."""

from __future__ import annotations

import math
import sys
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.lookup import element
from costeer.plant.fleet import (
    CARS,
    KINDS,
    MARGIN,
    SLOTS,
    Car,
    CarKind,
    Fleet,
    FleetParameters,
)
from costeer.plant.following import LONGEST_GAP, Ahead, LaneOutlook
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre

_read_kind, _read_car = KINDS.read, CARS.read


class Spot(NamedTuple):
    """A place from which one looks along a lane.

    Attributes:
        place: Of the car that looks; it does not see itself [-].
        position: Of its middle [m].
        lateral: Of the line along which it looks [m].
        half_width: Cars that reach into a band so wide beside it are in the way [m].
        lane: Cars on their way to it are in the way too; NaN: none [-].
        strangers: 1 to see only cars that are in no stream [-].
    """

    place: int
    position: Real
    lateral: Real
    half_width: Real
    lane: Real = math.nan
    strangers: Real = 0.0


RING_ENDS = 1.05
"""Cars farther away than the stream's reach times this are out of its ring [-]. Source:
assumed, so that who cannot come in at once hinders nobody at the other end."""


@compiled
def is_on_ring(reach: Real, position: Real, ego: Real) -> Flag:
    """Whether a car of a stream is near enough to the driven one to be on its ring."""
    return xp.absolute(position - ego) <= RING_ENDS * reach


@compiled
def around_ring(distance: Real, reach: Real) -> Real:
    """The nearest distance between two cars of a stream, which is a ring [m].

    Args:
        distance: From one to the other along the road [m].
        reach: Half of the ring [m].
    """
    return distance - 2.0 * reach * xp.floor(distance / (2.0 * reach) + 0.5)


def outlook(parameters: FleetParameters, fleet: Fleet, spot: Spot) -> LaneOutlook:
    """The next cars ahead and behind along a line.

    Args:
        parameters: Sizes of the cars.
        fleet: Where they are.
        spot: From where.
    """
    if isinstance(parameters.num_places, float) and parameters.num_places <= 1.0:
        return LaneOutlook()
    jax = sys.modules.get("jax.numpy")
    traced = jax is not None and not isinstance(spot.position, float)
    numpy: Any = jax if traced else np
    kinds = _columns(numpy, CarKind, parameters.kinds, KINDS.width)
    cars = _columns(numpy, Car, fleet.cars, CARS.width)
    beside = numpy.abs(cars["lateral"] - spot.lateral)
    others = numpy.arange(SLOTS) != spot.place
    near = beside < spot.half_width + kinds["width"] / 2.0
    near = near | (cars["lane"] == spot.lane)
    seen = (cars["present"] > 0.5) & near & others
    ego, reach = cars["position"][0], parameters.range
    streams = (kinds["streams"] > 0.5) & (kinds["streams"][spot.place] > 0.5)
    streams = streams & is_on_ring(reach, cars["position"], ego)
    streams = streams & is_on_ring(reach, spot.position, ego)
    seen = seen & ~(streams & (spot.strangers > 0.5))
    straight = cars["position"] - spot.position
    ring = around_ring(straight, reach)
    distance = numpy.where(streams, ring, straight)
    half = (kinds["length"] + kinds["length"][spot.place]) / 2.0
    ahead = numpy.where(seen & (distance >= 0.0), distance - half, LONGEST_GAP)
    behind = numpy.where(seen & (distance < 0.0), -distance - half, LONGEST_GAP)
    sized = cars | {"width": kinds["width"]}
    return LaneOutlook(_nearest(sized, ahead), _nearest(sized, behind))


# Any, in these two: NumPy or JAX, and arrays of theirs.
def _columns(numpy: Any, kind: Any, flat: Any, width: int) -> dict[str, Any]:
    """The numbers of all rows by name; nested records come last and are left out."""
    table = numpy.asarray(flat).reshape(-1, width).T
    return dict(zip(kind._fields, table, strict=False))


def _nearest(cars: dict[str, Any], gaps: Any) -> Ahead:
    index = gaps.argmin()
    gap = element(gaps, index)
    seen = Ahead(
        gap=gap,
        velocity=element(cars["velocity"], index),
        desired=element(cars["desired"], index),
        lateral=element(cars["lateral"], index),
        width=element(cars["width"], index),
    )
    return xp.select(gap < LONGEST_GAP, seen, Ahead())


@overload(outlook, strict=False)
def _outlook(parameters: Any, fleet: Any, spot: Any) -> Any:
    def implementation(parameters: Any, fleet: Any, spot: Any) -> Any:
        ahead, behind = Ahead(), Ahead()
        looks, reach = _read_kind(parameters.kinds, spot.place), parameters.range
        ego = _read_car(fleet.cars, 0).position
        streams = looks.streams > 0.5 and is_on_ring(reach, spot.position, ego)
        for other in range(int(parameters.num_places)):
            car = _read_car(fleet.cars, other)
            kind = _read_kind(parameters.kinds, other)
            if other == spot.place or car.present < 0.5:
                continue
            near = spot.half_width + kind.width / 2.0
            if abs(car.lateral - spot.lateral) >= near and car.lane != spot.lane:
                continue
            distance = car.position - spot.position
            if streams and kind.streams > 0.5 and is_on_ring(reach, car.position, ego):
                if spot.strangers > 0.5:
                    continue
                distance = around_ring(distance, reach)
            gap = abs(distance) - (kind.length + looks.length) / 2.0
            seen = Ahead(gap, car.velocity, car.desired, car.lateral, kind.width)
            if distance >= 0.0:
                ahead = seen if seen.gap < ahead.gap else ahead
            else:
                behind = seen if seen.gap < behind.gap else behind
        return LaneOutlook(ahead, behind)

    return implementation


@compiled
def lane_outlook(
    parameters: FleetParameters,
    fleet: Fleet,
    road: RoadParameters,
    index: int,
    lane: Real,
) -> LaneOutlook:
    """What a car would meet in a lane.

    Args:
        parameters: Sizes of the cars.
        fleet: Where they are.
        road: Its lanes.
        index: Of the car [-].
        lane: That it is in, or might change to [-].
    """
    kind: CarKind = _read_kind(parameters.kinds, index)
    car: Car = _read_car(fleet.cars, index)
    spot = Spot(
        place=index,
        position=car.position,
        lateral=lane_centre(road, lane),
        half_width=kind.width / 2.0 + MARGIN,
        lane=lane,
    )
    return outlook(parameters, fleet, spot)


class Neighbours(NamedTuple):
    """The cars about the driven one.

    Attributes:
        own: In its way and behind it.
        left: In the lane to the left.
        right: In the lane to the right.
        wanted_side: Of a lane change that the scenario asks for, -1 right, +1 left, 0
            none [-].
    """

    own: LaneOutlook = LaneOutlook()
    left: LaneOutlook = LaneOutlook()
    right: LaneOutlook = LaneOutlook()
    wanted_side: Real = 0.0


NOBODY = Neighbours()
"""An empty road."""


@compiled
def has_cars(parameters: FleetParameters | None) -> Flag | None:
    """Whether a scenario has other cars; None where no fleet is there at all."""
    if parameters is None:
        return None
    return parameters.num_places > 1.0


@compiled
def neighbours(
    parameters: FleetParameters,
    fleet: Fleet,
    road: RoadParameters,
    lane: Real,
) -> Neighbours:
    """The cars about the driven one.

    Args:
        parameters: Sizes of the cars.
        fleet: Where they are, the driven one too.
        road: Its lanes.
        lane: That the driven car is in [-].
    """
    ego: Car = _read_car(fleet.cars, 0)
    width = _read_kind(parameters.kinds, 0).width
    path = Spot(0, ego.position, ego.lateral, width / 2.0)
    return Neighbours(
        own=outlook(parameters, fleet, path),
        left=lane_outlook(parameters, fleet, road, 0, lane + 1.0),
        right=lane_outlook(parameters, fleet, road, 0, lane - 1.0),
        wanted_side=0.0,
    )
