"""Scenarios from files: every key known, every value possible, errors with lines."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from functools import cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from costeer.base.described import nearest
from costeer.base.files import read_whole
from costeer.base.nested import filled, parsed_mapping
from costeer.plant.alignment import MOST_STATIONS
from costeer.plant.fleet import MOST_CARS
from costeer.plant.stretches import MOST_STRETCHES
from costeer.scenarios.definition import (
    AFTER_COLLISION,
    EVENT_KINDS,
    KINDS,
    SIDES,
    Actor,
    Scenario,
    When,
)

FASTEST_CORNERING = 3.0
"""Lateral acceleration above which a curve is too tight for its speed [m/s²]: tyres and
guidance are nearly linear below. Source: assumed."""

MOST_ORDERS = 3

_LONGEST_FILE = 200_000

Place = tuple[str | int, ...]
"""Where a value stands in a file: keys and numbers of entries, from 0."""


class Fault(NamedTuple):
    """Something that cannot be.

    Attributes:
        place: Of the value.
        text: What is wrong and what is right.
    """

    place: Place
    text: str


def speed_of(text: str) -> float:
    """A speed [m/s] from "80 km/h", "50 mph" or "22 m/s"; a bare number is in m/s.

    Raises:
        ValueError: If it is none.
    """
    found = re.fullmatch(r"\s*([-+0-9.eE]+)\s*(km/h|m/s|mph|)\s*", text)
    try:
        value = float(found[1]) if found else math.nan
    except ValueError:
        value = math.nan
    if not found or not math.isfinite(value):
        raise ValueError(f"{text!r} is no speed; give one as 80 km/h or 22 m/s")
    return value * {"km/h": 1 / 3.6, "mph": 0.44704}.get(found[2], 1.0)


@cache
def shipped() -> tuple[str, ...]:
    """Names of the scenarios that ship with costeer, the paper's first."""
    folder = files("costeer.scenarios").joinpath("catalogue")
    names = sorted(each.name.removesuffix(".yaml") for each in folder.iterdir())
    return tuple(sorted(names, key=lambda name: name != "expressway"))


@cache
def _shipped(name: str) -> Scenario:
    text = files("costeer.scenarios").joinpath(f"catalogue/{name}.yaml").read_bytes()
    return parsed(text, name)


def scenario_named(given: str | Scenario) -> Scenario:
    """A scenario by its name, from a file `NAME.yaml`, or itself.

    Raises:
        ValueError: If there is none, or its file does not say one.
        OSError: If the file cannot be read.
    """
    if isinstance(given, Scenario):
        return checked(given)
    if given in shipped():
        return _shipped(given)
    if given.endswith((".yaml", ".yml")):
        return read_scenario(Path(given))
    raise ValueError(
        f"scenario '{given}' is not known{nearest(given, shipped())}; choose one of "
        f"{', '.join(shipped())}, or give a file NAME.yaml"
    )


def read_scenario(path: Path) -> Scenario:
    """The scenario of a YAML file.

    Raises:
        ValueError: Naming the first wrong value with its line.
        OSError: If it cannot be read.
    """
    return parsed(read_whole(path, _LONGEST_FILE), str(path))


def parsed(text: bytes | str, name: str) -> Scenario:
    """The scenario of a YAML text.

    Args:
        text: UTF-8.
        name: Of the file, for messages.

    Raises:
        ValueError: Naming the first wrong value with its line.
    """
    content = parsed_mapping(text, name)
    scenario = filled(Scenario, content, name)
    for fault in faults(scenario):
        line = _line(content, fault.place)
        told = f"{name}: " if line is None else f"{name}, line {line}: "
        raise ValueError(told + fault.text)
    return scenario


def checked(scenario: Scenario) -> Scenario:
    """The scenario, if it can be.

    Raises:
        ValueError: Naming the first wrong value.
    """
    for fault in faults(scenario):
        raise ValueError(f"scenario {scenario.name}: {fault.text}")
    return scenario


