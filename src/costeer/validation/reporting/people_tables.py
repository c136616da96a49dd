"""Table of people beside virtual drivers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from costeer.pages.numerals import NOTHING, number
from costeer.pages.tables import Table
from costeer.validation.people.findings import (
    SHARE,
    RealComparison,
    Values,
    known,
    percentiles,
)
from costeer.validation.reporting.target_tables import wrapped
from costeer.validation.reporting.words import real_verdict_told, short, span


def people_table(comparisons: Sequence[RealComparison]) -> Table:
    """Return every quantity of people beside that of virtual drivers."""
    return Table(
        name="people",
        title="People beside virtual drivers",
        note="10 / 50 / 90 % of all values, or the share, and below how many values "
        "there are; published values where the recordings are absent. The range is "
        "held against the drivers' median, mean or share.",
        header=(
            "",
            "Quantity [unit], recordings",
            "People",
            "Virtual drivers",
            "Range",
            "Verdict",
            "What is behind it",
        ),
        rows=tuple(_row(each) for each in comparisons),
        num_labels=2,
        num_words=2,
    )


def _row(each: RealComparison) -> tuple[str, ...]:
    return (
        each.name,
        f"{wrapped(f'{each.quantity} [{each.unit}]', 32)}\n{wrapped(each.source, 32)}",
        _people(each),
        _told(each.drivers, each.statistic),
        span(each.low, each.high),
        real_verdict_told(each),
        wrapped(each.reason, 31),
    )


def _people(comparison: RealComparison) -> str:
    """Values of people, or what was published of them."""
    if known(comparison.people).size:
        return _told(comparison.people, comparison.statistic)
    low, middle, high = comparison.published
    if not math.isfinite(middle):
        return f"{NOTHING}\nrecordings absent"
    ends = math.isfinite(low) and math.isfinite(high)
    told = _three(low, middle, high) if ends else short(middle)
    return f"{told}\npublished"


def _told(values: Values, statistic: str) -> str:
    amount = known(values).size
    if not amount:
        return NOTHING
    if statistic == SHARE:
        return f"{number(float(known(values).mean()), 1)}\nof {amount}"
    if amount == 1:
        return short(float(known(values)[0]))
    return f"{_three(*percentiles(values))}\n{amount} values"


def _three(low: float, middle: float, high: float) -> str:
    return " / ".join(short(each) for each in (low, middle, high))
