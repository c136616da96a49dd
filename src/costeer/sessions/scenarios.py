"""Scenarios of a plan: found by name or beside the plan, kept with its version."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from costeer.base.files import read_whole
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import chosen, parsed, scenario_named, shipped
from costeer.scenarios.reading import shipped_text as text_of_shipped
from costeer.sessions.plan import Plan, given_or_none

_LARGEST = 200_000
"""Of a scenario [bytes]."""


def scenario_text(name: str, folder: Path) -> str:
    """The file of a scenario.

    Args:
        name: Of one that ships with costeer, or of a file beside the plan.
        folder: Of the plan.

    Raises:
        ValueError: If there is none.
        OSError: If it cannot be read.
    """
    if name in shipped():
        return text_of_shipped(name)
    if not is_file_name(name):
        scenario_named(name)  # says which there are
    path = Path(name)
    if path.is_absolute() or ".." in path.parts:
        raise ValueError(
            f"scenario is {name}; put the file beside the plan and give its name"
        )
    if not (folder / path).is_file():
        raise ValueError(f"scenario {name} is not there; put it beside the plan")
    return read_whole(folder / path, _LARGEST).decode("utf-8", "replace")


def is_file_name(name: str) -> bool:
    """Whether a scenario is a file of the lab."""
    return name.endswith((".yaml", ".yml"))


@lru_cache(maxsize=64)
def scenario_in(text: str, name: str) -> Scenario:
    """The scenario of a text.

    Raises:
        ValueError: If it is none; with the line.
    """
    return parsed(text, name)


def scenario_beside(name: str, folder: Path) -> Scenario:
    """The scenario that a plan in a folder names.

    Raises:
        ValueError: If there is none.
        OSError: If it cannot be read.
    """
    return scenario_in(scenario_text(name, folder), name)


def scenario_names(plan: Plan) -> tuple[str, ...]:
    """Scenarios that somebody drives on, each once."""
    named = [
        each.scenario or plan.scenario
        for each in plan.steps
        if each.kind in ("practise", "drive", "trials")
    ]
    return tuple(dict.fromkeys(named))


def scenario_texts(plan: Plan, folder: Path) -> dict[str, str]:
    """The files of all scenarios of a plan by name.

    Raises:
        ValueError: If one is not there.
        OSError: If one cannot be read.
    """
    return {name: scenario_text(name, folder) for name in scenario_names(plan)}


def scenario_notes(plan: Plan, folder: Path) -> list[str]:
    """What a lab should know of the scenarios as its plan drives them.

    Raises:
        ValueError: If one cannot be driven so.
        OSError: If one cannot be read.
    """
    length, speed = given_or_none(plan.length), given_or_none(plan.speed)
    told = []
    for name in scenario_names(plan):
        course = chosen(scenario_beside(name, folder), length, speed)
        own = course.scenario.road.length
        if course.length > own:
            told.append(
                f"length is {course.length:g} m, longer than the {own:g} m of scenario "
                f"{name}; leave length out to end where its road does"
            )
        told += course.notes
    return told
