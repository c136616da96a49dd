"""Answers of a session with their scores, in long form."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from costeer.sessions.questionnaires.definition import load_definition
from costeer.sessions.questionnaires.scoring import scores_of
from costeer.sessions.session import Session
from costeer.sessions.store import Row

# Any, in this file: cells, and what JSON holds.
Cells = dict[str, Any]


class Answered(NamedTuple):
    """A questionnaire that somebody has answered.

    Attributes:
        row: Participant, slot, condition and label of the trial before, step,
            instrument, version, answered_at.
        values: By item.
        scores: By name; NaN where they cannot be told.
    """

    row: Cells
    values: dict[str, Any]
    scores: dict[str, float]


def answers_in(session: Session) -> list[Answered]:
    """Questionnaires that were answered, in the order of people and time."""
    slots = {row["participant"]: row["slot"] for row in session.people()}
    rows = session.store.rows("SELECT * FROM answers ORDER BY participant, rowid")
    steps: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        steps.setdefault((row["participant"], row["step"]), []).append(row)
    labels = {(w, s.id): s.label for w in slots for s in session.steps_of(w)}
    return [_answered(session.folder, own, slots, labels) for own in steps.values()]


def _answered(
    folder: Path,
    rows: list[Row],
    slots: Mapping[str, int],
    labels: Mapping[tuple[str, str], str],
) -> Answered:
    first = rows[0]
    values = {row["item"]: json.loads(row["value"]) for row in rows}
    names = ("participant", "condition", "step", "instrument", "version", "language")
    about: Cells = {name: first[name] for name in names}
    about |= {
        "label": labels.get((first["participant"], first["step"]), ""),
        "slot": slots[first["participant"]],
        "answered_at": first["utc"],
        "monotonic": first["monotonic"],
    }
    return Answered(about, values, _scores(folder, first, values))


def _scores(folder: Path, row: Row, values: Mapping[str, Any]) -> dict[str, float]:
    """Scores of an instrument; NaN if it is another version now, none if it is gone."""
    try:
        definition = load_definition(row["instrument"], folder)
    except ValueError:
        return {}
    if definition.version != row["version"]:
        return dict.fromkeys((each.name for each in definition.scores), math.nan)
    return scores_of(definition, values)


def answer_rows(answered: Sequence[Answered]) -> list[Cells]:
    """Rows of `questionnaires.csv`, items in the order in which they are asked."""
    return [
        {**each.row, "item": item, "value": value}
        for each in answered
        for item, value in each.values.items()
    ]


def score_rows(answered: Sequence[Answered]) -> list[Cells]:
    """Rows of `scores.csv`."""
    return [
        {**each.row, "score": name, "value": value}
        for each in answered
        for name, value in each.scores.items()
    ]
