"""What cannot be in a scenario: values out of range, and things that contradict."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise

from costeer.base.described import nearest
from costeer.plant.alignment import MOST_STATIONS
from costeer.plant.fleet import MOST_CARS
from costeer.plant.stretches import MOST_STRETCHES
from costeer.scenarios.actor_faults import of_actors
from costeer.scenarios.definition import (
    AFTER_COLLISION,
    EVENT_KINDS,
    KINDS,
    SIDES,
    Bent,
    Event,
    Road,
    Scenario,
    curvature_of,
    home_lane,
    speed_of,
)
from costeer.scenarios.limits import LIMITS, Fault, Place, out_of_range
from costeer.scenarios.mistakes import lacks_lane, wrong_in

FASTEST_CORNERING = 3.0
"""Lateral acceleration above which a curve is too tight for its speed [m/s²]: tyres and
guidance are nearly linear below. Source: assumed."""

_NAME = re.compile(r"[a-z][a-z0-9-]{0,39}")
_LABEL = re.compile(r"\w[\w .,()/+-]{0,39}")
_LONGEST_ABOUT = 200


def faults(scenario: Scenario) -> Iterator[Fault]:
    """Everything in a scenario that cannot be; what follows a fault may be unsound."""
    yield from _of_names(scenario)
    yield from _of_numbers(scenario)
    yield from _of_stations(scenario.road)
    yield from faults_of_speed(scenario, speed_of(scenario.speed))
    yield from _of_other_cars(scenario)
    yield from of_actors(scenario)
    yield from _of_events(scenario)
    yield from _of_zones(scenario)
    for place, text in wrong_in(scenario.mistakes):
        yield Fault(("mistakes", place), text)
    for place, mistake in enumerate(scenario.mistakes):
        if text := lacks_lane(mistake, scenario.road.lanes):
            yield Fault(("mistakes", place), text)


def _of_names(scenario: Scenario) -> Iterator[Fault]:
    if not _NAME.fullmatch(scenario.name):
        told = "give small letters, digits and hyphens, at most 40, as wet-curve"
        yield Fault(("name",), f"name {_short(scenario.name)} is no name; {told}")
    if len(scenario.about) > _LONGEST_ABOUT:
        told = f"about has {len(scenario.about)} letters; give one line of at most"
        yield Fault(("about",), f"{told} {_LONGEST_ABOUT}")
    if not scenario.about.isprintable():
        told = "about has line breaks or control characters; give one line"
        yield Fault(("about",), told)
    yield from _choice(("after_collision",), scenario.after_collision, AFTER_COLLISION)
    yield from _choice(("road", "traffic"), scenario.road.traffic, tuple(SIDES))
    for place, actor in enumerate(scenario.actors):
        yield from _choice(("actors", place, "kind"), actor.kind, tuple(KINDS))
    for place, event in enumerate(scenario.events):
        yield from _choice(("events", place, "kind"), event.kind, EVENT_KINDS)
        if event.kind == "lane-change" or event.side:
            yield from _choice(("events", place, "side"), event.side, tuple(SIDES))
    yield from _labels("actors", [each.name for each in scenario.actors])
    yield from _labels("zones", [each.name for each in scenario.zones])


def _labels(key: str, names: Sequence[str]) -> Iterator[Fault]:
    """Names of actors or zones: each once, letters that tables and figures show."""
    for place, name in enumerate(names):
        if not _LABEL.fullmatch(name):
            told = "give 1 to 40 letters, digits and spaces"
            yield Fault((key, place, "name"), f"name {_short(name)} is no name; {told}")
        if name in names[:place]:
            told = f"name {name!r} stands twice in {key}; give each its own"
            yield Fault((key, place, "name"), told)


def _short(text: str) -> str:
    return repr(text) if len(text) <= 40 else f"{text[:37]!r}..."


def _choice(place: Place, value: str, choices: Sequence[str]) -> Iterator[Fault]:
    if value not in choices:
        close = nearest(value, choices)
        told = f"{place[-1]} is {_short(value)}{close}; give one of"
        yield Fault(place, f"{told} {', '.join(choices)}")


def _of_numbers(scenario: Scenario) -> Iterator[Fault]:
    """Numbers and speeds out of their range, the road's first."""
    yield from out_of_range(scenario, ())
    for key in ("road", "overtaking", "stream"):
        yield from out_of_range(getattr(scenario, key), (key,))
    for place, event in enumerate(scenario.events):
        yield from out_of_range(event, ("events", place))
    for place, actor in enumerate(scenario.actors):
        at: Place = ("actors", place)
        yield from out_of_range(actor, at)
        if actor.appears is not None:
            yield from out_of_range(actor.appears, (*at, "appears"))
        for k, order in enumerate(actor.orders):
            yield from out_of_range(order, (*at, "orders", k))
            yield from out_of_range(order.when, (*at, "orders", k, "when"))


