"""Whether something that a user plugs in can be run: judged before it is compiled.

What is wrong with it is then said in its own words and not in those of a compiler.
`whose` is how a message calls it, as "method 'mine'".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from costeer.base.described import value_at

# Any, in this file: parameters and states are of whoever made them.
_NAME = re.compile(r"[a-z][a-z0-9-]{0,39}")
WHOLE = "a whole number"


def short(value: Any) -> str:
    """What a value is, in a line."""
    text = repr(value)
    return text if len(text) < 60 else f"{text[:50]}... ({type(value).__name__})"


def check_parts(given: Any, what: str, functions: tuple[str, ...]) -> str:
    """Refuse a plug-in without name, functions, version or source.

    Args:
        given: A named tuple with all of these fields.
        what: It is, as "method".
        functions: Fields that can be called.

    Returns:
        How messages call it.

    Raises:
        ValueError: Naming what is missing.
    """
    if not (isinstance(given.name, str) and _NAME.fullmatch(given.name)):
        raise ValueError(
            f"a {what} is called {given.name!r}; give it a name of small letters, "
            f"digits and hyphens, as my-{what.partition(' ')[0]}"
        )
    whose = f"{what} '{given.name}'"
    for part in functions:
        if not callable(getattr(given, part)):
            raise ValueError(
                f"{whose} has no {part} function; it is {getattr(given, part)!r}"
            )
    for part in ("version", "source"):
        if not isinstance(getattr(given, part), str):
            raise ValueError(
                f"{part} of {whose} is {short(getattr(given, part))}; give text"
            )
    return whose


def kinds_of(value: Any, prefix: str = "") -> dict[str, str]:
    """What each number of a nested named tuple is, by its dotted name.

    Raises:
        ValueError: If something is no number, flag or array of numbers.
    """
    if hasattr(value, "_fields"):
        parts = [
            kinds_of(getattr(value, name), f"{prefix}.{name}" if prefix else name)
            for name in value._fields
        ]
        return {name: kind for part in parts for name, kind in part.items()}
    if isinstance(value, bool | np.bool_):
        return {prefix: "a flag"}
    if isinstance(value, int | np.integer):
        return {prefix: WHOLE}
    if isinstance(value, float):
        return {prefix: "a number"}
    if isinstance(value, np.ndarray) and value.dtype.kind == "f":
        return {prefix: f"an array of shape {value.shape}"}
    raise ValueError(f"{prefix or 'the whole'} is {value!r}")


def checked_kinds(whose: str, what: str, given: Any) -> dict[str, str]:
    """The kinds in a named tuple of a plug-in.

    Raises:
        ValueError: If it is none, or holds something else.
    """
    if not hasattr(given, "_fields"):
        raise ValueError(
            f"{what} of {whose} are {short(given)}; give a named tuple of numbers, "
            "flags and arrays of floats"
        )
    try:
        return kinds_of(given)
    except ValueError as error:
        raise ValueError(
            f"{what} of {whose} are no named tuple of numbers, flags and arrays of "
            f"floats: {error}"
        ) from error


def checked_numbers(whose: str, given: Any) -> dict[str, str]:
    """The kinds in parameters, each of which can be set by name.

    Raises:
        ValueError: If one is a whole number or not finite.
    """
    kinds = checked_kinds(whose, "parameters", given)
    for name, kind in kinds.items():
        if kind == WHOLE:
            raise ValueError(
                f"parameter {name} of {whose} is a whole number and could be set to "
                "nothing between; write it as 3.0 instead of 3"
            )
        value = value_at(given, name)
        if kind == "a number" and not math.isfinite(value):
            raise ValueError(
                f"parameter {name} of {whose} is {value}; give a number that is finite"
            )
    return kinds


def called(
    whose: str, part: str, takes: str, function: Callable[..., Any], *arguments: Any
) -> Any:
    """What a function of a plug-in gives.

    Raises:
        ValueError: If it breaks.
    """
    try:
        return function(*arguments)
    except Exception as error:  # whatever somebody else's code raises
        raise ValueError(
            f"{part} of {whose} broke: {type(error).__name__}: {error}; it is called "
            f"with {takes}"
        ) from error


def checked_answer(name: str, state: Any, answer: Any, gives: str) -> Any:
    """What a step gives besides its new state.

    Args:
        name: Of the step, as "step of method 'mine'".
        state: Before it.
        answer: Of the step.
        gives: What it has to give besides.

    Raises:
        ValueError: If it is no pair, or the new state has other kinds than the old.
    """
    whose = name.partition(" of ")[2]
    if not (isinstance(answer, tuple) and len(answer) == 2):
        raise ValueError(
            f"{name} gives {short(answer)}; give the new state and {gives}"
        )
    before = checked_kinds(whose, "states", state)
    after = checked_kinds(whose, "states", answer[0])
    for place in {**before, **after}:
        if before.get(place) != after.get(place):
            raise ValueError(
                f"{name} makes {place} of the state {after.get(place, 'nothing')}, it "
                f"was {before.get(place, 'nothing')}; write a number that is to be a "
                "float as 0.0, and keep the shape of an array"
            )
    return answer[1]


def check_like(name: str, given: Any, like: Any, way_out: str) -> None:
    """Refuse what lacks a number where one is expected.

    Args:
        name: Of what gives it.
        given: By it.
        like: Of the same class, with the kinds that are expected.
        way_out: What to give.

    Raises:
        ValueError: Naming it.
    """
    what = type(like).__name__.lower()
    if not isinstance(given, type(like)):
        raise ValueError(f"{name} gives {short(given)} as its {what}; give {way_out}")
    try:
        found = kinds_of(given)
    except ValueError as error:
        raise ValueError(f"{name} gives no {what} of numbers: {error}") from error
    for place, kind in kinds_of(like).items():
        said = found.get(place, "missing")
        if said != kind and not (said == WHOLE and kind == "a number"):
            raise ValueError(f"{name} gives {place} as {said}; give {kind}")
