"""Each level of a factor against manual driving, under both analyses."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.methods.conditions import MANUAL
from costeer.study.material import (
    StudyMaterial,
    conditions_driven,
    pair,
    strengths_driven,
)
from costeer.study.outcome import PUBLISHED, WITHIN, PairRow
from costeer.study.quantities import BY_STRENGTH, QUANTITIES, WORKLOAD, Quantity


class AgainstManual(NamedTuple):
    """One level of a factor against manual driving.

    Attributes:
        level: A condition or strength.
        difference: From manual, in shown units; NaN if it is not known.
        within: -1 significantly lower, +1 higher, 0 neither, None not tested.
        pooled: The same in the analysis as published.
    """

    level: str
    difference: float
    within: int | None
    pooled: int | None


def shown_quantities(material: StudyMaterial) -> tuple[Quantity, ...]:
    """Return the measures that were tested, workload only where there is some."""
    tested = {row.measure for row in material.tests.summaries}
    return tuple(each for each in (*QUANTITIES, *WORKLOAD) if each.name in tested)


def compared_levels(material: StudyMaterial, quantity: Quantity) -> tuple[str, ...]:
    """Return what is compared with manual: strengths, or conditions."""
    driven = strengths_driven if quantity.name in BY_STRENGTH else conditions_driven
    return tuple(name for name in driven(material) if name != MANUAL)


def comparisons(material: StudyMaterial, quantity: Quantity) -> list[AgainstManual]:
    """Return each level against manual driving under both analyses."""
    found = []
    for level in compared_levels(material, quantity):
        rows = [
            pair(material, quantity.name, analysis, level, MANUAL)
            for analysis in (WITHIN, PUBLISHED)
        ]
        differences = [row.mean_difference for row in rows if row is not None]
        known = [each for each in differences if math.isfinite(each)]
        found.append(
            AgainstManual(
                level=level,
                difference=known[0] * quantity.factor if known else math.nan,
                within=_direction(rows[0]),
                pooled=_direction(rows[1]),
            )
        )
    return found


def _direction(row: PairRow | None) -> int | None:
    """Direction of a significant difference; 0 if it is not significant."""
    if row is None or not math.isfinite(row.p_corrected):
        return None
    if not row.mark:
        return 0
    return 1 if row.mean_difference > 0.0 else -1
