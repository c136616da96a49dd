"""What cannot be of the actors of a scenario: their places and moments."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

from costeer.scenarios.definition import (
    Actor,
    Order,
    Scenario,
    When,
    home_lane,
    size_of,
    speed_of,
)
from costeer.scenarios.limits import Fault, Place

MOST_ORDERS = 3
"""Of an actor; compiled code knows how many there are."""

_MEETINGS = ("gap", "time_to_collision")
"""Moments at which the driven car comes near the actor."""

_FLEEING = 1.25
"""No driver catches up with an actor that is so much faster than is suggested [-].
Source: assumed, beyond what the population's fastest drive."""


def of_actors(scenario: Scenario) -> Iterator[Fault]:
    """Everything of a scenario's actors that cannot be."""
    for place, actor in enumerate(scenario.actors):
        at: Place = ("actors", place)
        yield from _of_place(scenario, actor, at)
        yield from _of_kind(actor, at)
        yield from _of_appearance(scenario, actor, at)
        if len(actor.orders) > MOST_ORDERS:
            told = f"{actor.name} has {len(actor.orders)} orders; give at most"
            yield Fault((*at, "orders"), f"{told} {MOST_ORDERS}")
        for k, order in enumerate(actor.orders):
            yield from _of_order(scenario, actor, order, (*at, "orders", k))
    yield from _of_overlaps(scenario)


def _of_place(scenario: Scenario, actor: Actor, at: Place) -> Iterator[Fault]:
    road = scenario.road
    if not 0 <= actor.lane < road.lanes:
        told = f"{actor.name} is in lane {actor.lane}, which is not there; give"
        yield Fault((*at, "lane"), f"{told} 0 (right) to {road.lanes - 1} (left)")
    if math.isnan(actor.headway) and actor.at > road.length:
        yield Fault(
            (*at, "at"),
            f"{actor.name} is at {actor.at:g} m, outside the road of {road.length:g} m;"
            " give less, or a longer road",
        )
    if not abs(actor.offset) <= road.lane_width / 2.0:
        told = f"{actor.name} is {actor.offset:g} m from its lane's centre, in no lane"
        yield Fault((*at, "offset"), f"{told}; give at most {road.lane_width / 2:g} m")


def _of_appearance(scenario: Scenario, actor: Actor, at: Place) -> Iterator[Fault]:
    if actor.appears is not None:
        yield from _of_moment(scenario, actor, actor.appears, (*at, "appears"))
    if math.isnan(actor.headway):
        return
    if actor.appears is None:
        told = f"{actor.name} has a headway but no moment at which it appears"
        yield Fault((*at, "headway"), f"{told}; give appears")
        return
    if actor.at != 0.0:
        told = f"{actor.name} has a place and a headway; give one of at and headway"
        yield Fault((*at, "headway"), told)
    for name in _MEETINGS:
        if not math.isnan(getattr(actor.appears, name)):
            told = f"{actor.name} has a headway, and a {name} to wait for until it"
            yield Fault((*at, "appears"), f"{told} appears; give time or place, or at")
    ahead = actor.headway * speed_of(scenario.speed)
    if actor.appears.place + ahead > scenario.road.length:
        yield Fault(
            (*at, "headway"),
            f"{actor.name} would appear at {actor.appears.place + ahead:.0f} m, "
            f"outside the road of {scenario.road.length:g} m; let it appear sooner",
        )


def _of_kind(actor: Actor, at: Place) -> Iterator[Fault]:
    """What lies on the road does not drive."""
    if actor.kind != "obstacle":
        return
    for name, said in (("speed", speed_of(actor.speed)), ("orders", actor.orders)):
        if said:
            told = f"{actor.name} is an obstacle and has {name}; leave them out, or"
            yield Fault((*at, name), f"{told} make it a car or truck")


