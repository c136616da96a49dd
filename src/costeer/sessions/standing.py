"""Words of a session: how it stands with people and drives, and what is refused."""

from __future__ import annotations

import re
from typing import NamedTuple

from costeer.sessions.plan import Step
from costeer.sessions.store import Row

PSEUDONYM = re.compile(r"[A-Za-z]{0,4}[0-9]{1,4}")
"""A few letters and a number: nobody is called so."""

ACTIVE, FINISHED, WITHDRAWN, DROPPED = "active", "finished", "withdrawn", "dropped"
"""How it stands with a participant."""

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
    told = " ".join(reason.split())
    if not told:
        raise ValueError("give a reason; it stands in the log of exclusions")
    return told[:500]