def _line(content: Any, place: Place) -> int | None:  # Any: a part of a file
    """Line of a value, or of the nearest thing around it that has one."""
    line: int | None = None
    for step in place:
        lines = getattr(content, "lines", {})
        line = lines.get(step, line)
        try:
            content = content[step]
        except (KeyError, IndexError, TypeError):
            break
        first = getattr(content, "lines", {})
        line = min(first.values(), default=line) if isinstance(step, int) else line
    return line


def faults(scenario: Scenario) -> Iterator[Fault]:
    """Everything in a scenario that cannot be, one after the other."""
    yield from _of_names(scenario)
    yield from _of_speeds(scenario)
    # Without these nothing else can be judged.
    yield from _of_road(scenario)
    yield from _of_stream(scenario)
    for place, actor in enumerate(scenario.actors):
        yield from _of_actor(scenario, actor, ("actors", place))
    yield from _of_overlaps(scenario)
    yield from _of_events(scenario)
    yield from _of_zones(scenario)


def _of_names(scenario: Scenario) -> Iterator[Fault]:
    if not re.fullmatch(r"[a-z][a-z0-9-]{0,39}", scenario.name):
        yield Fault(
            ("name",),
            f"name {scenario.name!r} is no name; give small letters, digits and "
            "hyphens, as wet-curve",
        )
    yield from _choice(("after_collision",), scenario.after_collision, AFTER_COLLISION)
    yield from _choice(("road", "traffic"), scenario.road.traffic, tuple(SIDES))
    for place, actor in enumerate(scenario.actors):
        yield from _choice(("actors", place, "kind"), actor.kind, tuple(KINDS))
    for place, event in enumerate(scenario.events):
        yield from _choice(("events", place, "kind"), event.kind, EVENT_KINDS)
        if event.kind == "lane-change" or event.side:
            yield from _choice(("events", place, "side"), event.side, tuple(SIDES))


def _choice(place: Place, value: str, choices: Sequence[str]) -> Iterator[Fault]:
    if value not in choices:
        close = nearest(value, choices)
        yield Fault(
            place, f"{place[-1]} is {value!r}{close}; give one of {', '.join(choices)}"
        )


def _of_speeds(scenario: Scenario) -> Iterator[Fault]:
    given: list[tuple[Place, str, float, float]] = [
        (("speed",), scenario.speed, 12.0, 31.0),
        (("stream", "speed"), scenario.stream.speed, 3.0, 60.0),
    ]
    if scenario.road.speed_limit:
        given.append((("road", "speed_limit"), scenario.road.speed_limit, 3.0, 60.0))
    differences = scenario.overtaking.slower_by
    given.extend((("overtaking", "slower_by"), text, 0.0, 30.0) for text in differences)
    for place, actor in enumerate(scenario.actors):
        given.append((("actors", place, "speed"), actor.speed, 0.0, 70.0))
        for k, order in enumerate(actor.orders):
            if order.speed:
                where: Place = ("actors", place, "orders", k, "speed")
                given.append((where, order.speed, 0.0, 70.0))
    for each in given:
        yield from _speed(*each)


def _speed(place: Place, text: str, low: float, high: float) -> Iterator[Fault]:
    try:
        speed = speed_of(text)
    except ValueError as error:
        yield Fault(place, f"{place[-1]}: {error}")
        return
    if not low <= speed <= high:
        yield Fault(
            place,
            f"{place[-1]} is {text}; give {low * 3.6:.3g} to {high * 3.6:.3g} km/h",
        )


def _range(place: Place, value: float, low: float, high: float) -> Iterator[Fault]:
    if not low <= value <= high:
        told = f"{place[-1]} is {value:g}; give a number from {low:g} to {high:g}"
        yield Fault(place, told)


