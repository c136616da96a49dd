"""What a page draws of a scenario: how the road runs, what stands and moves on it.

A record may come from anywhere: what a page cannot draw is left out or replaced by what
is usual, and never refused.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from costeer.base.nested import filled
from costeer.plant.alignment import MOST_STATIONS
from costeer.plant.fleet import MOST_CARS, FleetParameters
from costeer.plant.parameters import CarParameters
from costeer.plant.stretches import MOST_STRETCHES
from costeer.scenarios.definition import EVENT_KINDS, KINDS, SIDES, Scenario, speed_of
from costeer.scenarios.reading import checked
from costeer.scenarios.world import Draw, sizes_of, world_of

_LONGEST = 200_000.0
_SHARPEST = 0.02
"""Curvature of a circle of 50 m [1/m]: what is tighter is drawn so."""


def scenery_of(scenario: object) -> dict[str, object]:
    """What is drawn of a road, from the nested form of its scenario in a record.

    Returns:
        Name, shoulder [m], whether there is a rumble strip, speed limit as on a sign
        ([number, unit] or null), stations [m, 1/m], what happens from where to where
        [m] and to which side (a gust blows there), and what follows a collision.
    """
    given = _mapping(scenario)
    road = _mapping(given.get("road"))
    restarts = given.get("after_collision") == "restart"
    return {
        "name": str(given.get("name", ""))[:40],
        "shoulder": bounded(road.get("shoulder"), 2.5, 0.3, 50.0),
        "after_collision": "restart" if restarts else "end",
        "rumble_strip": road.get("rumble_strip") is not False,
        "speed_limit": _sign(road.get("speed_limit")),
        "stations": _stations(road.get("stations")),
        "events": [
            [
                each["kind"],
                at,
                at + bounded(each.get("length"), 60.0, 1.0, 1e5),
                _side(each),
            ]
            for each in _entries(given.get("events"))[:MOST_STRETCHES]
            if each.get("kind") in EVENT_KINDS
            and (at := bounded(each.get("at"), -1.0, 0.0, _LONGEST)) >= 0.0
        ],
        "zones": [
            [str(each.get("name", ""))[:40], start, end]
            for each in _entries(given.get("zones"))[:MOST_STRETCHES]
            if (start := bounded(each.get("start"), 0.0, 0.0, _LONGEST))
            < (end := bounded(each.get("end"), -1.0, 0.0, _LONGEST))
        ],
    }


def _side(event: Mapping[str, object]) -> str:
    """Side of a lane change that is asked for, or to which a gust blows."""
    if event.get("kind") == "gust":
        force = bounded(event.get("force"), 0.0, -1e9, 1e9)
        return "left" if force > 0.0 else "right"
    side = event.get("side")
    return side if isinstance(side, str) and side in SIDES else ""


def bounded(value: object, usual: float, low: float, high: float) -> float:
    """A number out of a record within what a page can draw, else what is usual."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return usual
    return float(value) if low <= value <= high else usual


# Values of a record: of any kind.
def _mapping(value: object) -> Mapping[str, object]:
    return value if isinstance(value, Mapping) else {}


def _entries(value: object) -> list[Mapping[str, object]]:
    entries = value if isinstance(value, list | tuple) else []
    return [each for each in entries if isinstance(each, Mapping)]


def _sign(limit: object) -> list[object] | None:
    """Number and unit on a sign; None without one."""
    try:
        speed = speed_of(str(limit)) if limit else math.nan
    except ValueError:
        return None
    if not 1.0 <= speed <= 100.0:
        return None
    in_miles = "mph" in str(limit)
    return [
        round(speed / (0.44704 if in_miles else 1 / 3.6)),
        "mph" if in_miles else "",
    ]


def _stations(value: object) -> list[list[float]]:
    """Places [m] and curvatures [1/m], rising; none for a straight road."""
    found: list[list[float]] = []
    for each in _entries(value)[:MOST_STATIONS]:
        at = bounded(each.get("at"), -1.0, 0.0, _LONGEST)
        if at < 0.0 or (found and at <= found[-1][0]):
            continue
        radius = bounded(each.get("radius"), math.inf, -1e9, 1e9)
        bend = 1.0 / radius if radius else 0.0
        found.append([at, min(max(bend, -_SHARPEST), _SHARPEST)])
    return found


def cars_of(scenario: Scenario, fleet: FleetParameters) -> list[list[object]]:
    """Kind, length and width [m] of each other car, in the order of its columns."""
    return [[*each.values()] for each in sizes_of(scenario, fleet)]


def cars_of_record(about: Mapping[str, object], length: float) -> list[list[object]]:
    """The same of a record; none if it does not say it.

    Older records do not say sizes; those follow from the scenario, if it is whole.
    """
    sizes = _entries(about.get("other_cars"))[:MOST_CARS]
    if sizes:
        kinds = [str(each.get("kind")) for each in sizes]
        return [
            [
                kind if kind in KINDS else "car",
                bounded(each.get("length"), KINDS["car"][0], 0.2, 30.0),
                bounded(each.get("width"), KINDS["car"][1], 0.2, 4.0),
            ]
            for kind, each in zip(kinds, sizes, strict=True)
        ]
    setup = _mapping(_mapping(about.get("configuration")).get("setup"))
    seed, participant = setup.get("seed"), setup.get("participant")
    if not isinstance(seed, int) or not isinstance(participant, int):
        return []
    try:
        given = _without_nulls(_mapping(about.get("scenario")))
        scenario = checked(filled(Scenario, given, "scenario"))
        draw = Draw(seed, participant, length, CarParameters())
        return cars_of(scenario, world_of(scenario, draw).fleet)
    except (ValueError, TypeError, OverflowError):
        return []


def _without_nulls(value: object) -> dict[str, object]:
    """A nested mapping without what is null: JSON has no NaN, the default says it."""

    def plain(each: object) -> object:
        if isinstance(each, Mapping):
            return _without_nulls(each)
        return [plain(one) for one in each] if isinstance(each, list | tuple) else each

    given = _mapping(value)
    return {str(name): plain(each) for name, each in given.items() if each is not None}