def _of_order(
    scenario: Scenario, actor: Actor, order: Order, place: Place
) -> Iterator[Fault]:
    yield from _of_moment(scenario, actor, order.when, (*place, "when"))
    most = scenario.road.lanes - 1
    if order.lane is not None and not 0 <= order.lane <= most:
        told = f"{actor.name} is to change to lane {order.lane}, which is not there"
        yield Fault((*place, "lane"), f"{told}; give 0 (right) to {most} (left)")
    if order.lane is None and not order.speed:
        told = f"an order of {actor.name} says neither speed nor lane; give one or both"
        yield Fault(place, told)
    elsewhere = {each.lane for each in actor.orders} - {None, actor.lane}
    if order.lane == actor.lane and not elsewhere and not actor.changes_lanes:
        told = f"{actor.name} is to change to lane {order.lane}, where it is already"
        yield Fault((*place, "lane"), f"{told}; give another, or leave it out")
    yield from _of_flight(scenario, actor, order, place)


def _of_flight(
    scenario: Scenario, actor: Actor, order: Order, place: Place
) -> Iterator[Fault]:
    """Who drives away from the driven car is never met."""
    speeds = [each.speed for each in actor.orders if each.speed]
    slowest = min(map(speed_of, [actor.speed, *speeds]))
    flees = slowest > _FLEEING * speed_of(scenario.speed) and not actor.follows
    waits = [name for name in _MEETINGS if not math.isnan(getattr(order.when, name))]
    far = actor.at > (0.0 if math.isnan(order.when.gap) else order.when.gap)
    if waits and flees and far:
        told = f"{actor.name} waits for a {waits[0]} that never comes: it is faster"
        yield Fault((*place, "when"), f"{told} than the driven car; give it less speed")


def _of_moment(
    scenario: Scenario, actor: Actor, when: When, at: Place
) -> Iterator[Fault]:
    given = [name for name in When._fields if not math.isnan(getattr(when, name))]
    if len(given) != 1:
        told = " and ".join(given) or "nothing"
        yield Fault(
            at,
            f"{actor.name}: a moment says {told}; give one of time, place, "
            "gap and time_to_collision",
        )
    if when.place >= scenario.road.length:
        yield Fault(
            (*at, "place"),
            f"{actor.name} waits for {when.place:g} m, which can never be on a road of "
            f"{scenario.road.length:g} m; give less, or a longer road",
        )
    longest = 2.0 * scenario.road.length / speed_of(scenario.speed)
    if when.time > longest:
        told = f"{actor.name} waits for {when.time:g} s; the drive is over by then, at"
        yield Fault((*at, "time"), f"{told} {longest:.0f} s; give less")


def _of_overlaps(scenario: Scenario) -> Iterator[Fault]:
    """Cars in one place when they come onto the road at one moment."""
    own = Actor("the driven car", lane=home_lane(scenario.road))
    numbered = [(-1, own), *enumerate(scenario.actors)]
    for (k, one), (place, other) in combinations(numbered, 2):
        met = _own_place(scenario, other) if k < 0 else _together(one, other)
        if math.isnan(met):
            continue
        lanes = (other.lane - one.lane) * scenario.road.lane_width
        aside = abs(lanes + other.offset - one.offset)
        (length, width), (other_length, other_width) = size_of(one), size_of(other)
        along = abs(other.at - met) < (length + other_length) / 2.0
        if along and aside < (width + other_width) / 2.0:
            yield Fault(
                ("actors", place, "at"),
                f"{other.name} and {one.name} are in one place, at {other.at:g} m; "
                "move one of them",
            )


def _together(one: Actor, other: Actor) -> float:
    """Where one actor is when another appears; NaN if not at one moment [m]."""
    moments = [str((each.appears, each.headway)) for each in (one, other)]
    return one.at if moments[0] == moments[1] else math.nan  # as text: NaN is itself


def _own_place(scenario: Scenario, actor: Actor) -> float:
    """Where the driven car is when an actor appears, as far as one can say [m].

    It is in its usual lane, at the speed that is suggested; NaN with a headway.
    """
    when = actor.appears
    if when is None:
        return 0.0
    if not math.isnan(actor.headway):
        return math.nan
    by_time = when.time * speed_of(scenario.speed)
    places = (when.place, by_time, actor.at - when.gap)
    return next((each for each in places if not math.isnan(each)), math.nan)