def _of_stations(road: Road) -> Iterator[Fault]:
    if len(road.stations) > MOST_STATIONS - 1:
        told = f"{len(road.stations)} stations; give at most {MOST_STATIONS - 1}"
        yield Fault(("road", "stations"), told)
    for k, station in enumerate(road.stations):
        place = ("road", "stations", k)
        if not 0.0 <= station.at <= road.length:
            yield Fault(
                place,
                f"the station at {station.at:g} m is not on the road; give 0 to "
                f"{road.length:g} m, or a longer road",
            )
        if station.radius == 0.0 or math.isinf(station.radius):
            told = f"a radius of {station.radius:g} m is none; leave it out where the"
            yield Fault(place, f"{told} road is straight")
        # Beyond this the lines beside the road would cross in the curve's middle.
        if abs(station.radius) <= inner_side(road, station) + road.shoulder:
            least = inner_side(road, station) + road.shoulder
            told = f"a curve of {station.radius:g} m is narrower than its own road"
            yield Fault(place, f"{told}; give more than {least:g} m")
    for k, (one, after) in enumerate(pairwise(road.stations), start=1):
        if not after.at > one.at:
            yield Fault(
                ("road", "stations", k),
                f"the station at {after.at:g} m comes after the one at {one.at:g} m; "
                "give them in rising order",
            )


def inner_side(road: Road, station: Bent) -> float:
    """From the left lane's centre to the outer line inside a curve [m]."""
    lanes = 0.5 if station.radius > 0.0 else road.lanes - 0.5
    return lanes * road.lane_width


def fastest(road: Road) -> float:
    """Greatest speed that the curves of a road allow [m/s]."""
    curves = [each for each in road.stations if curvature_of(each)]
    radii = [abs(each.radius) - _inner_lane(road, each) for each in curves]
    return math.sqrt(FASTEST_CORNERING * max(min(radii, default=math.inf), 0.0))


def _inner_lane(road: Road, station: Bent) -> float:
    """From the left lane's centre to that of the innermost lane in a curve [m]."""
    return inner_side(road, station) - road.lane_width / 2.0


def faults_of_speed(scenario: Scenario, speed: float) -> Iterator[Fault]:
    """Curves that are too tight for a speed [m/s], the tightest first."""
    tightest, slowest = speed**2 / FASTEST_CORNERING, LIMITS[Scenario]["speed"].low
    numbered = enumerate(scenario.road.stations)
    for k, station in sorted(numbered, key=lambda each: -abs(curvature_of(each[1]))):
        beside = _inner_lane(scenario.road, station)
        if abs(station.radius) - beside < tightest * (1.0 - 1e-9):
            inner = f" ({abs(station.radius) - beside:.4g} m in the inner lane)"
            slower = ", or a smaller speed" if speed > slowest + 1e-9 else ""
            yield Fault(
                ("road", "stations", k),
                f"the curve of {abs(station.radius):.4g} m{inner if beside else ''} at "
                f"{station.at:g} m is too tight for {speed * 3.6:.4g} km/h; give "
                f"{tightest + beside:.0f} m or more{slower}",
            )


