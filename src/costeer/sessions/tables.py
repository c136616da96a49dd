"""The tables of a session: participants, answers, scores, events, drives, trials."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from costeer.sessions.answered import answer_rows, answers_in, score_rows
from costeer.sessions.attempts import listed_attempts
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
from costeer.sessions.people import people_in
from costeer.sessions.session import Session
from costeer.study.people import (
    People,
    write_exclusions,
    write_people_tables,
)
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
    hashes = session.versions.hashes()
    ends = {
        row["participant"]: row["utc"]
        for row in session.store.rows("SELECT * FROM events WHERE kind = 'finished'")
    }
    counted = [each.participant for each in people.all_drives]
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
    steps = {who: {s.id: s for s in session.steps_of(who)} for who in slots}
    facts = ("costeer", "git_revision", "input", "wheel", "head", "frame_rate")
    rows = []
    for each in listed_attempts(session.store):
        known = each["facts"]
        trace = each["record"].removesuffix(".parquet") + ".wheel.parquet"
        there = bool(each["record"]) and (session.folder / trace).is_file()
        rows.append(
            {
                **each,
                **{name: known.get(name) for name in facts},
                "label": steps[each["participant"]][each["step"]].label,
                "scenario": steps[each["participant"]][each["step"]].scenario,
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
