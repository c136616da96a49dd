"""Ranges of the numbers of a scenario, and what is told of a value beyond them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from costeer.plant.fleet import MOST_CARS
from costeer.scenarios.definition import (
    Actor,
    Event,
    Order,
    Overtaking,
    Road,
    Scenario,
    Stream,
    When,
    speed_of,
)

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


class Limits(NamedTuple):
    """Smallest and largest value of a number, in SI units."""

    low: float
    high: float


LIMITS: dict[type, dict[str, Limits]] = {
    Scenario: {"speed": Limits(12.0, 31.0)},
    Road: {
        "length": Limits(100.0, 200_000.0),
        "lanes": Limits(2, 6),
        "lane_width": Limits(2.2, 6.0),
        "shoulder": Limits(0.3, 50.0),
        "speed_limit": Limits(3.0, 60.0),
    },
    Overtaking: {
        "cars": Limits(0, 1000),
        "first": Limits(0.0, 200_000.0),
        "spacing": Limits(10.0, 200_000.0),
        "ahead": Limits(20.0, 1000.0),
        "slower_by": Limits(0.0, 30.0),
    },
    Stream: {
        "cars": Limits(0, MOST_CARS),
        "reach": Limits(100.0, 2000.0),
        "speed": Limits(3.0, 60.0),
        "spread": Limits(0.0, 0.5),
        "trucks": Limits(0.0, 1.0),
    },
    When: {
        "time": Limits(0.0, 40_000.0),
        "place": Limits(0.0, 200_000.0),
        "gap": Limits(0.0, 1000.0),
        "time_to_collision": Limits(0.1, 100.0),
    },
    Order: {"speed": Limits(0.0, 70.0), "rate": Limits(0.1, 12.0)},
    Actor: {
        "at": Limits(-2000.0, 200_000.0),
        "offset": Limits(-3.0, 3.0),
        "speed": Limits(0.0, 70.0),
        "headway": Limits(0.3, 60.0),
        "length": Limits(0.2, 30.0),
        "width": Limits(0.2, 4.0),
    },
    Event: {
        "at": Limits(0.0, 200_000.0),
        "length": Limits(1.0, 100_000.0),
        "force": Limits(-10_000.0, 10_000.0),
    },
}
"""Of each number and speed by the class that has it; docs/scenarios.md lists them."""


def out_of_range(part: Any, at: Place) -> Iterator[Fault]:  # Any: a named tuple
    """Numbers and speeds of one part of a scenario that are beyond their limits.

    What was not given (NaN or an empty text by default) is not judged.
    """
    for name, limits in LIMITS.get(type(part), {}).items():
        value, usual = getattr(part, name), part._field_defaults.get(name)
        if value == usual or (value != value and usual != usual):
            continue
        texts = value if isinstance(value, tuple) else (value,)
        for each in texts:
            kind = _speed if isinstance(each, str) else _number
            yield from kind((*at, name), each, limits)


def _speed(place: Place, text: str, limits: Limits) -> Iterator[Fault]:
    try:
        speed = speed_of(text)
    except ValueError as error:
        yield Fault(place, f"{place[-1]}: {error}")
        return
    if not limits.low - 1e-9 <= speed <= limits.high + 1e-9:
        low, high = limits.low * 3.6, limits.high * 3.6
        told = f"{place[-1]} is {text}; give {low:.4g} to {high:.4g} km/h"
        if _is_bare(text):
            told += ", as 80 km/h: a number without a unit is in m/s"
        yield Fault(place, told)


def _is_bare(text: str) -> bool:
    """Whether a speed has no unit."""
    return text.strip()[-1:].isdigit()


def _number(place: Place, value: float, limits: Limits) -> Iterator[Fault]:
    if not limits.low <= value <= limits.high:
        whole = isinstance(value, int)  # which may be longer than a float can be
        shown = min(max(value, -(10**300)), 10**300) if whole else value
        yield Fault(
            place,
            f"{place[-1]} is {shown:g}; give a number from {limits.low:g} to "
            f"{limits.high:g}",
        )
