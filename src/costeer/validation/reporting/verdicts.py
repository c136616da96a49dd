"""What is said of a target: met, or missed by how much, and why."""

from __future__ import annotations

import math
from collections.abc import Sequence

from costeer.base.array import Real
from costeer.validation.manual import TargetCheck, missed_by, missed_share
from costeer.validation.reporting.words import MET, NOT_KNOWN, short
from costeer.validation.spread import TargetSpread


def target_verdict(comparison: TargetCheck) -> str:
    """Return met, missed by how much, or no value."""
    if comparison.met:
        return MET
    if not math.isfinite(comparison.value):
        return NOT_KNOWN
    amount, share = missed_by(comparison), missed_share(comparison)
    unit = comparison.target.unit
    return f"missed by {short(amount, 2)} {unit} ({short(100.0 * share, 2)} %)"


def target_reason(comparison: TargetCheck, spread: TargetSpread) -> str:
    """Why a target is missed, as a sentence; empty if it is met.

    Args:
        comparison: The target and its value.
        spread: Of the same target.
    """
    target = comparison.target
    if comparison.met:
        return ""
    if not math.isfinite(comparison.value):
        return "Too few drivers or lane changes for a value."
    moved = f"It is set by {target.set_by}."
    if spread.low <= target.high and spread.high >= target.low:
        return f"The interval reaches the range: these drivers may be chance. {moved}"
    return moved


def largest_miss(comparisons: Sequence[TargetCheck]) -> TargetCheck | None:
    """The target that is missed by the largest share of its limit; None if none is."""
    missed = [c for c in comparisons if not c.met and math.isfinite(c.value)]
    return max(missed, key=missed_share, default=None)


def num_met(comparisons: Sequence[TargetCheck]) -> int:
    """How many targets are met."""
    return sum(comparison.met for comparison in comparisons)


def largest_share(comparisons: Sequence[TargetCheck]) -> Real:
    """The largest miss as a share of its limit [-]; 0 if all are met."""
    worst = largest_miss(comparisons)
    return missed_share(worst) if worst is not None else 0.0
