"""Whether a participant should go on: stop rules of questionnaires, and who decides.

What a rule says is written with the answers that it is about. From then on no drive
begins until the experimenter has said that it may.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

from costeer.sessions.questionnaires.answers import Value
from costeer.sessions.questionnaires.instrument import Instrument
from costeer.sessions.questionnaires.scoring import scores_of, stop_reason
from costeer.sessions.session import Session
from costeer.sessions.standing import told_reason

UNWELL, GOES_ON = "unwell", "goes on"
"""Events: a rule speaks against going on; the experimenter decides otherwise."""


def unwell(
    session: Session,
    participant: str,
    step: str,
    instrument: Instrument,
    answers: Mapping[str, Value],
) -> str:
    """Why a participant who answers so should not go on; empty if nothing says so.

    Args:
        session: Of the study.
        participant: Who answers.
        step: That asks.
        instrument: That it asks.
        answers: Checked.

    Raises:
        StoreError: If earlier answers cannot be read.
    """
    if instrument.stop is None:
        return ""
    before = _before_driving(session, participant, step, instrument)
    baseline = scores_of(instrument, before) if before else None
    return stop_reason(instrument, scores_of(instrument, answers), baseline)


def _before_driving(
    session: Session, participant: str, step: str, instrument: Instrument
) -> dict[str, Value]:
    """Answers to the same questions before the first drive; empty without any."""
    for each in session.steps_of(participant):
        if each.drives or each.id == step:
            return {}
        if each.instrument == instrument.name:
            kept = session.answers_of(participant, each.id)
            return {item: json.loads(value) for item, value in kept.items()}
    return {}


def held(session: Session, participant: str) -> str:
    """Why a participant waits for the experimenter's word; empty who does not.

    Raises:
        StoreError: If it cannot be read.
    """
    told = session.store.rows(
        "SELECT kind, text FROM events WHERE participant = ? AND kind IN (?, ?) "
        "ORDER BY number DESC LIMIT 1",
        *(participant, UNWELL, GOES_ON),
    )
    return str(told[0]["text"]) if told and told[0]["kind"] == UNWELL else ""


def let_go_on(session: Session, participant: str, reason: str) -> None:
    """Keep that a participant goes on, whatever a rule says; for a reason.

    Raises:
        ValueError: If nothing holds the participant, or there is no reason.
        StoreError: If it cannot be written.
    """
    told = told_reason(reason)
    if not held(session, participant):
        raise ValueError(f"nothing keeps {participant} from going on")
    with session.store.transaction():
        step = session.standing(participant).step.id
        session.store.tell(GOES_ON, told, participant, step)