def _of_road(scenario: Scenario) -> Iterator[Fault]:
    road = scenario.road
    yield from _range(("road", "length"), road.length, 100.0, 200_000.0)
    yield from _range(("road", "lanes"), road.lanes, 2, 6)
    yield from _range(("road", "lane_width"), road.lane_width, 2.2, 6.0)
    yield from _range(("road", "shoulder"), road.shoulder, 0.3, 50.0)
    if len(road.stations) > MOST_STATIONS - 1:
        told = f"{len(road.stations)} stations; give at most {MOST_STATIONS - 1}"
        yield Fault(("road", "stations"), told)
    for k, (one, after) in enumerate(pairwise(road.stations), start=1):
        if not after.at > one.at:
            yield Fault(
                ("road", "stations", k),
                f"the station at {after.at:g} m comes after the one at {one.at:g} m; "
                "give them in rising order",
            )
    speed = speed_of(scenario.speed)
    tightest = speed * speed / FASTEST_CORNERING
    for k, station in enumerate(road.stations):
        if not abs(station.radius) >= tightest:
            yield Fault(
                ("road", "stations", k),
                f"a curve of {station.radius:g} m is too tight for "
                f"{speed * 3.6:.0f} km/h; give {tightest:.0f} m or more, or a smaller "
                "speed",
            )
        if not 0.0 <= station.at <= road.length:
            yield Fault(
                ("road", "stations", k),
                f"the station at {station.at:g} m is not on the road, which has "
                f"{road.length:g} m",
            )


def _of_stream(scenario: Scenario) -> Iterator[Fault]:
    stream, overtaking = scenario.stream, scenario.overtaking
    free = MOST_CARS - len(scenario.actors)
    yield from _range(("stream", "cars"), stream.cars, 0, max(free, 0))
    yield from _range(("stream", "reach"), stream.reach, 100.0, 2000.0)
    yield from _range(("stream", "spread"), stream.spread, 0.0, 0.5)
    yield from _range(("stream", "trucks"), stream.trucks, 0.0, 1.0)
    room = 2.0 * stream.reach * scenario.road.lanes / max(stream.cars, 1)
    if stream.cars and room < 20.0:
        yield Fault(
            ("stream", "cars"),
            f"{stream.cars} cars within {stream.reach:g} m leave {room:.0f} m to each; "
            "give fewer cars or a longer reach",
        )
    yield from _range(("overtaking", "cars"), overtaking.cars, 0, 1000)
    yield from _range(("overtaking", "ahead"), overtaking.ahead, 20.0, 1000.0)
    last = overtaking.first + overtaking.spacing * (overtaking.cars - 1)
    if overtaking.cars and not 0.0 <= last < scenario.road.length:
        yield Fault(
            ("overtaking",),
            f"the last car to overtake would appear at {last:g} m, on a road of "
            f"{scenario.road.length:g} m; give fewer cars or a longer road",
        )
    if len(overtaking.slower_by) != 2:
        told = "give two speeds, the least and the largest difference"
        yield Fault(("overtaking", "slower_by"), f"slower_by: {told}")


def _of_actor(scenario: Scenario, actor: Actor, at: Place) -> Iterator[Fault]:
    road = scenario.road
    lanes = f"lanes are 0 (right) to {road.lanes - 1} (left)"
    if not 0 <= actor.lane < road.lanes:
        told = f"{actor.name} is in lane {actor.lane}, which is not there; {lanes}"
        yield Fault((*at, "lane"), told)
    if math.isnan(actor.headway) and not -2000.0 <= actor.at <= road.length:
        yield Fault(
            (*at, "at"),
            f"{actor.name} is at {actor.at:g} m, outside the road of {road.length:g} m",
        )
    if abs(actor.offset) > road.lane_width / 2.0:
        told = f"{actor.name} is {actor.offset:g} m from its lane's centre, in no lane"
        yield Fault((*at, "offset"), told)
    if actor.appears is not None:
        yield from _of_moment(scenario, actor, actor.appears, (*at, "appears"))
    elif not math.isnan(actor.headway):
        told = f"{actor.name} has a headway but no moment at which it appears"
        yield Fault((*at, "headway"), f"{told}; give appears")
    if len(actor.orders) > MOST_ORDERS:
        told = f"{actor.name} has {len(actor.orders)} orders; give at most 3"
        yield Fault((*at, "orders"), told)
    for k, order in enumerate(actor.orders):
        place = (*at, "orders", k)
        yield from _of_moment(scenario, actor, order.when, (*place, "when"))
        if order.lane is not None and not 0 <= order.lane < road.lanes:
            told = f"{actor.name} is to change to lane {order.lane}; {lanes}"
            yield Fault((*place, "lane"), told)
        if order.lane is None and not order.speed:
            yield Fault(place, f"an order of {actor.name} says neither speed nor lane")
        yield from _range((*place, "rate"), order.rate, 0.1, 12.0)


