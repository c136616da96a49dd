"""What a scenario is: a road, other cars, events on the way, stretches for measures.

A scenario is data: a short YAML file whose keys are the fields of these classes.
Distances are in metres along the road or across it, times in seconds; a speed is text
with its unit ("80 km/h") or a number in m/s. Lanes are counted from the right, 0 first;
left is positive.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from costeer.scenarios.mistakes import Mistake

KINDS = {"car": (4.5, 1.8), "truck": (12.0, 2.5), "obstacle": (1.0, 1.75)}
"""Kinds of actors, with length and width [m]. Sources: assumed; an obstacle is half a
lane wide."""

EVENT_KINDS = ("gust", "head-lost", "lane-change")
"""What can happen on a stretch of the road."""

AFTER_COLLISION = ("end", "restart")
"""What a trial does after a collision."""

SIDES = {"left": 1.0, "right": -1.0}
"""Sides by name, left positive."""


class Bent(NamedTuple):
    """A station of the road; between two of them the curvature changes evenly.

    Attributes:
        at: Along the road [m].
        radius: Of the left lane's centre, to the left positive; missing: straight [m].
    """

    at: float
    radius: float = math.nan


class Road(NamedTuple):
    """The road.

    Attributes:
        length: Of the course [m].
        lanes: Of this direction [-].
        lane_width: [m].
        shoulder: From the outer lines to the barriers [m].
        traffic: Side on which people drive, "left" or "right".
        speed_limit: Shown on signs; empty for none.
        stations: Where the curvature changes; none for a straight road.
        rumble_strip: Whether the outer lines can be felt.
    """

    length: float = 8000.0
    lanes: int = 2
    lane_width: float = 3.5
    shoulder: float = 2.5
    traffic: str = "left"
    speed_limit: str = ""
    stations: tuple[Bent, ...] = ()
    rumble_strip: bool = True


class Overtaking(NamedTuple):
    """Slower cars that appear ahead one after the other: the events of the paper.

    Attributes:
        cars: How many [-].
        first: Where the first appears [m].
        spacing: From one to the next [m].
        ahead: Of the driven car when it appears [m].
        slower_by: Least and largest difference to the driven car's speed.
    """

    cars: int = 4
    first: float = 1000.0
    spacing: float = 2000.0
    ahead: float = 70.0
    slower_by: tuple[str, ...] = ("5 km/h", "15 km/h")


class Stream(NamedTuple):
    """Cars all about the driven one that follow by IDM and change lanes by MOBIL.

    Attributes:
        cars: How many [-].
        reach: They are within this distance; who falls out comes in again at the
            other end [m].
        speed: That they want to drive, on average.
        spread: Standard deviation of that speed over the average [-].
        trucks: Share of trucks; they want to drive a fifth slower [-].
    """

    cars: int = 0
    reach: float = 300.0
    speed: str = "75 km/h"
    spread: float = 0.12
    trucks: float = 0.1


class When(NamedTuple):
    """At what moment something happens; give one of them.

    Attributes:
        time: Since the start [s].
        place: Of the driven car along the road [m].
        gap: From the driven car to the actor, middle to middle [m].
        time_to_collision: Of the driven car with the actor [s].
    """

    time: float = math.nan
    place: float = math.nan
    gap: float = math.nan
    time_to_collision: float = math.nan


class Order(NamedTuple):
    """Something that an actor does once.

    Attributes:
        when: At what moment.
        speed: That it drives from then on; empty: as before.
        rate: Of the speed until then [m/s²].
        lane: That it changes to [-]; none if missing.
    """

    when: When
    speed: str = ""
    rate: float = 3.0
    lane: int | None = None


class Actor(NamedTuple):
    """Another car, or something that lies on the road.

    Attributes:
        name: For people.
        kind: One of `KINDS`.
        lane: That it is in [-].
        offset: From that lane's centre [m].
        at: Where it is at the start, or appears [m].
        speed: At the start; it wants to keep it.
        follows: Whether it follows cars ahead (IDM) instead of keeping its speed.
        changes_lanes: Whether it changes lanes by itself (MOBIL).
        appears: At what moment it is there; from the start if missing.
        headway: It appears this far ahead of the driven car, in seconds of its way:
            the time to collision with something that stands [s]. Without it: `at`.
        length: Of its own; NaN: of its kind [m].
        width: As above [m].
        orders: Up to three, each given once.
    """

    name: str
    kind: str = "car"
    lane: int = 0
    offset: float = 0.0
    at: float = 0.0
    speed: str = "0"
    follows: bool = False
    changes_lanes: bool = False
    appears: When | None = None
    headway: float = math.nan
    length: float = math.nan
    width: float = math.nan
    orders: tuple[Order, ...] = ()


class Event(NamedTuple):
    """Something that happens on a stretch of the road.

    Attributes:
        kind: One of `EVENT_KINDS`.
        at: Where it begins [m].
        length: Of the stretch [m].
        force: Of a gust in its middle, to the left positive [N].
        side: Of a lane change that the driver is asked for, "left" or "right".
    """

    kind: str
    at: float
    length: float = 60.0
    force: float = 0.0
    side: str = ""


class Zone(NamedTuple):
    """A stretch of the road for which measures are computed by themselves.

    Attributes:
        name: Of the zone, as `curve`.
        start: Where it begins [m].
        end: Where it ends [m].
    """

    name: str
    start: float
    end: float


class Scenario(NamedTuple):
    """A road and what happens on it.

    Attributes:
        name: On the command line and in records: small letters, digits, hyphens.
        about: One sentence for people.
        speed: Suggested to the driver, and at the start.
        road: Where one drives.
        overtaking: Slower cars that appear ahead one after the other.
        stream: Cars all about.
        actors: Single cars and obstacles.
        events: Gusts, lost sensors, lane changes that are asked for.
        zones: Stretches for measures.
        after_collision: What a trial does after a collision: "end", or "restart" where
            a person drives.
        mistakes: What goes wrong on purpose.

    Example:
        >>> import costeer
        >>> from costeer.scenarios.definition import Bent, Road
        >>> bend = Road(length=600, stations=(Bent(100), Bent(200, radius=500)))
        >>> mine = costeer.Scenario("bend", speed="80 km/h", road=bend)
        >>> record = costeer.simulate("manual", scenario=mine, intention="off")
        >>> record.metadata["scenario"]["name"]
        'bend'
    """

    name: str
    about: str = ""
    speed: str = "70 km/h"
    road: Road = Road()
    overtaking: Overtaking = Overtaking(cars=0)
    stream: Stream = Stream()
    actors: tuple[Actor, ...] = ()
    events: tuple[Event, ...] = ()
    zones: tuple[Zone, ...] = ()
    after_collision: str = "end"
    mistakes: tuple[Mistake, ...] = ()


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
    # 3.6 km/h are 1 m/s exactly; its inverse is no exact number.
    return value / 3.6 if found[2] == "km/h" else value * _UNITS[found[2]]


_UNITS = {"m/s": 1.0, "": 1.0, "mph": 0.44704}


def curvature_of(station: Bent) -> float:
    """Curvature at a station, left positive; 0 where the road is straight [1/m]."""
    return 0.0 if math.isnan(station.radius) else 1.0 / station.radius


def size_of(actor: Actor) -> tuple[float, float]:
    """Length and width of an actor [m]."""
    length, width = KINDS[actor.kind]
    return (
        length if math.isnan(actor.length) else actor.length,
        width if math.isnan(actor.width) else actor.width,
    )


def home_lane(road: Road) -> int:
    """The lane that one drives in when nobody is overtaken."""
    return road.lanes - 1 if road.traffic == "left" else 0
