"""The file of a plan: read, and refused with its line where nobody could drive it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any

from costeer.base.files import read_whole
from costeer.base.nested import filled, parsed_mapping
from costeer.loop.scenario import check_setup, loop_parameters
from costeer.methods.conditions import CONDITION_NAMES
from costeer.methods.conditions import condition as condition_named
from costeer.runtime.setup import INTENTION_SOURCES
from costeer.scenarios.reading import chosen
from costeer.scenarios.unreadable import in_words
from costeer.sessions.plan import (
    KINDS,
    ORDERS,
    PLAN_FILE,
    Plan,
    PlanStep,
    given_or_none,
    planned_trials,
    session_steps,
    trial_of,
)
from costeer.sessions.scenarios import scenario_beside
from costeer.study.design import MOST_CONDITIONS

_OWN = {
    "instruct": {"text"},
    "consent": {"text", "instrument"},
    "ask": {"text", "instrument"},
    "practise": {
        *("text", "condition", "method", "minutes", "longest_minutes", "sdlp_below"),
        "scenario",
    },
    "drive": {"text", "condition", "method", "scenario", "label"},
    "break": {"text", "minutes"},
    "trials": {
        *("text", "method", "minutes", "conditions", "order", "after", "break_every"),
        *("scenario", "label"),
    },
}
"""Entries that mean something for a kind of step."""

LABEL = re.compile(r"[a-z0-9][a-z0-9-]{0,19}")
"""What tells drives of a condition apart; it stands in names of files."""

_READ_AS_FALSE = {"intention": "off", "language": "no"}
"""Words that YAML takes for "false" where they stand without quotes."""

LARGEST = 200_000
"""Of a plan [bytes]."""

_SDLP = (0.05, 2.0)
"""Smallest and largest criterion of a practice [m]: nobody fails or passes beyond."""

LONGEST_MINUTES = 120.0
"""Of a practice or a break."""


def paper_plan_text() -> str:
    """The plan of the paper's experiment, as it is written into a new folder."""
    return files("costeer.sessions").joinpath("paper.yaml").read_text("utf-8")


def plan_file_in(folder: Path) -> Path:
    """The plan of the study in a folder.

    Raises:
        ValueError: If there is none.
    """
    file = folder / PLAN_FILE
    if not file.is_file():
        raise ValueError(
            f"{folder} holds no study with people, as there is no {PLAN_FILE} in "
            f"it; make one with: costeer session new {folder}"
        )
    return file


def read_plan(path: Path) -> Plan:
    """The plan of a file.

    Raises:
        ValueError: If it cannot be; with the line.
        OSError: If it cannot be read.
    """
    return parsed_plan(read_whole(path, LARGEST), str(path))


def parsed_plan(text: bytes | str, name: str = PLAN_FILE) -> Plan:
    """The plan of a text.

    Args:
        text: UTF-8.
        name: Of its file, for messages; files of scenarios lie beside it.

    Raises:
        ValueError: If it cannot be.
        OSError: If a scenario cannot be read.
    """
    given, plan = _read(text, name)
    _check_head(plan, name)
    places = [f"{name}{_line(entry)}: step" for entry in given["steps"]]
    wheres = [f"{place} {n}" for n, place in enumerate(places, start=1)]
    for entry, where in zip(plan.steps, wheres, strict=True):
        _check_step(entry, where)
    _check_labels(plan, wheres)
    _check_scenarios(plan, given, name, wheres)
    _check_trials(plan, name)
    return plan


def _read(text: bytes | str, name: str) -> tuple[Mapping[str, Any], Plan]:
    """What stands in a plan, with lines, and the plan that it makes.

    Raises:
        ValueError: If it is no plan; with the line.
    """
    try:
        given = parsed_mapping(text, name)
        for key, word in _READ_AS_FALSE.items():
            if given.get(key) is False:
                given[key] = word
        return given, filled(Plan, given, name)
    except ValueError as error:
        told = in_words(error, text, name).replace("any scenario", "any plan")
        raise ValueError(told) from error


