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
