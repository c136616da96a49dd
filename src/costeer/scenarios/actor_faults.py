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


def of_actors(scenario: Scenario) -> Iterator[Fault]:
    """Everything of a scenario's actors that cannot be."""
    for place, actor in enumerate(scenario.actors):
        at: Place = ("actors", place)
        yield from _of_place(scenario, actor, at)
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
            f"{actor.name} is at {actor.at:g} m, outside the road of {road.length:g} m",
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
    ahead = actor.headway * speed_of(scenario.speed)
    if actor.appears.place + ahead > scenario.road.length:
        yield Fault(
            (*at, "headway"),
            f"{actor.name} would appear at {actor.appears.place + ahead:.0f} m, "
            f"outside the road of {scenario.road.length:g} m",
        )


def _of_order(
    scenario: Scenario, actor: Actor, order: Order, place: Place
) -> Iterator[Fault]:
    yield from _of_moment(scenario, actor, order.when, (*place, "when"))
    most = scenario.road.lanes - 1
    if order.lane is not None and not 0 <= order.lane <= most:
        told = f"{actor.name} is to change to lane {order.lane}, which is not there"
        yield Fault((*place, "lane"), f"{told}; give 0 (right) to {most} (left)")
    if order.lane is None and not order.speed:
        yield Fault(place, f"an order of {actor.name} says neither speed nor lane")


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
            f"{scenario.road.length:g} m",
        )
    longest = 2.0 * scenario.road.length / speed_of(scenario.speed)
    if when.time > longest:
        told = f"{actor.name} waits for {when.time:g} s; the drive is over by then, at"
        yield Fault((*at, "time"), f"{told} {longest:.0f} s")


def _of_overlaps(scenario: Scenario) -> Iterator[Fault]:
    """Cars in one place when they come onto the road at one moment."""
    own = Actor("the driven car", lane=home_lane(scenario.road))
    numbered = [(-1, own), *enumerate(scenario.actors)]
    for (_, one), (place, other) in combinations(numbered, 2):
        moments = [(each.appears, each.headway) for each in (one, other)]
        lanes = (other.lane - one.lane) * scenario.road.lane_width
        aside = abs(lanes + other.offset - one.offset)
        (length, width), (other_length, other_width) = size_of(one), size_of(other)
        along = abs(other.at - one.at) < (length + other_length) / 2.0
        if (
            str(moments[0]) == str(moments[1])  # NaN is what it is
            and along
            and aside < (width + other_width) / 2.0
        ):
            yield Fault(
                ("actors", place, "at"),
                f"{other.name} and {one.name} are in one place, at {other.at:g} m; "
                "move one of them",
            )
