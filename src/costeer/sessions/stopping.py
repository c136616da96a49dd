"""A participant who does not take part, or not any more: the participant's own word.

It is written at once and the console shows it; what happens to the data is the
experimenter's to do (`replace` or `withdraw`).
"""

from __future__ import annotations

from costeer.sessions.session import Session
from costeer.sessions.standing import (
    ACTIVE,
    DECLINED,
    ENDED,
    HOLDING,
    STOPPED,
    OutOfStepError,
)


def stop_taking_part(session: Session, participant: str, deletes: bool = False) -> None:
    """Keep that a participant does not take part, or not any more.

    Who does not consent gives the row of the square back: nothing was driven.

    Args:
        session: Of the study.
        participant: Who stops.
        deletes: Whether all that was kept shall be deleted.

    Raises:
        ValueError: If there is none.
        OutOfStepError: If the participant has ended otherwise.
        StoreError: If it cannot be written.
    """
    status = session.status_of(participant)
    if status in ENDED:
        return  # said twice
    if status != ACTIVE:
        raise OutOfStepError(f"participant {participant} has {status}")
    step = session.standing(participant).step
    word = DECLINED if step.kind == "consent" else STOPPED
    told = "does not consent" if word == DECLINED else "stops taking part"
    told += "; wants everything deleted" if deletes else ""
    with session.store.transaction():
        session.set_status(participant, word, told)
        session.store.tell(word, told, participant, step.id, {"delete": deletes})


def take_part_again(session: Session, participant: str) -> None:
    """Let a participant who had stopped go on.

    Raises:
        ValueError: If there is none.
        StoreError: If it cannot be written.
    """
    row = session.person(participant)
    if row["status"] not in ENDED:
        return
    held = {int(each["slot"]) for each in session.people() if each["status"] in HOLDING}
    is_given = row["status"] == DECLINED and int(row["slot"]) in held
    slot = session.free_slot() if is_given else int(row["slot"])
    with session.store.transaction():
        session.set_status(participant, ACTIVE, slot=slot)
        step = session.standing(participant).step.id
        session.store.tell("goes on", participant=participant, step=step)
