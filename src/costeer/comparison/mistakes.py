"""Mistakes that a comparison injects: their names, what they concern, who can have one.

The one place in which a mistake is handed to a trial is `with_mistake`.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from costeer.base.described import nearest
from costeer.loop.scenario import TrialSetup

NONE = "none"
"""Everything works."""

MOTOR, TRIGGER, WORLD = "motor", "trigger", "world"
"""What a mistake concerns: the torque of an assistance and what it rests on; the start
of lane changes; what is there without assistance too: driver, car, road."""

_HOME = "costeer.scenarios.mistakes"

_WORDS = (
    (TRIGGER, ("trigger", "missed", "late", "early", "side", "give", "gave")),
    (WORLD, ("sight", "friction", "evasive", "driver")),
)
"""Words in the name of a mistake that tell what it concerns; else it is the motor."""


def known_mistakes() -> tuple[str, ...]:
    """Names of the mistakes that can be injected, `none` first."""
    return (NONE, *_presets())


def _presets() -> dict[str, Any]:  # Any: a mistake is defined with the scenarios
    if find_spec(_HOME) is None:
        return {}
    return dict(import_module(_HOME).MISTAKES)


def check_mistakes(names: tuple[str, ...]) -> tuple[str, ...]:
    """The names, `none` first: it is what all others are compared with.

    Raises:
        ValueError: If one is not known or given twice.
    """
    known = known_mistakes()
    for name in names:
        if name not in known:
            raise ValueError(
                f"mistake '{name}' is not known{nearest(name, known)}; choose from "
                f"{', '.join(known)}"
            )
        if names.count(name) > 1:
            raise ValueError(f"mistake {name} is given twice; name each once")
    return (NONE, *(name for name in names if name != NONE))


def concern_of(mistake: str) -> str:
    """What a mistake concerns: as its preset says, else by its name."""
    told = getattr(_presets().get(mistake), "concerns", "")
    if told in (MOTOR, TRIGGER, WORLD):
        return str(told)
    for part, words in _WORDS:
        if any(word in mistake.split("-") for word in words):
            return part
    return MOTOR


def contradiction(mistake: str, assists: bool, starts_changes: bool) -> str:
    """Why a method cannot have a mistake; empty if it can.

    Args:
        mistake: Its name.
        assists: Whether the method gives a torque.
        starts_changes: Whether it starts lane changes.
    """
    if mistake == NONE or concern_of(mistake) == WORLD:
        return ""
    if not assists:
        return "the method gives no torque, so nothing of it can go wrong"
    if concern_of(mistake) == TRIGGER and not starts_changes:
        return "the method starts no lane change, so its trigger cannot go wrong"
    return ""


def with_mistake(setup: TrialSetup, mistake: str) -> TrialSetup:
    """The trial with a mistake in it."""
    if mistake == NONE:
        return setup
    # Any: a field that trials have as soon as there are mistakes.
    given: dict[str, Any] = {"mistakes": (mistake,)}
    return setup._replace(**given)
