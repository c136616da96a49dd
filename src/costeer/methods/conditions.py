"""The seven conditions of the experiment: their names and what they set, Table IV.

Manual driving, and guidance of two strengths times three lane-change durations. A
condition's name is its identity everywhere: in commands, files and tables.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from typing import NamedTuple

from costeer.controller.actuation import STRONG, WEAK

MANUAL = "manual"
"""Name of the condition without guidance, driven first by every participant."""


class Condition(NamedTuple):
    """What a condition sets.

    Attributes:
        name: As in commands, files and tables.
        strength: `manual`, `strong` or `weak`.
        duration: `rapid`, `normal`, `gentle`; empty in manual.
        strength_factor: Factor on K_h [-]. Source: Table IV; 0 in manual.
        change_duration: ΔT_LC [s]. Source: Sec. III-B; NaN in manual.
    """

    name: str
    strength: str
    duration: str
    strength_factor: float
    change_duration: float


STRENGTHS = {"strong": STRONG, "weak": WEAK}
"""Factor on K_h [-] by name, Table IV."""

DURATIONS = {"rapid": 4.0, "normal": 6.0, "gentle": 8.0}
"""Duration of a lane change ΔT_LC [s] by name, Sec. III-B."""

CONDITIONS: tuple[Condition, ...] = (
    Condition(MANUAL, MANUAL, "", 0.0, math.nan),
    *(
        Condition(f"{strength}-{duration}", strength, duration, factor, seconds)
        for strength, factor in STRENGTHS.items()
        for duration, seconds in DURATIONS.items()
    ),
)
CONDITION_NAMES: tuple[str, ...] = tuple(each.name for each in CONDITIONS)
_BY_NAME = {each.name: each for each in CONDITIONS}


def condition(name: str) -> Condition:
    """Return the condition of that name.

    Raises:
        ValueError: If there is none.
    """
    try:
        return _BY_NAME[name]
    except KeyError:
        raise ValueError(_unknown(name)) from None


def parse_conditions(text: str) -> tuple[str, ...]:
    """Return the condition names in `text`: comma-separated, or `all`.

    Raises:
        ValueError: If one is unknown or given twice, or if there is none.
    """
    if text.strip() == "all":
        return CONDITION_NAMES
    return check_conditions(part.strip() for part in text.split(",") if part.strip())


def check_conditions(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names in the order of Table IV, whatever order they came in.

    Raises:
        ValueError: If one is unknown or given twice, or if there is none.
    """
    given = tuple(condition(name).name for name in names)
    twice = sorted({name for name in given if given.count(name) > 1})
    if twice:
        raise ValueError(f"condition {twice[0]} is given twice; name each once")
    if not given:
        raise ValueError(f"no condition given; choose from {', '.join(_BY_NAME)}")
    return tuple(name for name in CONDITION_NAMES if name in given)


def _unknown(name: str) -> str:
    near = difflib.get_close_matches(name, CONDITION_NAMES, n=1)
    guess = f" (did you mean {near[0]}?)" if near else ""
    return f"unknown condition {name!r}{guess}; choose from {', '.join(_BY_NAME)}"


def completed(
    name: str, strength_factor: float = math.nan, change_duration: float = math.nan
) -> Condition:
    """The condition that a trial is driven under.

    Args:
        name: Of Table IV, or another one with a strength of its own.
        strength_factor: On K_h; NaN: as the condition says [-].
        change_duration: ΔT_LC; NaN: as the condition says, else the method's own [s].

    Raises:
        ValueError: If the name is not known and has no strength, looks like a known
            one that is misspelt, or values contradict the known condition.
    """
    if name in _BY_NAME:
        return _not_contradicted(_BY_NAME[name], strength_factor, change_duration)
    if math.isnan(strength_factor):
        raise ValueError(
            f"{_unknown(name)}; or give a condition of your own a strength_factor"
        )
    derived = name.startswith(tuple(f"{known}-" for known in CONDITION_NAMES))
    near = difflib.get_close_matches(name, CONDITION_NAMES, n=1, cutoff=_MISSPELT)
    if near and not derived:
        raise ValueError(_unknown(name))
    if not 0.0 <= strength_factor <= 1.0:
        raise ValueError(
            f"strength_factor is {strength_factor:g}; give a number from 0 to 1"
        )
    _check_duration(change_duration)
    strength = "" if strength_factor > 0.0 else MANUAL
    return Condition(name, strength, "", strength_factor, change_duration)


_MISSPELT = 0.85
"""Likeness to a known name from which a name is taken for a slip."""


def _not_contradicted(
    known: Condition, strength_factor: float, change_duration: float
) -> Condition:
    """A condition of Table IV, if what is said besides says the same.

    Raises:
        ValueError: If not.
    """
    said = (
        ("strength_factor", strength_factor, known.strength_factor),
        ("change_duration", change_duration, known.change_duration),
    )
    for name, value, own in said:
        if not (math.isnan(value) or value == own):
            raise ValueError(
                f"condition {known.name} has {name} {own:g}, not {value:g}; leave "
                f"{name} out, or give the condition a name of its own"
            )
    return known


def _check_duration(change_duration: float) -> None:
    if not (math.isnan(change_duration) or 1.0 <= change_duration <= 30.0):
        raise ValueError(
            f"change_duration is {change_duration:g}; give a number from 1 to 30 s"
        )
