"""Parameters as a list: each number of a nested named tuple with unit and source.

Units and sources stand once, in the docstring of the class that has the parameter.
"""

from __future__ import annotations

import difflib
import inspect
import math
import re
from collections.abc import Iterable, Mapping
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar, cast

from costeer.base.array import Real

Record = TypeVar("Record")


class Allowed(NamedTuple):
    """Values that a parameter may have.

    Attributes:
        low: Smallest.
        high: Largest.
    """

    low: Real
    high: Real


class Described(NamedTuple):
    """One parameter.

    Attributes:
        name: Dotted place, as `guidance.lateral_error_gain`.
        value: A number or a flag.
        unit: SI, "-" if there is none, empty if nobody says.
        meaning: What it is.
        source: Where the value is from.
        allowed: What it may be.
    """

    name: str
    value: Real | bool
    unit: str
    meaning: str
    source: str
    allowed: Allowed


_ATTRIBUTE = re.compile(
    r"^(?P<name>\w+): (?P<meaning>.*?)(?: \[(?P<unit>[^\]]+)\])?\."
    r"(?: Source: (?P<source>.*))?$"
)

_POSITIVE = re.compile(
    r"(mass|inertia|distance|stiffness|ratio|lag|width|length|time|duration|steepness|smoothing)$"
)
"""Names of what would be meaningless, or divided by, at zero."""

_SIGNED = re.compile(r"_(bias|offset)$")
"""Names of what lies to either side, also if it is usually nothing."""

_MOST = {"latency": 0.1}
"""Largest value of what the loop can hold back for a few control steps only [s]."""

_WIDE = 100.0
"""A parameter may be so many times larger or smaller than its usual value."""


@cache
def _attributes(kind: type) -> dict[str, tuple[str, str, str]]:
    """Meaning, unit and source of each attribute that a docstring describes."""
    text = inspect.getdoc(kind) or ""
    _, _, listed = text.partition("Attributes:\n")
    found = {}
    for paragraph in re.split(r"\n(?= {4}\w)", listed.rstrip()):
        line = " ".join(paragraph.split())
        match = _ATTRIBUTE.match(line)
        if match:
            said = match.group("meaning", "unit", "source")
            found[match["name"]] = tuple(part or "" for part in said)
    return found  # type: ignore[return-value]  # three groups make three parts


def allowed(name: str, value: Real | bool, unit: str) -> Allowed:
    """What a parameter may be, judged by its name, usual value and unit."""
    if isinstance(value, bool):
        return Allowed(0.0, 1.0)
    if value < 0.0 or _SIGNED.search(name):
        most = _WIDE * (abs(value) or 1.0)
        return Allowed(-most, most)
    if name in _MOST:
        return Allowed(0.0, _MOST[name])
    if _POSITIVE.search(name) and value > 0.0:
        return Allowed(value / _WIDE, value * _WIDE)
    if unit == "-" and value <= 1.0:
        # Tyres without any friction hold no car on the road.
        return Allowed(value / _WIDE if name == "friction" else 0.0, 1.0)
    return Allowed(0.0, _WIDE * max(1.0, value))


def described(record: Any, prefix: str = "") -> list[Described]:
    """Every number of a nested named tuple, in its order; arrays are left out.

    Args:
        record: A named tuple whose class describes its attributes.
        prefix: Of the names, with its dot.
    """
    listed: list[Described] = []
    for name in record._fields:
        value = getattr(record, name)
        if hasattr(value, "_fields"):
            listed += described(value, f"{prefix}{name}.")
        elif isinstance(value, (bool, int, float)):
            meaning, unit, source = _attributes(record.__class__).get(
                name, ("", "", "")
            )
            may = allowed(name, value, unit)
            listed.append(
                Described(f"{prefix}{name}", value, unit, meaning, source, may)
            )
    return listed


def nearest(name: str, known: Iterable[str]) -> str:
    """The names that a wrong one may have meant, for a message."""
    known = list(known)
    last = name.rpartition(".")[2]
    same = [each for each in known if each.rpartition(".")[2] == last]
    near = same or difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    return f" (did you mean {' or '.join(near)}?)" if near else ""


def with_values(record: Record, values: Mapping[str, Real]) -> Record:
    """The record with new values at dotted places.

    Raises:
        ValueError: If a place is not known or a value is out of range.
    """
    known = {each.name: each for each in described(record)}
    for name, value in values.items():
        if name not in known:
            raise ValueError(f"there is no parameter '{name}'{nearest(name, known)}")
        record = with_value_at(record, name, checked_value(known[name], value))
    return record


def checked_value(parameter: Described, value: Real) -> Real | bool:
    """The value in the type of the parameter.

    Raises:
        ValueError: If it is out of range or no number.
    """
    low, high = parameter.allowed
    flag = isinstance(parameter.value, bool)
    if not isinstance(value, int | float) or (isinstance(value, bool) and not flag):
        raise ValueError(f"{parameter.name} is {value!r}; give a number")
    whole = not isinstance(parameter.value, int) or value in (0, 1)
    if not (math.isfinite(value) and low <= value <= high and whole):
        unit = "" if parameter.unit in ("-", "") else f" {parameter.unit}"
        between = "or" if flag else "to"
        raise ValueError(
            f"{parameter.name} is {value:g}; give a number from {low:g} {between} "
            f"{high:g}{unit}"
        )
    return type(parameter.value)(value)


def value_at(record: Any, place: str) -> Any:
    """The number at a dotted place of a nested named tuple."""
    return attrgetter(place)(record)


def with_value_at(record: Record, place: str, value: Real | bool) -> Record:
    """The record with another number at a dotted place, unchecked."""
    name, _, rest = place.partition(".")
    given: Any = record  # Any: a type variable has no fields
    new = with_value_at(getattr(record, name), rest, value) if rest else value
    return cast("Record", given._replace(**{name: new}))
