"""The tables of a session: participants, answers, scores, events, drives, trials."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import read_record
from costeer.sessions.answered import Answered, answer_rows, answers_in, score_rows
from costeer.sessions.attempts import ABORTED, listed_attempts
from costeer.sessions.codebook import write_codebook
from costeer.sessions.fields import (
    ATTEMPTS_FILE,
    EVENTS_FILE,
    FIELDS,
    PARTICIPANTS_FILE,
    QUESTIONNAIRES_FILE,
    SCORES_FILE,
)
from costeer.sessions.log import event_rows
from costeer.sessions.plan import Step
from costeer.sessions.said import sentences
from costeer.sessions.session import Session
from costeer.sessions.standing import DROPPED, WHOLE
from costeer.sessions.store import Row
from costeer.sessions.withdrawal import num_withdrawn
from costeer.study.people import (
    Drive,
    Exclusion,
    People,
    in_order,
    people_study,
    write_exclusions,
    write_people_tables,
)
from costeer.study.quantities import WORKLOAD, WORKLOAD_ITEMS
from costeer.study.trial_tables import write_csv

# Any, in this file: cells, and what JSON holds.
Cells = dict[str, Any]


def write_session(folder: Path, out: Path) -> People:
    """Write all tables of a session but those of the trials' measures.

    Args:
        folder: Of the session.
        out: To write in; made if it is not there.

    Returns:
        Who drove, for `write_people_tables` and the report.

    Raises:
        ValueError: If it is no session, or two drives claim the same cell.
        OSError: If a file cannot be read or written.
    """
    session = Session(folder)
    out.mkdir(parents=True, exist_ok=True)
    try:
        answered = answers_in(session)
        people = people_in(session, answered)
        write_table(out, PARTICIPANTS_FILE, participant_rows(session, people))
        write_table(out, QUESTIONNAIRES_FILE, answer_rows(answered))
        write_table(out, SCORES_FILE, score_rows(answered))
        write_table(out, EVENTS_FILE, event_rows(session))
        write_table(out, ATTEMPTS_FILE, attempt_rows(session))
        write_codebook(out, session)
    finally:
        session.close()
    return people


def write_all(folder: Path, out: Path) -> People:
    """Write every table of a session; without a trial those of trials are missing."""
    people = write_session(folder, out)
    if people.drives:
        write_people_tables(out, people)
    else:
        write_exclusions(out, people.exclusions)
    return people


def write_table(out: Path, file: str, rows: Sequence[Cells]) -> None:
    """Write a table in the columns that are declared for it."""
    names = [each.column for each in FIELDS[file]]
    write_csv(out / file, [{name: row[name] for name in names} for row in rows], names)


def participant_rows(session: Session, people: People) -> list[Cells]:
    """Rows of `participants.csv`."""
    hashes = {
        row["version"]: row["hash"]
        for row in session.store.rows("SELECT version, hash FROM plans")
    }
    ends = {
        row["participant"]: row["utc"]
        for row in session.store.rows("SELECT * FROM events WHERE kind = 'finished'")
    }
    counted = [each.participant for each in people.drives]
    return [
        {
            **row,
            "plan_version": row["plan"],
            "plan_hash": hashes.get(row["plan"], ""),
            "began_at": row["utc"],
            "finished_at": ends.get(row["participant"], ""),
            "num_steps": len(session.steps_of(row["participant"])) - 1,
            "num_steps_over": len(session.over(row["participant"])),
            "num_trials": counted.count(row["participant"]),
        }
        for row in session.people()
    ]


def attempt_rows(session: Session) -> list[Cells]:
    """Rows of `attempts.csv`, practice and aborted ones among them."""
    slots = {row["participant"]: row["slot"] for row in session.people()}
    facts = ("costeer", "git_revision", "input", "wheel", "head")
    rows = []
    for each in listed_attempts(session.store):
        known = each["facts"]
        trace = each["record"].removesuffix(".parquet") + ".wheel.parquet"
        there = bool(each["record"]) and (session.folder / trace).is_file()
        rows.append(
            {
                **each,
                **{name: known.get(name) for name in facts},
                "slot": slots[each["participant"]],
                "excluded": bool(each["excluded"]),
                "wheel_trace": trace if there else "",
                "started_at": each["started"],
                "ended_at": each["ended"],
                "wheel_calibration": _json(known.get("wheel_calibration")),
                "checks": _json(known.get("checks")),
                "latency": "; ".join(map(str, known.get("latency") or ())),
            }
        )
    return rows


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, sort_keys=True) if value else ""


def people_in(session: Session, answered: Sequence[Answered]) -> People:
    """Drives that count, and why others do not.

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
        out += _exclusions(person, own)
        if person["status"] != DROPPED:
            out += _missing(session, person, counted, own)
    ordered = in_order(drives)
    analysed = [
        each
        for each in answered
        if any(each.row["participant"] == drive.participant for drive in ordered)
    ]
    return People(
        study=people_study(session.folder, _configuration(session, ordered)),
        drives=ordered,
        exclusions=tuple(out),
        said=sentences(session, ordered, analysed, attempts),
        num_withdrawn=num_withdrawn(session),
    )


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
        yield Drive(who, step.condition, record, step.order, scores, items)


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


def _exclusions(person: Row, own: Sequence[Row]) -> Iterator[Exclusion]:
    """Trials that were driven and do not count."""
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
            yield Exclusion(
                each["participant"],
                each["step"],
                each["condition"],
                str(each["attempt"]),
                state,
                reason,
                each["started"],
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
        yield Exclusion(who, step.id, step.condition, "", state, reason)


def _configuration(session: Session, drives: Sequence[Drive]) -> Cells:
    """What the report says of settings; the plan that new participants get."""
    plan = session.plan
    steps = [
        each
        for row in session.people()
        for each in session.steps_of(row["participant"])
    ]
    names = {each.condition for each in steps if each.kind == "drive"}
    names |= {each.condition for each in drives}
    models = {
        str(read_record(each.record, ()).metadata.get("intention_model_hash") or "")
        for each in drives
    } - {""}
    return {
        "title": plan.title,
        "participants": plan.participants,
        "conditions": [name for name in CONDITION_NAMES if name in names],
        "seed": plan.seed,
        "method": plan.method,
        "intention": plan.intention,
        "length": plan.length,
        "speed": plan.speed_kmh / 3.6,
        "car": plan.car,
        "parameters": dict(plan.parameters),
        "plan_version": session.plan_version,
        "intention_model_hash": models.pop() if len(models) == 1 else None,
    }
