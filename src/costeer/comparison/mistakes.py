"""Mistakes in a comparison: one at a time, beside none; who cannot make which."""

from __future__ import annotations

from costeer.comparison.entrants import Course, Entrant
from costeer.loop.scenario import TrialSetup
from costeer.methods.checked import hears_triggers
from costeer.methods.registry import method_named
from costeer.scenarios.mistakes import (
    CAR,
    DRIVER,
    MISTAKES,
    TRIGGER,
    lacks_lane,
    parsed_mistakes,
)
from costeer.scenarios.reading import scenario_named

NONE = "none"
"""Everything works."""


def check_mistakes(words: tuple[str, ...]) -> tuple[str, ...]:
    """The mistakes, `none` first: it is what all others are compared with.

    Args:
        words: As `late-trigger` or `late-trigger=0.8`.

    Raises:
        ValueError: If one is not known, out of range or given twice.
    """
    others = tuple(word for word in words if word != NONE)
    for word in others:
        parsed_mistakes([word])
        if others.count(word) > 1:
            raise ValueError(f"mistake {word} is given twice; name each once")
    return (NONE, *others)


def contradiction(
    mistake: str, entrant: Entrant, courses: tuple[Course, ...], intention: str
) -> str:
    """Why a method cannot have a mistake; empty if it can.

    Args:
        mistake: As it was given.
        entrant: The method.
        courses: The roads.
        intention: Where triggers come from: "network", "scripted" or "off".
    """
    if mistake == NONE:
        return ""
    (told,) = parsed_mistakes([mistake])
    whose = MISTAKES[told.kind].whose
    if whose in (CAR, DRIVER):
        return ""
    if not entrant.assists:
        return "the method gives no torque, so nothing of it can go wrong"
    if whose == TRIGGER and not hears_triggers(method_named(entrant.given)):
        return "the method hears no trigger and no indicator that could go wrong"
    if not any(happens_on(mistake, each) for each in courses):
        return "none of the roads has a lane on the wrong side"
    if told.kind == "head-lost" and intention != "network":
        return "nothing looks at the head; choose intention network"
    return ""


def happens_on(mistake: str, course: Course) -> bool:
    """Whether a mistake can happen on a road."""
    if mistake == NONE:
        return True
    (told,) = parsed_mistakes([mistake])
    return not lacks_lane(told, scenario_named(course.given).road.lanes)


def with_mistake(setup: TrialSetup, mistake: str) -> TrialSetup:
    """The trial with a mistake in it."""
    return setup if mistake == NONE else setup._replace(mistakes=(mistake,))