def _of_other_cars(scenario: Scenario) -> Iterator[Fault]:
    stream, overtaking = scenario.stream, scenario.overtaking
    actors = len(scenario.actors)
    if actors > MOST_CARS:
        told = f"{actors} actors; give at most {MOST_CARS}"
        yield Fault(("actors", MOST_CARS), told)
    elif stream.cars > MOST_CARS - actors:
        told = f"cars is {stream.cars}; beside {actors} actors give at most"
        yield Fault(("stream", "cars"), f"{told} {MOST_CARS - actors}")
    room = 2.0 * stream.reach * scenario.road.lanes / max(stream.cars, 1)
    if stream.cars and room < 20.0:
        yield Fault(
            ("stream", "cars"),
            f"{stream.cars} cars within {stream.reach:g} m leave {room:.0f} m to each; "
            "give fewer cars or a longer reach",
        )
    last = overtaking.first + overtaking.spacing * (overtaking.cars - 1)
    if overtaking.cars and not last < scenario.road.length:
        yield Fault(
            ("overtaking",),
            f"the last car to overtake would appear at {last:g} m, on a road of "
            f"{scenario.road.length:g} m; give fewer cars or a longer road",
        )
    slower = overtaking.slower_by
    if len(slower) != 2 or speed_of(slower[0]) > speed_of(slower[1]):
        told = "give two speeds, the least and the largest difference"
        yield Fault(("overtaking", "slower_by"), f"slower_by is no range; {told}")


def _of_events(scenario: Scenario) -> Iterator[Fault]:
    if len(scenario.events) > MOST_STRETCHES:
        told = f"{len(scenario.events)} events; give at most {MOST_STRETCHES}"
        yield Fault(("events",), told)
    order = sorted(range(len(scenario.events)), key=lambda k: scenario.events[k].at)
    for k in order:
        event = scenario.events[k]
        if not event.at < scenario.road.length:
            yield Fault(
                ("events", k, "at"),
                f"the {event.kind} at {event.at:g} m can never happen on a road of "
                f"{scenario.road.length:g} m; give less, or a longer road",
            )
        yield from _of_kind(event, ("events", k))
    for one, after in pairwise(order):
        first, second = scenario.events[one], scenario.events[after]
        if second.at < first.at + first.length:
            yield Fault(
                ("events", after, "at"),
                f"the {second.kind} at {second.at:g} m begins before the "
                f"{first.kind} at {first.at:g} m has ended; move one of them",
            )
    yield from _of_changes(scenario)


def _of_kind(event: Event, at: Place) -> Iterator[Fault]:
    """A gust has a force, a lane change a side, and nothing else has either."""
    if event.kind == "gust" and event.force == 0.0:
        yield Fault(at, "a gust has no force; give it in newtons")
    for name, kind in (("force", "gust"), ("side", "lane-change")):
        if event.kind != kind and getattr(event, name):
            told = f"a {event.kind} has no {name}; leave it out, or make it a {kind}"
            yield Fault((*at, name), told)


def _of_changes(scenario: Scenario) -> Iterator[Fault]:
    """Lane changes that nobody makes: with nobody about one is in the usual lane.

    A driver who was asked to leave it goes back when the stretch has ended.
    """
    if scenario.overtaking.cars or scenario.stream.cars or scenario.actors:
        return
    home = home_lane(scenario.road)
    for k, event in enumerate(scenario.events):
        if event.kind != "lane-change" or event.side not in SIDES:
            continue
        if not 0 <= home + SIDES[event.side] < scenario.road.lanes:
            yield Fault(
                ("events", k, "side"),
                f"the lane-change at {event.at:g} m can never happen: there is no lane "
                f"to the {event.side} of the one that is driven in; to stay longer in "
                "another lane and go back, give the lane-change that leads there a "
                "greater length",
            )


def _of_zones(scenario: Scenario) -> Iterator[Fault]:
    for k, zone in enumerate(scenario.zones):
        if not 0.0 <= zone.start < zone.end <= scenario.road.length:
            yield Fault(
                ("zones", k),
                f"zone {zone.name} is from {zone.start:g} to {zone.end:g} m; give a "
                f"start of 0 or more and an end behind it, on the road of "
                f"{scenario.road.length:g} m",
            )