def _of_moment(
    scenario: Scenario, actor: Actor, when: When, at: Place
) -> Iterator[Fault]:
    given = [name for name in When._fields if not math.isnan(getattr(when, name))]
    if len(given) != 1:
        told = ", ".join(given) or "nothing"
        yield Fault(
            at,
            f"{actor.name}: a moment says {told}; give one of time, place, "
            "gap and time_to_collision",
        )
    if when.place > scenario.road.length:
        yield Fault(
            (*at, "place"),
            f"{actor.name} waits for {when.place:g} m, which can never be on a road of "
            f"{scenario.road.length:g} m",
        )
    longest = 2.0 * scenario.road.length / speed_of(scenario.speed)
    if when.time > longest:
        told = f"{actor.name} waits for {when.time:g} s; the drive is over by then"
        yield Fault((*at, "time"), told)
    if any(getattr(when, name) < 0.0 for name in given):
        yield Fault(at, f"{actor.name} waits for a negative {given[0]}; give 0 or more")


def size_of(actor: Actor) -> tuple[float, float]:
    """Length and width of an actor [m]."""
    length, width = KINDS[actor.kind]
    own = actor.length, actor.width
    return (
        length if math.isnan(own[0]) else own[0],
        width if math.isnan(own[1]) else own[1],
    )


def _of_overlaps(scenario: Scenario) -> Iterator[Fault]:
    there = [
        (place, each) for place, each in enumerate(scenario.actors) if not each.appears
    ]
    home = scenario.road.lanes - 1 if scenario.road.traffic == "left" else 0
    own = (-1, Actor("the driven car", lane=home))
    for (_, one), (place, other) in (
        (a, b) for k, b in enumerate(there) for a in [own, *there[:k]]
    ):
        reach = (size_of(one)[0] + size_of(other)[0]) / 2.0
        if one.lane == other.lane and abs(one.at - other.at) < reach:
            yield Fault(
                ("actors", place, "at"),
                f"{other.name} and {one.name} are in one place, at {other.at:g} m; "
                "move one of them",
            )


def _of_events(scenario: Scenario) -> Iterator[Fault]:
    if len(scenario.events) > MOST_STRETCHES:
        told = f"{len(scenario.events)} events; give at most {MOST_STRETCHES}"
        yield Fault(("events",), told)
    order = sorted(range(len(scenario.events)), key=lambda k: scenario.events[k].at)
    for k in order:
        event = scenario.events[k]
        if not 0.0 <= event.at < scenario.road.length:
            yield Fault(
                ("events", k, "at"),
                f"the {event.kind} at {event.at:g} m can never happen on a road of "
                f"{scenario.road.length:g} m",
            )
        yield from _range(("events", k, "length"), event.length, 1.0, 100_000.0)
        yield from _range(("events", k, "force"), event.force, -10_000.0, 10_000.0)
        if event.kind == "gust" and event.force == 0.0:
            yield Fault(("events", k), "a gust has no force; give it in newtons")
    for one, after in pairwise(order):
        first, second = scenario.events[one], scenario.events[after]
        if second.at < first.at + first.length:
            yield Fault(
                ("events", after, "at"),
                f"the {second.kind} at {second.at:g} m begins before the "
                f"{first.kind} at {first.at:g} m has ended",
            )


def _of_zones(scenario: Scenario) -> Iterator[Fault]:
    for k, zone in enumerate(scenario.zones):
        if not 0.0 <= zone.start < zone.end <= scenario.road.length:
            yield Fault(
                ("zones", k),
                f"zone {zone.name} is from {zone.start:g} to {zone.end:g} m; the road "
                f"is from 0 to {scenario.road.length:g} m",
            )
