"""What the plans say under which people drove: each version, and who drove under it."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from costeer.pages.numerals import listed, number
from costeer.scenarios.reading import Chosen, chosen
from costeer.sessions.plan import Plan, PlanStep, given_or_none, planned_trials
from costeer.sessions.scenarios import scenario_names
from costeer.sessions.session import Session
from costeer.study.people import natural

_ORDERS = {
    "williams": "the order of a Williams square (each condition follows each other "
    "equally often)",
    "given": "the same order for everybody",
    "random": "an order drawn for each participant",
}


class Driven(NamedTuple):
    """A version of the plan under which somebody drove.

    Attributes:
        version: Its number.
        plan: As it was.
        people: Pseudonyms.
    """

    version: int
    plan: Plan
    people: tuple[str, ...]


def versions_driven(session: Session, people: Collection[str]) -> list[Driven]:
    """Versions of the plan under which some people drove, in their order.

    Args:
        session: Of the study.
        people: Pseudonyms.
    """
    known: dict[int, list[str]] = {}
    for row in session.people():
        if row["participant"] in people:
            known.setdefault(int(row["plan"]), []).append(row["participant"])
    return [
        Driven(version, session.versions.plan(version), tuple(sorted(own, key=natural)))
        for version, own in sorted(known.items())
    ]


def plan_sentences(session: Session, driven: list[Driven]) -> list[str]:
    """What was planned; of each version by itself, where there were several."""
    told = {each.version: _described(session, each) for each in driven}
    if len(set(told.values())) <= 1:
        return [text for text in dict.fromkeys(told.values()) if text]
    many = f"{len(driven)} versions were driven."
    sentences = [f"The plan was changed on the way; {many}"]
    for each in driven:
        who = f"version {each.version} ({listed(list(each.people))})"
        sentences.append(f"Under {who}: {told[each.version]}")
    return sentences


def _described(session: Session, driven: Driven) -> str:
    """Trials, orders and courses of a version, in sentences."""
    plan = driven.plan
    labels = [trial.label for trial in planned_trials(plan).values()]
    if not labels:
        return ""
    parts = [f"The trials of each participant were {listed(labels)}."]
    blocks = [each for each in plan.steps if each.kind == "trials"]
    parts += [_block(each) for each in blocks]
    for name in scenario_names(plan):
        course = course_of(session, driven, name)
        edition = session.versions.scenario_hash(driven.version, name)
        which = f"{course.scenario.name} ({name}, {edition})" if edition else name
        parts.append(
            f"Trials on the scenario {which} were over "
            f"{number(course.length / 1000.0, 1)} km at a suggested "
            f"{number(course.speed * 3.6, 0)} km/h."
        )
    parts.append(f"Guidance: {plan.method}, lane changes started by {plan.intention}.")
    if plan.parameters:
        changed = [f"{name} {value:g}" for name, value in plan.parameters.items()]
        parts.append(f"Parameters: {listed(changed)}.")
    return " ".join(parts)


def _block(block: PlanStep) -> str:
    return (
        f"The {len(block.conditions)} conditions of the block came in "
        f"{_ORDERS[block.order]}."
    )


def course_of(session: Session, driven: Driven, name: str) -> Chosen:
    """Length and speed of the trials on a scenario, as a version has it."""
    plan = driven.plan
    scenario = session.versions.scenario(driven.version, name)
    return chosen(scenario, given_or_none(plan.length), given_or_none(plan.speed))
