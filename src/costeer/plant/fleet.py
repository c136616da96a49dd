"""The other cars: what they are, where they are, and what one meets in a lane.

Place 0 is the car that is driven; the others follow. Their speeds are along the road's
reference line, whatever the lane.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.lookup import element, rows_of
from costeer.base.packing import packed
from costeer.plant.following import (
    LONGEST_GAP,
    Ahead,
    LaneOutlook,
)
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre

MOST_CARS = 40
"""Other cars that a scenario may have."""

SLOTS = MOST_CARS + 1

MARGIN = 0.2
"""Beside a car, within which another one is in its lane [m]. Source: assumed."""

LONG_AGO = 1e3
"""Since the last lane change of a car that has made none [s]."""

Numbers = NDArray[np.float64]

FROM_START, AT_TIME, AT_PLACE, WITHIN, TIME_TO_COLLISION, NEVER = range(6)
"""What a car appears at, or an order is given at: the start, a time [s], a place of the
driven car [m], its gap [m] or time to collision [s] to the car in question."""


class Order(NamedTuple):
    """Something that a car is told to do once.

    Attributes:
        trigger: What it is told at; `NEVER` without an order [-].
        value: Of the trigger.
        velocity: To drive from then on; NaN: as before [m/s].
        rate: Of the speed until then [m/s²].
        lane: To change to; NaN: none [-].
    """

    trigger: Real = float(NEVER)
    value: Real = 0.0
    velocity: Real = math.nan
    rate: Real = 0.0
    lane: Real = math.nan


class CarKind(NamedTuple):
    """What one of the cars is.

    Attributes:
        position: At the start, or where it appears [m].
        lateral: From the left lane's centre [m].
        lane: That it drives in [-].
        offset: From that lane's centre [m].
        velocity: At the start [m/s].
        desired: Speed it wants to drive [m/s].
        length: [m].
        width: [m].
        follows: 1 if it follows by IDM, 0 if it holds its speed [-].
        changes: 1 if it changes lanes by MOBIL [-].
        streams: 1 if it comes in again at the other end [-].
        trigger: What it appears at [-].
        value: Of the trigger.
        headway: It appears so many seconds of the driven car's way ahead; NaN: at its
            position [s].
        first: Order.
        second: Order.
        third: Order.
    """

    position: Real = 0.0
    lateral: Real = 0.0
    lane: Real = 0.0
    offset: Real = 0.0
    velocity: Real = 0.0
    desired: Real = 0.0
    length: Real = 4.5
    width: Real = 1.8
    follows: Real = 0.0
    changes: Real = 0.0
    streams: Real = 0.0
    trigger: Real = float(NEVER)
    value: Real = 0.0
    headway: Real = math.nan
    first: Order = Order()
    second: Order = Order()
    third: Order = Order()


OWN = CarKind()
"""The default car as the others see it."""


class Car(NamedTuple):
    """Where one of the cars is.

    Attributes:
        present: 1 on the road, 0 not yet [-].
        position: Of its middle along the road [m].
        lateral: From the left lane's centre [m].
        velocity: [m/s].
        acceleration: [m/s²].
        lane: That it is in or changes to [-].
        changing: Since its last lane change began [s].
        origin: Where that began, from the left lane's centre [m].
        desired: Speed it wants to drive now [m/s].
        rate: Hardest change of its speed by an order; infinite without one [m/s²].
        first: 1 when that order has been given [-].
        second: As above [-].
        third: As above [-].
    """

    present: Real = 0.0
    position: Real = 0.0
    lateral: Real = 0.0
    velocity: Real = 0.0
    acceleration: Real = 0.0
    lane: Real = 0.0
    changing: Real = LONG_AGO
    origin: Real = 0.0
    desired: Real = 0.0
    rate: Real = math.inf
    first: Real = 0.0
    second: Real = 0.0
    third: Real = 0.0


KINDS, CARS = rows_of(CarKind()), rows_of(Car())
_read_kind, _read_car, _write_car = KINDS.read, CARS.read, CARS.write


class FleetParameters(NamedTuple):
    """What the cars are; place 0 is the driven car.

    Attributes:
        num_places: Places in use, the driven car's with them [-]. Source: the scenario.
        range: Cars of a stream that are so far away come in again at the other end
            [m]. Source: the scenario.
        kinds: A `CarKind` in each row, flat.
    """

    num_places: Real
    range: Real
    kinds: Numbers


class Fleet(NamedTuple):
    """Where the cars are; place 0 is the driven car.

    Attributes:
        cars: A `Car` in each row, flat.
    """

    cars: Numbers


def fleet_parameters(
    kinds: Sequence[CarKind], reach: float = 400.0, own: CarKind = OWN
) -> FleetParameters:
    """The cars of a road.

    Args:
        kinds: Of the other cars.
        reach: Cars of a stream that are so far away come in again at the other end [m].
        own: The driven car.

    Raises:
        ValueError: If there are too many.
    """
    if len(kinds) > MOST_CARS:
        raise ValueError(f"there are {len(kinds)} other cars; give at most {MOST_CARS}")
    unused = [CarKind()] * (MOST_CARS - len(kinds))
    table = np.concatenate([packed(each) for each in (own, *kinds, *unused)])
    return FleetParameters(float(len(kinds) + 1), reach, table)


NO_FLEET = fleet_parameters(())
"""An empty road."""


def _initial_car(kind: CarKind) -> Car:
    return Car(
        position=kind.position,
        lateral=kind.lateral,
        velocity=kind.velocity,
        lane=kind.lane,
        origin=kind.lateral,
        desired=kind.desired,
    )


def initial_fleet(parameters: FleetParameters) -> Fleet:
    """The cars before the first step; none has appeared."""
    cars = [_initial_car(_read_kind(parameters.kinds, k)) for k in range(SLOTS)]
    if isinstance(parameters.kinds, np.ndarray):
        return Fleet(np.array(cars).ravel())
    numpy: Any = sys.modules["jax.numpy"]
    rows = numpy.asarray([numpy.stack([1.0 * each for each in car]) for car in cars])
    return Fleet(rows.ravel())


class Spot(NamedTuple):
    """A place from which one looks along a lane.

    Attributes:
        place: Of the car that looks; it does not see itself [-].
        position: Of its middle [m].
        lateral: Of the line along which it looks [m].
        half_width: Cars that reach into a band so wide beside it are in the way [m].
        lane: Cars on their way to it are in the way too; NaN: none [-].
    """

    place: int
    position: Real
    lateral: Real
    half_width: Real
    lane: Real = math.nan


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
    distance = cars["position"] - spot.position
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
        own = _read_kind(parameters.kinds, spot.place).length
        for other in range(int(parameters.num_places)):
            car = _read_car(fleet.cars, other)
            kind = _read_kind(parameters.kinds, other)
            if other == spot.place or car.present < 0.5:
                continue
            reach = spot.half_width + kind.width / 2.0
            if abs(car.lateral - spot.lateral) >= reach and car.lane != spot.lane:
                continue
            distance = car.position - spot.position
            gap = abs(distance) - (kind.length + own) / 2.0
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


def with_ego(fleet: Fleet, ego: Car) -> Fleet:
    """The fleet with the driven car where it is now."""
    if isinstance(fleet.cars, np.ndarray) and isinstance(ego.position, float):
        cars = fleet.cars.copy()
        _write_car(cars, 0, ego)
        return Fleet(cars)
    numpy: Any = sys.modules["jax.numpy"]
    row = numpy.stack([numpy.asarray(each, float) for each in ego])
    return Fleet(numpy.asarray(fleet.cars).at[: CARS.width].set(row))


@overload(with_ego, strict=False)
def _with_ego(fleet: Any, ego: Any) -> Any:
    def implementation(fleet: Any, ego: Any) -> Any:
        _write_car(fleet.cars, 0, ego)
        return fleet

    return implementation


@compiled
def write_cars(out: Numbers, num_cars: int, fleet: Fleet) -> None:
    """Write where the other cars are into the last numbers of a row.

    Args:
        out: The row, of which the last `3 * num_cars` numbers are filled.
        num_cars: Other cars in use [-].
        fleet: Where they are.
    """
    for place in range(num_cars):
        car: Car = _read_car(fleet.cars, place + 1)
        there, first = car.present > 0.5, len(out) + 3 * (place - num_cars)
        out[first] = xp.select(there, car.position, math.nan)
        out[first + 1] = xp.select(there, car.lateral, math.nan)
        out[first + 2] = xp.select(there, car.velocity, math.nan)


def car_numbers(fleet: Fleet, num_cars: int) -> list[Any]:
    """What `write_cars` writes, as values of JAX."""
    numbers = []
    for place in range(1, num_cars + 1):
        car: Car = _read_car(fleet.cars, place)
        there = car.present > 0.5
        said = (car.position, car.lateral, car.velocity)
        numbers += [xp.select(there, value, math.nan) for value in said]
    return numbers


@compiled
def num_cars(parameters: FleetParameters) -> int:
    """Other cars in use [-]."""
    return int(parameters.num_places) - 1


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


@compiled
def neighbours(
    parameters: FleetParameters,
    fleet: Fleet,
    road: RoadParameters,
    lane: Real,
    wanted_side: Real,
) -> Neighbours:
    """The cars about the driven one.

    Args:
        parameters: Sizes of the cars.
        fleet: Where they are, the driven one too.
        road: Its lanes.
        lane: That the driven car is in [-].
        wanted_side: Of a lane change that the scenario asks for [-].
    """
    ego: Car = _read_car(fleet.cars, 0)
    width = _read_kind(parameters.kinds, 0).width
    path = Spot(0, ego.position, ego.lateral, width / 2.0)
    return Neighbours(
        own=outlook(parameters, fleet, path),
        left=lane_outlook(parameters, fleet, road, 0, lane + 1.0),
        right=lane_outlook(parameters, fleet, road, 0, lane - 1.0),
        wanted_side=wanted_side,
    )
