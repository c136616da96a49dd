"""How the other cars move on: triggers, orders, IDM and MOBIL.

The same source moves them one by one in compiled code and in Python, and all at once in
JAX; each by what the others were a step before.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba import types
from numba.extending import overload

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.fleet import (
    AT_PLACE,
    AT_TIME,
    CARS,
    FROM_START,
    KINDS,
    SLOTS,
    TIME_TO_COLLISION,
    WITHIN,
    Car,
    CarKind,
    Fleet,
    FleetParameters,
    Order,
)
from costeer.plant.following import (
    LONGEST_GAP,
    FollowingParameters,
    advantage,
    following_acceleration,
)
from costeer.plant.outlook import Spot, is_on_ring, lane_outlook, outlook
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import cruising_lane, lane_centre, lane_exists

_LANE_REACH = 1.5
"""Beside the centre of a lane, within which a car is in the way of one that comes in
again [m]. Source: assumed."""

_read_kind, _read_car, _write_car = KINDS.read, CARS.read, CARS.write


class World(NamedTuple):
    """What a car's next step depends on besides the cars.

    Attributes:
        road: Its lanes.
        law: Of following and lane changes.
        time: Since the trial began [s].
        dt: Step [s].
    """

    road: RoadParameters
    law: FollowingParameters
    time: Real
    dt: Real


@compiled
def is_due(
    trigger: Real, value: Real, car: Car, ego: Car, half: Real, time: Real
) -> Flag:
    """Whether a trigger holds.

    Args:
        trigger: One of `FROM_START` to `NEVER` [-].
        value: Time [s], place [m], gap [m] or time to collision [s].
        car: In question.
        ego: The driven car.
        half: Mean length of the two cars [m].
        time: Since the trial began [s].
    """
    gap = car.position - ego.position
    closing = xp.maximum(ego.velocity - car.velocity, 1e-3)
    near = (gap > 0.0) & (gap <= value)
    soon = (gap > 0.0) & (gap - half <= value * closing)
    return (
        (trigger == FROM_START)
        | ((trigger == AT_TIME) & (time >= value))
        | ((trigger == AT_PLACE) & (ego.position >= value))
        | ((trigger == WITHIN) & near)
        | ((trigger == TIME_TO_COLLISION) & soon)
    )


@compiled
def appeared(kind: CarKind, car: Car, ego: Car, own_length: Real, time: Real) -> Car:
    """The car, on the road from the step on at which its trigger holds.

    Args:
        kind: Of the car.
        car: Where it is.
        ego: The driven car.
        own_length: Of the driven car [m].
        time: Since the trial began [s].
    """
    half = (kind.length + own_length) / 2.0
    due = is_due(kind.trigger, kind.value, car, ego, half, time)
    comes = due & (car.present < 0.5)
    # No NaN in what is not taken: it would spoil gradients.
    is_ahead = kind.headway >= 0.0
    ahead = ego.position + ego.velocity * xp.select(is_ahead, kind.headway, 0.0) + half
    place = xp.select(is_ahead, ahead, car.position)
    return car._replace(
        present=xp.select(due, 1.0, car.present),
        position=xp.select(comes, place, car.position),
    )


@compiled
def changing_to(car: Car, lane: Real, starts: Flag) -> Car:
    """The car, on its way to a lane if it starts now."""
    return car._replace(
        lane=xp.select(starts, lane, car.lane),
        changing=xp.select(starts, 0.0, car.changing),
        origin=xp.select(starts, car.lateral, car.origin),
    )


@compiled
def obeying(
    order: Order, told: Real, car: Car, ego: Car, half: Real, time: Real
) -> tuple[Car, Real]:
    """The car with an order, and whether it has been given.

    Args:
        order: To this car.
        told: 1 if it has been given before [-].
        car: In question.
        ego: The driven car.
        half: Mean length of the two cars [m].
        time: Since the trial began [s].
    """
    due = is_due(order.trigger, order.value, car, ego, half, time)
    due = due & (car.present > 0.5)
    new = due & (told < 0.5)
    speeds = new & xp.isfinite(order.velocity)
    sped = car._replace(
        desired=xp.select(speeds, order.velocity, car.desired),
        rate=xp.select(speeds, order.rate, car.rate),
    )
    turns = new & xp.isfinite(order.lane)
    return changing_to(sped, order.lane, turns), xp.select(due, 1.0, told)


@compiled
def has_turn(parameters: FleetParameters, world: World, index: int) -> Flag:
    """Whether a car may take a new place at this step: one at a time.

    So no two take the same gap.
    """
    step = xp.floor(world.time / world.dt + 0.5)
    rounds = xp.floor(step / parameters.num_places)
    return step - rounds * parameters.num_places == index


@compiled
def by_mobil(
    parameters: FleetParameters, fleet: Fleet, world: World, car: Car, index: int
) -> Car:
    """The car, changing to the better lane beside it if there is one."""
    law, road = world.law, world.road
    own = lane_outlook(parameters, fleet, road, index, car.lane)
    kind: CarKind = _read_kind(parameters.kinds, index)
    length, home = kind.length, cruising_lane(road)
    rested = car.changing >= law.change_duration + law.pause
    willing = (kind.changes > 0.5) & rested & has_turn(parameters, world, index)
    best, target = 0.0, car.lane
    for side in (-1.0, 1.0):
        lane = car.lane + side
        other = lane_outlook(parameters, fleet, road, index, lane)
        safe, worth = advantage(law, car.velocity, car.desired, length, own, other)
        homewards = xp.select((home - car.lane) * side > 0.0, 1.0, -1.0)
        gain = worth + law.home_bias * homewards - law.changing_threshold
        better = safe & lane_exists(road, lane) & (gain > best)
        best, target = xp.select(better, gain, best), xp.select(better, lane, target)
    starts = willing & (target != car.lane) & (car.present > 0.5)
    return changing_to(car, target, starts)


@compiled
def accelerated(
    parameters: FleetParameters, fleet: Fleet, world: World, car: Car, index: int
) -> Real:
    """Acceleration of a car [m/s²]: by IDM, by an order, or none."""
    kind: CarKind = _read_kind(parameters.kinds, index)
    band = Spot(
        place=index,
        position=car.position,
        lateral=car.lateral,
        half_width=kind.width / 2.0,
    )
    in_way = outlook(parameters, fleet, band).ahead
    target = lane_outlook(parameters, fleet, world.road, index, car.lane).ahead
    law = world.law
    freely = following_acceleration(
        law, car.velocity, car.desired, in_way.gap, in_way.velocity
    )
    there = following_acceleration(
        law, car.velocity, car.desired, target.gap, target.velocity
    )
    ordered = xp.clip((car.desired - car.velocity) / world.dt, -car.rate, car.rate)
    limited = xp.select(xp.isfinite(car.rate), ordered, LONGEST_GAP)
    following = xp.minimum(xp.minimum(freely, there), limited)
    return xp.select(kind.follows > 0.5, following, ordered)


@compiled
def smooth(share: Real) -> Real:
    """From 0 to 1 with rest at both ends, the least jerk on the way [-]."""
    x = xp.clip(share, 0.0, 1.0)
    return x * x * x * (10.0 + x * (6.0 * x - 15.0))


@compiled
def is_away(reach: Real, position: Real, ego: Car) -> Flag:
    """Whether a place is farther from the driven car than a stream reaches [m]."""
    return xp.absolute(position - ego.position) > reach


@compiled
def other_end(reach: Real, position: Real, ego: Car) -> Real:
    """Where a car that has fallen out of the stream comes in again [m].

    A stream is a ring: cars see each other across its ends (`outlook.around_ring`),
    so who comes in has the cars ahead and behind that it had before. Who could not
    come in at once, and is out of the ring, does so at its end.
    """
    side = xp.select(position < ego.position, 1.0, -1.0)
    on_ring = is_on_ring(reach, position, ego.position)
    around = position + 2.0 * reach * side
    return xp.select(on_ring, around, ego.position + reach * side)


@compiled
def driven_on(
    kind: CarKind, reach: Real, world: World, car: Car, ego: Car, free: Flag
) -> Car:
    """The car a step later, with the acceleration it has.

    Args:
        kind: Of the car.
        reach: Of a stream to either side [m].
        world: Road, law, time and step.
        car: Before.
        ego: The driven car.
        free: Whether no obstacle or other stranger is where it would come in again.
    """
    dt = world.dt
    velocity = xp.maximum(car.velocity + car.acceleration * dt, 0.0)
    moved = car.position + (car.velocity + velocity) / 2.0 * dt
    again = (kind.streams > 0.5) & is_away(reach, moved, ego) & free
    share = smooth(car.changing / world.law.change_duration)
    centre = lane_centre(world.road, car.lane) + kind.offset
    return car._replace(
        position=xp.select(again, other_end(reach, moved, ego), moved),
        velocity=velocity,
        changing=car.changing + dt,
        lateral=car.origin + (centre - car.origin) * share,
    )


@compiled
def has_room_again(
    parameters: FleetParameters, fleet: Fleet, world: World, car: Car, index: int
) -> Flag:
    """Whether a car of a stream can come in again at the other end.

    Nobody there would have to brake for it who has not been beside it on the ring.
    Who is out of the ring is not about to change lanes, and comes in one at a time.
    """
    ego: Car = _read_car(fleet.cars, 0)
    on_ring = is_on_ring(parameters.range, car.position, ego.position)
    there = Spot(
        place=index,
        position=other_end(parameters.range, car.position, ego),
        lateral=car.lateral,
        half_width=_LANE_REACH,
        lane=car.lane,
        strangers=xp.select(on_ring, 1.0, 0.0),
    )
    seen, law = outlook(parameters, fleet, there), world.law
    ahead = law.standstill_gap + law.headway * xp.maximum(
        car.velocity, 2.0 * car.velocity - seen.ahead.velocity
    )
    behind = law.standstill_gap + law.headway * xp.maximum(
        seen.behind.velocity, 2.0 * seen.behind.velocity - car.velocity
    )
    room = (seen.ahead.gap > ahead) & (seen.behind.gap > behind)
    may = has_turn(parameters, world, index) & (car.changing > law.change_duration)
    return room & (on_ring | may)


@compiled
def moved_car(
    parameters: FleetParameters, fleet: Fleet, world: World, index: int
) -> Car:
    """One of the other cars a step later; one that is not there stays where it is."""
    kind: CarKind = _read_kind(parameters.kinds, index)
    before: Car = _read_car(fleet.cars, index)
    ego: Car = _read_car(fleet.cars, 0)
    own_length = _read_kind(parameters.kinds, 0).length
    car = appeared(kind, before, ego, own_length, world.time)
    half, time = (kind.length + own_length) / 2.0, world.time
    car, first = obeying(kind.first, car.first, car, ego, half, time)
    car, second = obeying(kind.second, car.second, car, ego, half, time)
    car, third = obeying(kind.third, car.third, car, ego, half, time)
    car = by_mobil(parameters, fleet, world, car, index)
    car = car._replace(
        acceleration=accelerated(parameters, fleet, world, car, index),
        first=first,
        second=second,
        third=third,
    )
    leaves = (kind.streams > 0.5) & is_away(parameters.range, car.position, ego)
    given = parameters, fleet, world, car, index
    free = xp.when(leaves, has_room_again, given, False)
    on = driven_on(kind, parameters.range, world, car, ego, free)
    return xp.select(car.present > 0.5, on, car)


def moved(parameters: FleetParameters, fleet: Fleet, world: World) -> Fleet:
    """All other cars a step later, each by what the others were before.

    Args:
        parameters: What they are.
        fleet: Where they are, the driven car too.
        world: Road, law, time and step.
    """
    if isinstance(parameters.num_places, float):
        new = fleet.cars.copy()
        for index in range(1, int(parameters.num_places)):
            _write_car(new, index, moved_car(parameters, fleet, world, index))
        return Fleet(new)
    return _moved_together(parameters, fleet, world)


def _moved_together(parameters: FleetParameters, fleet: Fleet, world: World) -> Fleet:
    """`moved` in JAX."""
    import jax

    numpy = jax.numpy
    places = numpy.arange(SLOTS)
    cars = jax.vmap(lambda index: moved_car(parameters, fleet, world, index))(places)
    used = (places > 0) & (places < parameters.num_places)
    new = numpy.stack([numpy.broadcast_to(each, (SLOTS,)) for each in cars], axis=1)
    old = numpy.asarray(fleet.cars).reshape(SLOTS, CARS.width)
    cars_then: Any = numpy.where(used[:, None], new, old).ravel()
    return Fleet(cars_then)


@overload(moved, strict=False)
def _moved(parameters: Any, fleet: Any, world: Any) -> Any:
    if isinstance(parameters, types.NoneType):
        return lambda parameters, fleet, world: fleet

    def implementation(parameters: Any, fleet: Any, world: Any) -> Any:
        if parameters.num_places <= 1.0:
            return fleet
        new = fleet.cars.copy()
        for index in range(1, int(parameters.num_places)):
            _write_car(new, index, moved_car(parameters, fleet, world, index))
        return Fleet(new)

    return implementation
