"""Tables of manual driving: the targets, and what else was measured."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from costeer.pages.numerals import NOTHING, interval, number
from costeer.pages.tables import Table
from costeer.validation.manual import TargetCheck
from costeer.validation.overview import Quantity
from costeer.validation.reporting.verdicts import target_reason, target_verdict
from costeer.validation.reporting.words import short, span
from costeer.validation.spread import TargetSpread

_WRAP = 30


def targets_table(
    comparisons: Sequence[TargetCheck], spreads: Sequence[TargetSpread]
) -> Table:
    """Return every target: range, value, spreads, verdict, source.

    Args:
        comparisons: Of all targets.
        spreads: Of the same, in the same order.
    """
    pairs = zip(comparisons, spreads, strict=True)
    return Table(
        name="targets",
        title="Manual driving beside human ranges",
        note="Below the value its 95 % interval, drivers resampled. Between and "
        "within drivers: standard deviations by variance components, over the lane "
        "changes of each driver, or over two trials of each where a trial has one "
        "value; of a share one lane change counts 0 or 100 %. r: correlation of the "
        "drivers' values in two trials.",
        header=(
            "",
            "Quantity [unit]",
            "Human range",
            "Value",
            "Between",
            "Within",
            "r",
            "Verdict",
            "Source of the range",
        ),
        rows=tuple(_target_row(each, spread) for each, spread in pairs),
        num_labels=2,
        num_words=2,
    )


def _target_row(comparison: TargetCheck, spread: TargetSpread) -> tuple[str, ...]:
    target = comparison.target
    verdict = target_verdict(comparison)
    reason = target_reason(comparison, spread)
    return (
        target.name,
        wrapped(f"{target.quantity} [{target.unit}]", 28),
        span(target.low, target.high),
        f"{short(comparison.value)}\n{_interval(spread)}".rstrip(),
        short(spread.between),
        short(spread.within),
        number(spread.retest, 2),
        wrapped(f"{verdict}. {reason}" if reason else verdict),
        wrapped(target.source),
    )


def _interval(spread: TargetSpread) -> str:
    """The interval with as many decimals as the value."""
    text = short(spread.high)
    if text == NOTHING:
        return ""
    return interval(spread.low, spread.high, len(text.partition(".")[2]))


def wrapped(text: str, width: int = _WRAP) -> str:
    """Text in lines of a cell."""
    return "\n".join(textwrap.wrap(text, width, break_on_hyphens=False))


def overview_table(quantities: Sequence[Quantity]) -> Table:
    """Return what else the population did, held to no range."""
    return Table(
        name="overview",
        title="What else was measured in manual driving",
        note="Held to no range.",
        header=("Quantity", "Unit", "Value"),
        rows=tuple(
            (each.quantity, "–" if each.unit == "-" else each.unit, _told(each.value))
            for each in quantities
        ),
        num_labels=2,
    )


def _told(value: float) -> str:
    """Four digits; whole numbers as such."""
    whole = abs(value) >= 1000.0 or float(value).is_integer()
    return number(value, 0) if whole else short(value, 4)
