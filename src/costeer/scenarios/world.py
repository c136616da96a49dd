"""What the simulation runs of a scenario: road, other cars and stretches as numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.plant.alignment import Alignment, alignment
from costeer.plant.fleet import (
    AT_PLACE,
    AT_TIME,
    FROM_START,
    MOST_CARS,
    TIME_TO_COLLISION,
    WITHIN,
    CarKind,
    FleetParameters,
    fleet_parameters,
    num_cars,
)
from costeer.plant.fleet import KINDS as ROWS
from costeer.plant.fleet import Order as CarOrder
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.stretches import Stretch, Stretches, stretches
from costeer.plant.traffic import TrafficParameters
from costeer.scenarios.definition import (
    KINDS,
    SIDES,
    Actor,
    Bent,
    Order,
    Overtaking,
    Road,
    Scenario,
    When,
    curvature_of,
    size_of,
    speed_of,
)

_STREAM = 7
"""Of the random numbers of the other cars, apart from those of the driver."""

_TRIGGERS = {
    "time": AT_TIME,
    "place": AT_PLACE,
    "gap": WITHIN,
    "time_to_collision": TIME_TO_COLLISION,
}

_FREE_AHEAD = 40.0
"""No car of a stream begins nearer to the driven one [m]."""

_FASTER_BY = 0.08
"""What cars in the next lane towards overtaking want to drive faster [-]."""

_TRUCKS_SLOWER = 0.9
"""Speed that trucks want to drive over that of cars [-]."""


class World(NamedTuple):
    """A scenario as the loop takes it.

    Attributes:
        road: Its lanes.
        alignment: How it runs.
        traffic: Cars that appear one after the other.
        fleet: All other cars.
        stretches: What happens along the road.
    """

    road: RoadParameters
    alignment: Alignment
    traffic: TrafficParameters
    fleet: FleetParameters
    stretches: Stretches


class Draw(NamedTuple):
    """Which drive it is: the same numbers give the same other cars.

    Attributes:
        seed: Of the study.
        participant: Number of the driver.
        length: Of the course [m].
        car: That is driven.
    """

    seed: int
    participant: int
    length: float
    car: CarParameters


def world_of(scenario: Scenario, draw: Draw) -> World:
    """A scenario as the loop takes it.

    Args:
        scenario: Checked before.
        draw: Which drive it is.
    """
    road = road_of(scenario.road, draw.length)
    return World(
        road=road,
        alignment=alignment_of(scenario.road),
        traffic=_traffic(scenario.overtaking),
        fleet=fleet_on(scenario, draw, road),
        stretches=_stretches(scenario),
    )


def fleet_on(scenario: Scenario, draw: Draw, road: RoadParameters) -> FleetParameters:
    """The driven car and all others but those to overtake.

    Args:
        scenario: Checked before.
        draw: Which drive it is, with the car as it is driven.
        road: As it is driven on, which may be another than the scenario's.
    """
    own = CarKind(length=draw.car.length, width=draw.car.width)
    others = others_of(scenario, draw, road)
    return fleet_parameters(others, scenario.stream.reach, own)


def others_of(
    scenario: Scenario, draw: Draw, road: RoadParameters | None = None
) -> list[CarKind]:
    """All other cars but those to overtake: the actors first, then the stream."""
    road = road or road_of(scenario.road, draw.length)
    return [*_actors(scenario, road), *_stream(scenario, road, draw)]


def sizes_of(scenario: Scenario, fleet: FleetParameters) -> list[dict[str, object]]:
    """Kind, length and width [m] of each other car, in the order of its columns.

    Args:
        scenario: Whose actors come first.
        fleet: Of its drive.
    """
    kinds = [each.kind for each in scenario.actors]
    long = KINDS["truck"][0] - 0.1
    sizes: list[dict[str, object]] = []
    for place in range(num_cars(fleet)):
        row = ROWS.read(fleet.kinds, place + 1)
        streams = "truck" if row.length > long else "car"
        sizes.append(
            {
                "kind": kinds[place] if place < len(kinds) else streams,
                "length": float(row.length),
                "width": float(row.width),
            }
        )
    return sizes


def road_of(road: Road, length: float) -> RoadParameters:
    """The lanes of a road over a length [m]."""
    return RoadParameters(
        lane_width=road.lane_width,
        num_lanes=float(road.lanes),
        length=length,
        overtaking_side=-SIDES[road.traffic],
        shoulder=road.shoulder,
        rumble=RoadParameters().rumble if road.rumble_strip else 0.0,
    )


def alignment_of(road: Road) -> Alignment:
    """How a road runs; it begins with the curvature of its first station."""
    places = [station.at for station in road.stations]
    bends = [curvature_of(station) for station in road.stations]
    if places and places[0] > 0.0:
        places, bends = [0.0, *places], [bends[0], *bends]
    return alignment(places, bends)


def curvatures(
    stations: Sequence[Bent], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Curvature of the left lane's centre at places along the road [1/m].

    Args:
        stations: Of the road; none: it is straight.
        places: [m].
    """
    if not stations:
        return np.zeros_like(places)
    bends = [curvature_of(each) for each in stations]
    return np.interp(places, [each.at for each in stations], bends)


