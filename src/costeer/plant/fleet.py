"""The other cars: what they are and where they are.

Place 0 is the car that is driven; the others follow. Their speeds are along the road's
reference line, whatever the lane.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.lookup import rows_of
from costeer.base.packing import packed

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
        range: Cars of a stream that are so far away come in again at the other end:
            half of a ring [m]. Source: the scenario.
        kinds: A `CarKind` in each row, flat [SI units]. Source: the scenario.
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


_UNUSED = packed(CarKind())


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
    table = np.tile(_UNUSED, SLOTS)
    for place, kind in enumerate((own, *kinds)):
        table[place * KINDS.width : (place + 1) * KINDS.width] = packed(kind)
    return FleetParameters(float(len(kinds) + 1), reach, table)


NO_FLEET = fleet_parameters(())
"""An empty road."""


_PLAIN = len(CarKind._fields) - 3
"""Fields of a `CarKind` before its orders."""


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
    known = isinstance(parameters.kinds, np.ndarray)
    numpy: Any = np if known else sys.modules["jax.numpy"]
    kinds = numpy.asarray(parameters.kinds).reshape(SLOTS, KINDS.width)
    read = {name: kinds[:, k] for k, name in enumerate(CarKind._fields[:_PLAIN])}
    said = _initial_car(CarKind(**read))  # of all cars at once
    columns = [numpy.broadcast_to(each, SLOTS) for each in said]
    return Fleet(numpy.stack(columns, axis=1).ravel())


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
    if isinstance(fleet, types.NoneType):
        return lambda fleet, ego: fleet

    def implementation(fleet: Any, ego: Any) -> Any:
        _write_car(fleet.cars, 0, ego)
        return fleet

    return implementation


@compiled
def write_cars(out: Numbers, num_cars: int, fleet: Fleet | None) -> None:
    """Write where the other cars are into the last numbers of a row.

    Args:
        out: The row, of which the last `3 * num_cars` numbers are filled.
        num_cars: Other cars in use [-].
        fleet: Where they are.
    """
    if fleet is None:
        return
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
def num_cars(parameters: FleetParameters | None) -> int:
    """Other cars in use [-]."""
    if parameters is None:
        return 0
    return int(parameters.num_places) - 1
