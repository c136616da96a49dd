"""How long each part of a drive waits for another before it acts."""

from __future__ import annotations

from costeer.devices.head.source import STALE_AFTER
from costeer.loop.tick import NO_VERDICT, Verdict
from costeer.runtime.shared import Mailbox

PAGE_PATIENCE = 1.0
"""A drive pauses when no page has said a word for so long [s]."""

SERVER_PATIENCE = 5.0
"""The process ends when the server has shown no life for so long [s]."""

WHEEL_PATIENCE = 0.05
"""A reading older than this is stale [s]; with the guard's fall it ends by 100 ms."""

VERDICT_PATIENCE = 6
"""Frames after which the network's last verdict no longer counts [-]."""

WATCHDOG_PATIENCE = 0.3
"""A watchdog that has not looked for so long watches nobody [s]."""

STOP_PATIENCE = 0.4
"""The torque has faded out by then; the process ends anyhow [s]."""


def sees_head(mailbox: Mailbox, now: float) -> bool:
    """Whether the head was seen lately; `now` of the clock that all share [s]."""
    age = now - mailbox.get("head_time")
    return mailbox.get("head_valid") > 0.5 and age <= STALE_AFTER


def newest_verdict(mailbox: Mailbox, written: int) -> Verdict:
    """The newest verdict, none if it is too many of the `written` rows old."""
    if written - mailbox.get("verdict_row") > VERDICT_PATIENCE:
        return NO_VERDICT
    return Verdict(mailbox.get("crossing_probability"), mailbox.get("crossing_side"))