def _traffic(overtaking: Overtaking) -> TrafficParameters:
    low, high = (speed_of(each) for each in overtaking.slower_by)
    return TrafficParameters(
        first_event=overtaking.first,
        event_spacing=overtaking.spacing,
        num_events=float(overtaking.cars),
        appearance_distance=overtaking.ahead,
        smallest_difference=low,
        largest_difference=high,
    )


def _trigger(when: When | None) -> tuple[float, float]:
    """Number of a trigger and its value."""
    if when is None:
        return float(FROM_START), 0.0
    for name, number in _TRIGGERS.items():
        value = getattr(when, name)
        if not math.isnan(value):
            return float(number), value
    return float(FROM_START), 0.0


def _order(order: Order) -> CarOrder:
    trigger, value = _trigger(order.when)
    return CarOrder(
        trigger=trigger,
        value=value,
        velocity=speed_of(order.speed) if order.speed else math.nan,
        rate=order.rate,
        lane=math.nan if order.lane is None else float(order.lane),
    )


def _actors(scenario: Scenario, road: RoadParameters) -> list[CarKind]:
    return [_actor(each, road) for each in scenario.actors]


def _actor(actor: Actor, road: RoadParameters) -> CarKind:
    length, width = size_of(actor)
    trigger, value = _trigger(actor.appears)
    orders = [_order(each) for each in actor.orders]
    orders += [CarOrder()] * (3 - len(orders))
    speed = speed_of(actor.speed)
    return CarKind(
        position=actor.at,
        lateral=lane_centre(road, actor.lane) + actor.offset,
        lane=float(actor.lane),
        offset=actor.offset,
        velocity=speed,
        desired=speed,
        length=length,
        width=width,
        follows=float(actor.follows),
        changes=float(actor.changes_lanes),
        trigger=trigger,
        value=value,
        headway=actor.headway,
        first=orders[0],
        second=orders[1],
        third=orders[2],
    )


def _stream(scenario: Scenario, road: RoadParameters, draw: Draw) -> list[CarKind]:
    """Cars all about, evenly over the lanes, each with a speed of its own."""
    stream = scenario.stream
    cars = min(stream.cars, MOST_CARS - len(scenario.actors))
    rng = np.random.default_rng([draw.seed, draw.participant, _STREAM])
    lanes = int(road.num_lanes)
    home, mean = int(cruising_lane(road)), speed_of(stream.speed)
    found = []
    for k in range(cars):
        lane = (home + k) % lanes
        row, rows = k // lanes, -(-cars // lanes)
        share = (row + 0.3 + 0.4 * rng.random()) / rows
        place = (2.0 * share - 1.0) * stream.reach
        is_truck = bool(rng.random() < stream.trucks)
        desired = mean * (1.0 + stream.spread * float(rng.uniform(-1.7, 1.7)))
        desired *= 1.0 + _FASTER_BY * abs(lane - home)
        desired *= _TRUCKS_SLOWER if is_truck else 1.0
        if lane == home and abs(place) < _FREE_AHEAD:
            place = math.copysign(_FREE_AHEAD, place)
        found.append(_streaming(road, lane, place, max(desired, 3.0), is_truck))
    return found


def _streaming(
    road: RoadParameters, lane: int, place: float, desired: float, is_truck: bool
) -> CarKind:
    length, width = KINDS["truck" if is_truck else "car"]
    return CarKind(
        position=place,
        lateral=lane_centre(road, lane),
        lane=float(lane),
        velocity=desired,
        desired=desired,
        length=length,
        width=width,
        follows=1.0,
        changes=1.0,
        streams=1.0,
        trigger=float(FROM_START),
    )


def _stretches(scenario: Scenario) -> Stretches:
    return stretches(
        [
            Stretch(
                start=event.at,
                end=event.at + event.length,
                side_force=event.force,
                head_lost=float(event.kind == "head-lost"),
                wanted_side=SIDES.get(event.side, 0.0),
            )
            for event in scenario.events
        ]
    )
