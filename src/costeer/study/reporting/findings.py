"""What came out, in sentences made from the tests by fixed rules.

Nothing is said that a row of `pairs.csv` or `tests.csv` does not say: which levels
differ significantly from manual driving, under which of the two analyses, in which
direction and by how much.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import listed, number, signed
from costeer.study.material import StudyMaterial, summary
from costeer.study.outcome import PUBLISHED, WITHIN
from costeer.study.quantities import BY_STRENGTH, SCORE, Quantity
from costeer.study.reporting.comparisons import (
    AgainstManual,
    compared_levels,
    comparisons,
    shown_quantities,
)

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


def measure_sentences(material: StudyMaterial, quantity: Quantity) -> str:
    """Say what came out for one measure."""
    manual = summary(material, quantity.name, "condition", MANUAL)
    if manual is None or not math.isfinite(manual.mean):
        return _without_manual(material, quantity)
    mean = number(manual.mean * quantity.factor, quantity.digits)
    sentences = [f"{mean}{_unit(quantity)} in manual driving."]
    found = comparisons(material, quantity)
    kinds = dict.fromkeys((each.within, each.pooled) for each in found)
    for kind in sorted(kinds, key=_most_certain_first):
        levels = [each for each in found if (each.within, each.pooled) == kind]
        sentences.append(_group_sentence(quantity, kind, levels, len(found)))
    sentences.append(_factor_sentence(material, quantity))
    return " ".join(each for each in sentences if each)


def _without_manual(material: StudyMaterial, quantity: Quantity) -> str:
    """Say the means alone where there is no manual driving to compare with."""
    factor = "strength" if quantity.name in BY_STRENGTH else "condition"
    means = []
    for level in compared_levels(material, quantity):
        row = summary(material, quantity.name, factor, level)
        if row is not None and math.isfinite(row.mean):
            mean = number(row.mean * quantity.factor, quantity.digits)
            means.append(f"{level} {mean}{_unit(quantity)}")
    if not means:
        return "No trial has a value."
    return f"Means: {listed(means)}. No manual driving to compare with."


def _most_certain_first(kind: tuple[int | None, int | None]) -> tuple[int, int]:
    within, pooled = kind
    doubts = (within is None) + (pooled is None)
    return 3 * doubts - abs(within or 0) - abs(pooled or 0), -abs(within or 0)


def _group_sentence(
    quantity: Quantity,
    kind: tuple[int | None, int | None],
    levels: list[AgainstManual],
    num_levels: int,
) -> str:
    within, pooled = kind
    where = _levels_text(quantity, levels, num_levels)
    if within is None and pooled is None:
        return f"Not tested {where}."
    if within and pooled and within != pooled:
        return f"The two analyses contradict each other {where}."
    sign = within or pooled
    word = quantity.more if sign == 1 else quantity.less
    outcome = word.capitalize() if sign else "No significant difference"
    return f"{outcome} {where}{_WHICH_ANALYSIS[_tested(within), _tested(pooled)]}."


def _tested(direction: int | None) -> str:
    return "not tested" if direction is None else "yes" if direction else "no"


_WHICH_ANALYSIS = {
    ("yes", "yes"): ", by both analyses",
    ("yes", "no"): ", within subjects only",
    ("no", "yes"): ", in the pooled analysis only",
    ("no", "no"): "",
    ("yes", "not tested"): " within subjects (pooled not tested)",
    ("no", "not tested"): " within subjects (pooled not tested)",
    ("not tested", "yes"): " in the pooled analysis (within subjects not tested)",
    ("not tested", "no"): " in the pooled analysis (within subjects not tested)",
}


def _levels_text(
    quantity: Quantity, levels: list[AgainstManual], num_levels: int
) -> str:
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
    return f"{where} ({low} to {high}{_unit(quantity)})"


def _difference(quantity: Quantity, comparison: AgainstManual) -> str:
    if not math.isfinite(comparison.difference):
        return ""
    difference = signed(comparison.difference, quantity.digits)
    return f" ({difference}{_unit(quantity)})"


def _unit(quantity: Quantity) -> str:
    """Unit after a number; a score has none."""
    return "" if quantity.unit == SCORE else f" {quantity.unit}"


def _factor_sentence(material: StudyMaterial, quantity: Quantity) -> str:
    """Say which factors matter among the assisted conditions."""
    names = {
        "strength": "strength",
        "change_duration": "planned duration",
        "strength:change_duration": "the interaction of the two",
    }
    rows = [row for row in material.tests.tests if row.measure == quantity.name]
    if quantity.name in BY_STRENGTH or not any(r.effect in names for r in rows):
        return ""
    verdicts: dict[str, list[str]] = {}
    for effect, name in names.items():
        marks = {
            row.analysis: "yes" if row.mark else "no"
            for row in rows
            if row.effect == effect and math.isfinite(row.p_corrected)
        }
        if marks:
            verdicts.setdefault(_factor_verdict(marks), []).append(name)
    if not verdicts:
        return ""
    parts = [f"{listed(names)} {verdict}" for verdict, names in verdicts.items()]
    return f"Among the assisted conditions: {'; '.join(parts)}."


def _factor_verdict(marks: dict[str, str]) -> str:
    kind = tuple(marks.get(each, "not tested") for each in (WITHIN, PUBLISHED))
    outcome = "significant" if "yes" in kind else "not significant"
    return f"{outcome}{_WHICH_ANALYSIS[kind[0], kind[1]].replace(', ', ' ')}"


class Meaning(NamedTuple):
    """What the tests within subjects come to.

    Attributes:
        clauses: One per measure with a significant difference.
        without: Titles of measures that were tested without one.
        tested: Whether anything could be tested within subjects.
    """

    clauses: tuple[str, ...]
    without: tuple[str, ...]
    tested: bool


def meaning(material: StudyMaterial) -> Meaning:
    """Say what the differences within subjects mean."""
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
    tested_any = bool(clauses or without)
    return Meaning(tuple(clauses), tuple(without), tested_any)


def _where(
    levels: list[AgainstManual], found: list[AgainstManual], quantity: Quantity
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
