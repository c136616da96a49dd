"""`targets.csv` and `real.csv`: the verdicts of the report as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from costeer.study.trial_tables import write_csv
from costeer.validation.manual import TargetCheck, missed_by, missed_share
from costeer.validation.people.findings import (
    RealComparison,
    known,
    people_value,
    percentiles,
    value,
)
from costeer.validation.people.findings import (
    missed_by as real_missed_by,
)
from costeer.validation.reporting.verdicts import target_reason
from costeer.validation.reporting.words import real_verdict
from costeer.validation.spread import TargetSpread

TARGETS_FILE = "targets.csv"
REAL_FILE = "real.csv"

Row = dict[str, object]


def write_targets(
    file: Path, comparisons: Sequence[TargetCheck], spreads: Sequence[TargetSpread]
) -> None:
    """Write a row per target, in the unit that the row names."""
    pairs = zip(comparisons, spreads, strict=True)
    write_csv(file, [_target_row(each, spread) for each, spread in pairs])


def _target_row(comparison: TargetCheck, spread: TargetSpread) -> Row:
    target = comparison.target
    known_value = math.isfinite(comparison.value)
    return {
        "name": target.name,
        "quantity": target.quantity,
        "unit": target.unit,
        "human_low": target.low,
        "human_high": target.high,
        "source": target.source,
        "value": comparison.value,
        "value_low_95": spread.low,
        "value_high_95": spread.high,
        "sd_between_drivers": spread.between,
        "sd_within_drivers": spread.within,
        "test_retest": spread.retest,
        "met": comparison.met,
        "missed_by": missed_by(comparison) if known_value else math.nan,
        "missed_share": missed_share(comparison) if known_value else math.nan,
        "reason": target_reason(comparison, spread),
    }


def write_real(file: Path, comparisons: Sequence[RealComparison]) -> None:
    """Write a row per quantity of people, in the unit that the row names."""
    write_csv(file, [_real_row(each) for each in comparisons], REAL_COLUMNS)


_ENDS = ("10", "50", "90")
REAL_COLUMNS = (
    "name",
    "quantity",
    "unit",
    "source",
    "statistic",
    "low",
    "high",
    "people_value",
    "drivers_value",
    "num_people",
    "num_drivers",
    *(f"{side}_{end}" for side in ("people", "drivers", "published") for end in _ENDS),
    "verdict",
    "missed_by",
    "reason",
)


def _real_row(each: RealComparison) -> Row:
    sides = {
        "people": percentiles(each.people),
        "drivers": percentiles(each.drivers),
        "published": each.published,
    }
    ends = {
        f"{side}_{end}": amount
        for side, amounts in sides.items()
        for end, amount in zip(_ENDS, amounts, strict=True)
    }
    row: Row = {
        **{name: getattr(each, name) for name in REAL_COLUMNS[:7]},
        "people_value": people_value(each),
        "drivers_value": value(each),
        "num_people": int(known(each.people).size),
        "num_drivers": int(known(each.drivers).size),
        **ends,
        "verdict": real_verdict(each),
        "missed_by": real_missed_by(each),
        "reason": each.reason,
    }
    return {name: row[name] for name in REAL_COLUMNS}