def kept_plan(text: str, name: str) -> Plan:
    """A plan that somebody has begun with: read, and judged no more.

    Raises:
        ValueError: If it cannot be read.
    """
    return _read(text, name)[1]


def _line(entry: Mapping[str, Any]) -> str:  # Any: as YAML gives it back
    lines = getattr(entry, "lines", {}).values()
    return f", line {min(lines)}" if lines else ""


def _check_head(plan: Plan, name: str) -> None:
    """Refuse what holds for the whole plan.

    Raises:
        ValueError: Naming the entry, the value and the way out.
    """
    if not plan.title.strip():
        raise ValueError(f"{name}: title is empty; participants read it")
    if not plan.steps:
        raise ValueError(f"{name} has no steps; list them under steps:")
    if not 1 <= plan.participants <= 1000:
        raise ValueError(f"{name}: participants is {plan.participants}; give 1 to 1000")
    if not 0 <= plan.seed < 2**31:
        raise ValueError(f"{name}: seed is {plan.seed}; give 0 to {2**31 - 1}")
    if plan.intention not in INTENTION_SOURCES:
        raise ValueError(
            f"{name}: intention '{plan.intention}' is not known; choose one of "
            f"{', '.join(INTENTION_SOURCES)}"
        )


def _check_step(step: PlanStep, where: str, inner: bool = False) -> None:
    """Refuse an entry that is not whole.

    Raises:
        ValueError: Naming it.
    """
    known = ("ask", "instruct") if inner else KINDS
    if step.kind not in known:
        raise ValueError(f"{where}: kind '{step.kind}' is none of {', '.join(known)}")
    where = f"{where} ({step.kind})"
    _check_own(step, where)
    if step.kind in ("ask", "consent") and not step.instrument:
        example = "consent" if step.kind == "consent" else "nasa-tlx"
        raise ValueError(f"{where} names no instrument, as instrument: {example}")
    if step.kind == "instruct" and not step.text.strip():
        raise ValueError(f"{where} has no text; give one, or a name of the text files")
    if step.kind in ("practise", "drive"):
        if not step.condition:
            given = ", ".join(CONDITION_NAMES)
            raise ValueError(f"{where} names no condition; give one of {given}")
        with _at(where):
            condition_named(step.condition)
    if step.kind == "practise":
        _check_practice(step, where)
    if step.kind in ("break", "trials") and not _is_length(step.minutes):
        raise ValueError(
            f"{where}: minutes is {step.minutes:g}; give 0 to {LONGEST_MINUTES:g}"
        )
    if step.kind == "trials":
        _check_block(step, where)


def _check_own(step: PlanStep, where: str) -> None:
    """Refuse an entry that would mean nothing here.

    Raises:
        ValueError: Naming it.
    """
    for field, usual in PlanStep._field_defaults.items():
        value = getattr(step, field)
        is_usual = value == usual or (value != value and usual != usual)  # NaN
        if field not in _OWN[step.kind] and not is_usual:
            raise ValueError(
                f"{where}: {field} says nothing here; leave it out, or give one of "
                f"{', '.join(sorted(_OWN[step.kind]))}"
            )


def _is_length(minutes: float) -> bool:
    return math.isnan(minutes) or 0.0 <= minutes <= LONGEST_MINUTES


def _check_practice(step: PlanStep, where: str) -> None:
    """Refuse a practice that could not be passed.

    Raises:
        ValueError: Naming what is wrong.
    """
    if not 0.0 < step.minutes <= LONGEST_MINUTES:
        raise ValueError(
            f"{where}: minutes is {step.minutes:g}; give 0.1 to {LONGEST_MINUTES:g}"
        )
    if not step.minutes <= step.longest_minutes <= LONGEST_MINUTES:
        raise ValueError(
            f"{where}: longest_minutes is {step.longest_minutes:g}; give minutes "
            f"({step.minutes:g}) to {LONGEST_MINUTES:g}"
        )
    low, high = _SDLP
    if not (math.isnan(step.sdlp_below) or low <= step.sdlp_below <= high):
        raise ValueError(
            f"{where}: sdlp_below is {step.sdlp_below:g} m; give {low:g} to {high:g}, "
            "0.3 or so, or leave it out"
        )


