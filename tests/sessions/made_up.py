"""A study with people whose drives are made up: quick, and every number known."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import write_record
from costeer.sessions.attempts import Attempts
from costeer.sessions.plan import Step
from costeer.sessions.questionnaires.definition import load_definition
from costeer.sessions.session import Session
from costeer.sessions.store import Row
from costeer.study.quantities import WORKLOAD_ITEMS
from tests.study.synthetic import synthetic_record

LENGTH = 1800.0
"""Of the course [m]: one overtaking event with its two lane changes."""

PLAN = """
title: Made up
participants: {people}
length: {length}
steps:
  - {{kind: consent, instrument: consent}}
  - {{kind: ask, instrument: demographics}}
  - {{kind: practise, condition: manual, minutes: 1, longest_minutes: 2}}
  - {{kind: drive, condition: manual}}
  - {{kind: ask, instrument: nasa-tlx}}
  - kind: trials
    conditions: [{conditions}]
    after: [{{kind: ask, instrument: nasa-tlx}}]
"""

FACTS = {
    "costeer": "0.1.0",
    "git_revision": "abc",
    "input": "wheel",
    "wheel": "Simucube 2",
    "wheel_calibration": {"inertia": 0.05},
    "head": None,
    "checks": [{"name": "Free space", "well": True, "told": "", "utc": ""}],
    "frame_rate": 58,
}


def rows_of(session: Session, participant: str) -> list[Row]:
    """Rows of every table of the store that names this participant."""
    tables = session.store.rows(
        "SELECT tables.name FROM sqlite_master AS tables "
        "JOIN pragma_table_info(tables.name) AS columns "
        "ON columns.name = 'participant' WHERE tables.type = 'table'"
    )
    assert len(tables) > 3
    query = "SELECT * FROM {} WHERE participant = ?"
    return [
        row
        for table in tables
        for row in session.store.rows(query.format(table["name"]), participant)
    ]


def made_up_session(
    folder: Path, people: Sequence[str], conditions: Sequence[str] = CONDITION_NAMES
) -> Session:
    """A session in which everybody has done everything; still open.

    Args:
        folder: To make.
        people: Pseudonyms.
        conditions: Driven, manual first.
    """
    plan = PLAN.format(
        people=max(len(people), 1), length=LENGTH, conditions=", ".join(conditions[1:])
    )
    return planned_session(folder, people, plan)


def planned_session(folder: Path, people: Sequence[str], plan: str) -> Session:
    """A session in which some people have done everything of a plan; still open."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "plan.yaml").write_text(plan)
    session = Session(folder)
    for who in people:
        session.begin(who)
        while (step := session.standing(who).step).kind != "done":
            do(session, who, step)
    return session


def do(session: Session, who: str, step: Step) -> None:
    """What a step asks for."""
    if step.drives:
        drive(session, who, step)
    elif step.kind in ("ask", "consent"):
        name = step.instrument
        given = answers(session, who, step)
        session.answer(who, step.id, given, (name, load_definition(name).version))
    else:
        session.finish(who, step.id)


def drive(session: Session, who: str, step: Step) -> Path:
    """A drive to its end, with its record."""
    attempts = Attempts(session)
    number, path = attempts.start(who, step.id, FACTS)
    slot = int(next(r["slot"] for r in session.people() if r["participant"] == who))
    other = 7 * max(step.occasion - 1, 0)  # nobody drives twice the same
    record = synthetic_record(step.condition, slot + other, length=LENGTH)
    about = {
        "participant": who,
        "driver": "person, Simucube 2",
        "driver_kind": "person",
        "driver_torque_source": "observed",
        "started_at": "2026-01-31T09:30:00+00:00",
        "ended_at": "2026-01-31T09:35:00+00:00",
        "markers": [
            {"kind": "paused", "name": "driver", "time": 10.0},
            {"kind": "resumed", "after": 4.5, "unit": "s", "time": 10.0},
            {"kind": "paused", "name": "experimenter", "time": 20.0},
            {"kind": "resumed", "after": 2.0, "unit": "s", "time": 20.0},
        ],
    }
    write_record(path, record._replace(metadata={**record.metadata, **about}))
    attempts.end(who, step.id, number, {"duration": 300.0})
    return path


def answers(session: Session, who: str, step: Step) -> dict[str, object]:
    """Answers that follow from participant and step."""
    if step.instrument == "consent":
        return {"informed": "yes", "voluntary": "yes", "recording": "yes"}
    if step.instrument == "demographics":
        return {"age": 20.0 + len(session.people()), "gender": "woman"}
    return workload(who, step.condition)


def workload(who: str, condition: str) -> dict[str, object]:
    """Answers to the NASA-TLX; in every comparison the first of the two wins."""
    rng = np.random.default_rng([CONDITION_NAMES.index(condition), *who.encode()])
    level = 60.0 if condition == "manual" else 35.0
    ratings = {
        item.name: float(5 * round((level + rng.normal(0.0, 12.0)) / 5.0))
        for item in WORKLOAD_ITEMS
    }
    names = list(ratings)
    wins = {
        f"{first}_or_{second}": first
        for place, first in enumerate(names)
        for second in names[place + 1 :]
    }
    return {**ratings, **wins}
