"""What came out, in sentences made from the tests by fixed rules.

Nothing is said that a row of `pairs.csv` or `tests.csv` does not say: which levels
differ significantly from manual driving, under which of the two analyses, in which
direction and by how much.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.study.conditions import MANUAL
from costeer.study.material import (
    StudyMaterial,
    conditions_driven,
    pair,
    strengths_driven,
    summary,
)
from costeer.study.outcome import PUBLISHED, WITHIN, PairRow
from costeer.study.quantities import BY_STRENGTH, QUANTITIES, WORKLOAD, Quantity
from costeer.study.reporting.numerals import listed, number, signed

_MOST_LISTED = 3
_NUMBERS = ("no", "one", "two", "three", "four", "five", "six")

MEANINGS: dict[str, tuple[str, str]] = {
    "sdlp": ("kept their lane more closely", "wandered more in their lane"),
    "swrr": ("reversed the wheel less often", "reversed the wheel more often"),
    "driver_torque_rms": (
        "put less torque on the wheel",
        "put more torque on the wheel",
    ),
    "overshoot": ("overshot the new lane less", "overshot the new lane more"),
    "steering_velocity_rms": (
        "turned the wheel more slowly in lane changes",
        "turned the wheel faster in lane changes",
    ),
    "peak_steering_angle": (
        "changed lanes with smaller steering angles",
        "changed lanes with larger steering angles",
    ),
    "duration": ("took less time to change lanes", "took more time to change lanes"),
    "tlx_raw": ("reported less workload (raw)", "reported more workload (raw)"),
    "tlx_weighted": (
        "reported less workload (weighted)",
        "reported more workload (weighted)",
    ),
}
"""What a lower and a higher value of each measure is in words."""


class Comparison(NamedTuple):
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


def comparisons(material: StudyMaterial, quantity: Quantity) -> list[Comparison]:
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
            Comparison(
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


def measure_sentences(material: StudyMaterial, quantity: Quantity) -> str:
    """Say what came out for one measure."""
    found = comparisons(material, quantity)
    sentences = [_manual_sentence(material, quantity)]
    kinds = dict.fromkeys((each.within, each.pooled) for each in found)
    for kind in sorted(kinds, key=_most_certain_first):
        levels = [each for each in found if (each.within, each.pooled) == kind]
        sentences.append(_group_sentence(quantity, kind, levels, len(found)))
    sentences.append(_factor_sentence(material, quantity))
    return " ".join(each for each in sentences if each)


def _manual_sentence(material: StudyMaterial, quantity: Quantity) -> str:
    row = summary(material, quantity.name, "condition", MANUAL)
    if row is None or not math.isfinite(row.mean):
        return "There is no manual driving to compare with."
    mean = number(row.mean * quantity.factor, quantity.digits)
    return f"{mean} {quantity.unit} in manual driving."


def _most_certain_first(kind: tuple[int | None, int | None]) -> tuple[int, int]:
    within, pooled = kind
    doubts = (within is None) + (pooled is None)
    return 3 * doubts - abs(within or 0) - abs(pooled or 0), -abs(within or 0)


def _group_sentence(
    quantity: Quantity,
    kind: tuple[int | None, int | None],
    levels: list[Comparison],
    num_levels: int,
) -> str:
    within, pooled = kind
    where = _levels_text(quantity, levels, num_levels)
    if within is None and pooled is None:
        return f"Not tested {where}."
    if not within and not pooled:
        return f"No significant difference {where}."
    if within and pooled and within != pooled:
        return f"The two analyses contradict each other {where}."
    word = quantity.more if (within or pooled) == 1 else quantity.less
    analysis = (
        "by both analyses"
        if within and pooled
        else "within subjects only"
        if within
        else "in the pooled analysis only"
    )
    return f"{word.capitalize()} {where}, {analysis}."


def _levels_text(quantity: Quantity, levels: list[Comparison], num_levels: int) -> str:
    """Name the levels and their differences from manual."""
    names = [each.level for each in levels]
    by_strength = quantity.name in BY_STRENGTH
    kind = "guidance" if by_strength else ""
    if len(levels) <= _MOST_LISTED:
        shown = [f"{each.level}{_difference(quantity, each)}" for each in levels]
        return f"with {listed(shown)} {kind}".rstrip()
    everyone = f"in all {_NUMBERS[num_levels]} assisted conditions"
    where = everyone if len(levels) == num_levels else f"with {listed(names)}"
    known = [each.difference for each in levels if math.isfinite(each.difference)]
    if not known:
        return where
    low, high = (signed(f(known), quantity.digits) for f in (min, max))
    return f"{where} ({low} to {high} {quantity.unit})"


def _difference(quantity: Quantity, comparison: Comparison) -> str:
    if not math.isfinite(comparison.difference):
        return ""
    return f" ({signed(comparison.difference, quantity.digits)} {quantity.unit})"


def _factor_sentence(material: StudyMaterial, quantity: Quantity) -> str:
    """Say which factors matter among the assisted conditions."""
    names = {
        "strength": "strength",
        "change_duration": "planned duration",
        "strength:change_duration": "their interaction",
    }
    rows = [row for row in material.tests.tests if row.measure == quantity.name]
    if quantity.name in BY_STRENGTH or not any(r.effect in names for r in rows):
        return ""
    verdicts: dict[str, list[str]] = {}
    for effect, name in names.items():
        marks = {
            row.analysis: bool(row.mark)
            for row in rows
            if row.effect == effect and math.isfinite(row.p_corrected)
        }
        verdicts.setdefault(_factor_verdict(marks), []).append(name)
    parts = [f"{listed(names)} {verdict}" for verdict, names in verdicts.items()]
    return f"Among the assisted conditions: {'; '.join(parts)}."


def _factor_verdict(marks: dict[str, bool]) -> str:
    if not marks:
        return "not tested"
    within, pooled = marks.get(WITHIN, False), marks.get(PUBLISHED, False)
    if within and pooled:
        return "significant by both analyses"
    if within:
        return "significant within subjects only"
    return "significant in the pooled analysis only" if pooled else "not significant"


def meanings(material: StudyMaterial) -> tuple[list[str], list[str]]:
    """Say what the differences within subjects mean, and which measures show none.

    Returns:
        A clause for each measure with a significant difference, and the titles of
        those that were tested without one.
    """
    clauses, without = [], []
    for quantity in shown_quantities(material):
        found = comparisons(material, quantity)
        tested = [each for each in found if each.within is not None]
        differing = [each for each in tested if each.within]
        if tested and not differing:
            without.append(quantity.title)
        parts = [
            f"{MEANINGS[quantity.name][sign > 0]} {_where(levels, found, quantity)}"
            for sign in (-1, 1)
            if (levels := [each for each in differing if each.within == sign])
        ]
        if parts:
            clauses.append("; they ".join(parts))
    return clauses, without


def _where(
    levels: list[Comparison], found: list[Comparison], quantity: Quantity
) -> str:
    """Name levels without their differences, and those the pooled test leaves open."""
    names = [each.level for each in levels]
    if quantity.name in BY_STRENGTH:
        where = f"with {listed(names)} guidance"
    elif len(levels) == len(found) > 1:
        where = f"in all {_NUMBERS[len(found)]} assisted conditions"
    else:
        where = f"with {listed(names)}"
    doubted = [each.level for each in levels if each.pooled != each.within]
    if not doubted:
        return where
    which = "" if len(doubted) == len(levels) else f" for {listed(doubted)}"
    return f"{where} (not confirmed by the pooled analysis{which})"