def _check_block(step: PlanStep, where: str) -> None:
    """Refuse a block of trials that cannot be ordered.

    Raises:
        ValueError: Naming what is wrong.
    """
    with _at(where):
        names = [condition_named(name).name for name in step.conditions]
    if not names or len(set(names)) != len(names):
        raise ValueError(
            f"{where}: conditions are {list(step.conditions)}; name each once, of "
            f"{', '.join(CONDITION_NAMES)}"
        )
    if step.order not in ORDERS:
        raise ValueError(
            f"{where}: order '{step.order}' is not known; choose one of "
            f"{', '.join(ORDERS)}"
        )
    if step.order == "williams" and len(names) > MOST_CONDITIONS:
        raise ValueError(
            f"{where}: {len(names)} conditions; a balanced order has up to "
            f"{MOST_CONDITIONS}"
        )
    if step.break_every < 0:
        raise ValueError(f"{where}: break_every is {step.break_every}; give 0 or more")
    for place, each in enumerate(step.after, start=1):
        _check_step(each, f"{where}, after, entry {place}", inner=True)


def _check_labels(plan: Plan, wheres: Sequence[str]) -> None:
    """Refuse trials that tables could not tell apart.

    Raises:
        ValueError: Naming the second, or a label that is none.
    """
    places: dict[str, str] = {}
    for (place, _), trial in planned_trials(plan).items():
        where = f"{wheres[place]} ({plan.steps[place].kind})"
        label = plan.steps[place].label
        if label and not LABEL.fullmatch(label):
            raise ValueError(
                f"{where}: label is {label!r}; give 1 to 20 small letters, digits and "
                "hyphens, as after"
            )
        if trial.label in places:
            raise ValueError(
                f"{where}: {trial.label} is driven in {places[trial.label]} too; give "
                "one of them another label, as label: after"
            )
        places[trial.label] = wheres[place].rpartition(": ")[2]


def _check_scenarios(
    plan: Plan, given: Mapping[str, Any], name: str, wheres: Sequence[str]
) -> None:  # Any: as YAML gives it back
    """Refuse scenarios that are not there or cannot be driven so.

    Raises:
        ValueError: Naming the line, the scenario and the way out.
        OSError: If a file cannot be read.
    """
    folder = Path(name).parent
    speed = given_or_none(plan.speed)
    line = getattr(given, "lines", {}).get("scenario")
    head = name if line is None else f"{name}, line {line}"
    places = {plan.scenario: head}
    for each, where in zip(plan.steps, wheres, strict=True):
        if each.scenario:
            places.setdefault(each.scenario, f"{where} ({each.kind})")
    for scenario, where in places.items():
        with _at(where):
            chosen(scenario_beside(scenario, folder), None, speed)


def _check_trials(plan: Plan, name: str) -> None:
    """Refuse drives that cannot be.

    Raises:
        ValueError: Naming the value and the way out.
        OSError: If a scenario cannot be read.
    """
    checked = set[tuple[str, str]]()
    for step in session_steps(plan, 1):
        if not step.drives:
            continue
        scenario = scenario_beside(step.scenario, Path(name).parent)
        with _at(f"{name}: {step.id}"):
            trial = trial_of(plan, step, 1, scenario)
            check_setup(trial)
            if (step.method, step.scenario) not in checked:  # parameters are the same
                loop_parameters(trial)
        checked.add((step.method, step.scenario))


@contextmanager
def _at(where: str) -> Iterator[None]:
    """Say where in the file something is wrong.

    Raises:
        ValueError: As it is raised within, with the place before it.
    """
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
