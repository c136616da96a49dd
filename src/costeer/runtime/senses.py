"""What head tracker and network said last, if it was lately enough."""

from __future__ import annotations

import math

from costeer.devices.head.source import STALE_AFTER
from costeer.runtime.patience import VERDICT_PATIENCE
from costeer.runtime.shared import Mailbox


def sees_head(mailbox: Mailbox, now: float) -> bool:
    """Whether the head was seen lately, at a time of the drive's clock [s]."""
    age = now - mailbox.get("head_time")
    return mailbox.get("head_valid") > 0.5 and age <= STALE_AFTER


def newest_verdict(mailbox: Mailbox, frames: int) -> float:
    """The network's newest verdict, NaN if it is too old [-].

    Args:
        mailbox: Where it is put.
        frames: Written until now.
    """
    if frames - mailbox.get("verdict_row") > VERDICT_PATIENCE:
        return math.nan
    return mailbox.get("crossing_probability")
