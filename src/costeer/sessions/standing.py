"""Words of a session: how it stands with people and drives, and what is refused."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from costeer.sessions.plan import Step
from costeer.sessions.questionnaires.answers import cleaned
from costeer.sessions.store import Row

PSEUDONYM = re.compile(r"[A-Za-z]{0,4}[0-9]{1,4}")
"""A few letters and a number: nobody is called so."""

ACTIVE, FINISHED, DROPPED = "active", "finished", "dropped"
STOPPED, DECLINED = "stopped", "declined"
"""How it stands with a participant: the last two are the participant's own word."""

HOLDING = (ACTIVE, FINISHED, STOPPED)
"""Who holds a row of the balanced order."""

ENDED = (STOPPED, DECLINED)
"""Who takes no part any more, and may think better of it."""

WHOLE = "finished"
"""An attempt at a drive that came to its end."""


class OutOfStepError(ValueError):
    """What was asked is for another step than the one that is on."""


class Standing(NamedTuple):
    """Where a participant stands.

    Attributes:
        participant: Pseudonym.
        step: That is on.
        number: Of the step, from 1.
        of: Steps without the last.
        attempts: Of the step.
    """

    participant: str
    step: Step
    number: int
    of: int
    attempts: tuple[Row, ...]


def told_reason(reason: str) -> str:
    """A reason, if it is one.

    Raises:
        ValueError: If it is empty.
    """
    told = " ".join(cleaned(reason).split())
    if not told:
        raise ValueError("give a reason; it stands in the log of exclusions")
    return told[:500]


def known_person(participant: str, people: Sequence[Row]) -> Row | None:
    """The row of who bears a pseudonym; None if it is free.

    Raises:
        ValueError: If it is no pseudonym, differs from another's by small and capital
            letters alone, or who bears it has ended.
    """
    if not PSEUDONYM.fullmatch(participant):
        raise ValueError(
            f"participant is {participant[:40]!r}; give a pseudonym: up to four "
            "letters and a number, as P01. Names do not belong here"
        )
    alike = [row for row in people if row["participant"].lower() == participant.lower()]
    if not alike:
        return None
    known = alike[0]
    if known["participant"] != participant:  # some file systems take them for the same
        raise ValueError(
            f"participant is {participant!r}, and there is {known['participant']!r}; "
            "give that one, or another number"
        )
    if known["status"] == DROPPED:
        raise ValueError(
            f"participant {participant} has dropped out; give another pseudonym"
        )
    return known
