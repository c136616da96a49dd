"""Who drove what in a session: trials that count, in series, and why others do not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import read_record
from costeer.sessions.answered import Answered
from costeer.sessions.attempts import ABORTED, listed_attempts
from costeer.sessions.plan import Step, scenario_word
from costeer.sessions.planned import course_of, versions_driven
from costeer.sessions.said import sentences
from costeer.sessions.session import Session
from costeer.sessions.standing import DROPPED, WHOLE
from costeer.sessions.store import Row
from costeer.sessions.withdrawal import REPORTS, num_withdrawn
from costeer.study.people import (
    Drive,
    Exclusion,
    People,
    Series,
    in_order,
    people_study,
)
from costeer.study.quantities import WORKLOAD, WORKLOAD_ITEMS

# Any, in this file: cells, and what JSON holds.
PAPERS_ROAD = "expressway"
"""Scenario whose length tells how many lane changes are planned."""


def people_in(session: Session, answered: Sequence[Answered]) -> People:
    """Drives that count, and why others do not.

    Trials of the plan's scenario, each condition for the first time, are what the
    report is of; other series of trials stand apart.

    Raises:
        ValueError: If two drives claim the same cell.
        StoreError: If the store cannot be read.
    """
    drives: list[Drive] = []
    out: list[Exclusion] = []
    attempts = listed_attempts(session.store)
    for person in session.people():
        own = [
            each for each in attempts if each["participant"] == person["participant"]
        ]
        counted = _counted(session, person, own)
        drives += _drives(session, person, counted, answered)
        out += _exclusions(session, person, own)
        if person["status"] != DROPPED:
            out += _missing(session, person, counted, own)
    main, *others = _series(session, drives)
    found = _People(session, drives, out, answered, attempts)
    apart = {_word(each, main): found.of(each, main) for each in others}
    whole = found.of(main, main)
    log = tuple(each for each in out if each.series not in others)
    files = ", ".join(f"{REPORTS}/{name}/report.html" for name in apart)
    which = f"Other series of trials have reports of their own: {files}."
    return whole._replace(exclusions=log, apart=apart, which=which if apart else "")


def _series(session: Session, drives: Sequence[Drive]) -> list[Series]:
    """Series with a report of their own, the one of the plan's scenario first.

    A single condition that was driven again has none: it stands beside the first.
    """
    conditions: dict[Series, set[str]] = {}
    for each in drives:
        conditions.setdefault(each.series, set()).add(each.condition)
    usual = session.plan.scenario, 1
    names = sorted(conditions, key=lambda key: (key != usual, key[1], key[0]))
    if not names:
        return [usual]
    main, *others = names
    return [main, *(e for e in others if e[1] == 1 or len(conditions[e]) > 1)]


def _word(series: Series, main: Series) -> str:
    """Name of the folder of a series: what tells it from the main one."""
    scenario, occasion = series
    parts = [scenario_word(scenario)] if scenario != main[0] else []
    parts += [f"occasion-{occasion}"] if occasion > 1 else []
    return "-".join(parts) or scenario_word(scenario)


class _People:
    """Makes the people of one series after the other."""

    def __init__(
        self,
        session: Session,
        drives: Sequence[Drive],
        out: Sequence[Exclusion],
        answered: Sequence[Answered],
        attempts: Sequence[Row],
    ) -> None:
        self._session, self._drives, self._out = session, drives, out
        self._answered, self._attempts = answered, attempts

    def of(self, series: Series, main: Series) -> People:
        """Who drove a series.

        Raises:
            ValueError: If two drives claim the same cell.
        """
        session = self._session
        own = in_order(each for each in self._drives if each.series == series)
        later = [
            each
            for each in self._drives
            if series[1] == 1 and each.scenario == series[0] and each.occasion > 1
        ]
        analysed = {each.participant for each in own}
        answered = [a for a in self._answered if a.row["participant"] in analysed]
        folder = session.folder
        if series != main:
            folder = folder / REPORTS / _word(series, main)
        return People(
            study=people_study(folder, _configuration(session, series, own)),
            drives=own,
            exclusions=tuple(each for each in self._out if each.series == series),
            said=sentences(session, own, answered, self._attempts),
            num_withdrawn=num_withdrawn(session),
            again=in_order(later),
            which=_which(series, main),
        )


def _which(series: Series, main: Series) -> str:
    """Which of several series a report is of; empty for the main one."""
    if series == main:
        return ""
    which = f", occasion {series[1]}" if series[1] > 1 else ""
    return f"Only trials on the scenario {series[0]}{which}."


def _counted(session: Session, person: Row, own: Sequence[Row]) -> dict[str, Row]:
    """The attempt of each step that counts: the last whole one that nobody excluded."""
    if person["status"] == DROPPED:
        return {}
    return {
        each["step"]: each
        for each in sorted(own, key=lambda row: int(row["attempt"]))
        if each["kind"] == "drive"
        and each["state"] == WHOLE
        and not each["excluded"]
        and is_record(session.folder / each["record"])
    }


def is_record(file: Path) -> bool:
    """Whether a record is there and can be read."""
    try:
        read_record(file, ())
    except (ValueError, OSError):
        return False
    return True


def _drives(
    session: Session,
    person: Row,
    counted: Mapping[str, Row],
    answered: Sequence[Answered],
) -> Iterator[Drive]:
    who = person["participant"]
    by_step = {e.row["step"]: e for e in answered if e.row["participant"] == who}
    for step, asked in _trials(session.steps_of(who)):
        row = counted.get(step.id)
        if row is None:
            continue
        scores: dict[str, float] = {}
        items: dict[str, float] = {}
        for each in (by_step[name] for name in asked if name in by_step):
            if not each.scores.keys() & {score.name for score in WORKLOAD}:
                continue
            scores |= each.scores
            wanted = [item.name for item in WORKLOAD_ITEMS if item.name in each.values]
            items |= {name: float(each.values[name]) for name in wanted}
        record = session.folder / row["record"]
        yield Drive(
            who,
            step.condition,
            record,
            step.order,
            scores,
            items,
            *(step.label, step.scenario, step.occasion),
        )


def _trials(steps: Sequence[Step]) -> list[tuple[Step, list[str]]]:
    """Each trial, and the questionnaires between it and the next drive."""
    found: list[tuple[Step, list[str]]] = []
    follows = False
    for step in steps:
        if step.drives:
            follows = step.kind == "drive"
            found += [(step, [])] if follows else []
        elif step.kind == "ask" and follows:
            found[-1][1].append(step.id)
    return found


def _exclusions(
    session: Session, person: Row, own: Sequence[Row]
) -> Iterator[Exclusion]:
    """Trials that were driven and do not count."""
    steps = {each.id: each for each in session.steps_of(person["participant"])}
    for each in own:
        if each["kind"] != "drive":
            continue
        state = "aborted" if each["state"] == ABORTED else ""
        reason = each["reason"]
        if each["excluded"]:
            state = "excluded"
        elif person["status"] == DROPPED and not state:
            state, reason = "dropped out", person["reason"]
        if state:
            step = steps[each["step"]]
            yield Exclusion(
                each["participant"],
                each["step"],
                each["condition"],
                str(each["attempt"]),
                state,
                reason,
                each["started"],
                *(step.label, step.scenario, step.occasion),
            )


def _missing(
    session: Session, person: Row, counted: Mapping[str, Row], own: Sequence[Row]
) -> Iterator[Exclusion]:
    """Trials of the plan of which no attempt counts."""
    who = person["participant"]
    over = session.over(who)
    for step, _ in _trials(session.steps_of(who)):
        if step.id in counted:
            continue
        state, reason = "missing", "not driven yet"
        done = over.get(step.id)
        if done is not None and done["state"] == "skipped":
            state, reason = "skipped", done["reason"]
        elif any(e["step"] == step.id and e["excluded"] for e in own):
            reason = "every attempt is excluded"
        elif any(e["step"] == step.id and e["state"] == WHOLE for e in own):
            reason = "its record is not there, or cannot be read"
        elif any(e["step"] == step.id for e in own):
            reason = "no attempt came to its end yet"
        which = step.label, step.scenario, step.occasion
        yield Exclusion(who, step.id, step.condition, "", state, reason, "", *which)


def _configuration(
    session: Session, series: Series, drives: Sequence[Drive]
) -> dict[str, Any]:
    """What the report says of settings, where all plans agree that were driven."""
    names = {
        step.condition
        for row in session.people()
        for step in session.steps_of(row["participant"])
        if step.kind == "drive" and (step.scenario, step.occasion) == series
    }
    driven = versions_driven(session, {each.participant for each in drives})
    told: dict[str, Any] = {
        "title": session.plan.title,
        "participants": session.plan.participants,
        "conditions": [name for name in CONDITION_NAMES if name in names],
        "scenario": series[0],
        "plan_versions": [each.version for each in driven],
        "intention_model_hash": _model(drives),
    }
    courses = [course_of(session, each, series[0]) for each in driven]
    is_papers = all(each.scenario.name == PAPERS_ROAD for each in courses)
    plans = [each.plan for each in driven]
    values: dict[str, list[Any]] = {
        "seed": [plan.seed for plan in plans],
        "method": [plan.method for plan in plans],
        "intention": [plan.intention for plan in plans],
        "length": [course.length for course in courses] if is_papers else [],
        "speed": [course.speed for course in courses],
        "car": [plan.car for plan in plans],
        "parameters": [dict(plan.parameters) for plan in plans],
    }
    agreed = {
        name: found[0]
        for name, found in values.items()
        if found and all(each == found[0] for each in found)
    }
    return told | agreed


def _model(drives: Sequence[Drive]) -> str | None:
    """The network that all drives had; None if they had several, or none."""
    models = {
        str(read_record(each.record, ()).metadata.get("intention_model_hash") or "")
        for each in drives
    } - {""}
    return models.pop() if len(models) == 1 else None
