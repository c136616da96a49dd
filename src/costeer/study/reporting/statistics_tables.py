"""The tables of the report that hold tests, pairs and dropped data."""

from __future__ import annotations

import math

from costeer.pages.numerals import (
    NOTHING,
    degrees_of_freedom,
    interval,
    number,
    p_value,
    signed,
)
from costeer.pages.tables import Table
from costeer.study.material import StudyMaterial
from costeer.study.outcome import MIXED, PUBLISHED, WITHIN, EffectRow, PairRow
from costeer.study.quantities import Quantity
from costeer.study.reporting.comparisons import shown_quantities

EFFECTS = {
    "condition": "condition",
    "strength": "strength",
    "change_duration": "planned duration",
    "strength:change_duration": "strength × planned duration",
}

_ALL_OF_LANE_CHANGES = "All measures of lane changes"


def effects_table(material: StudyMaterial) -> Table:
    """Return the analyses of variance, as published beside within subjects."""
    rows: list[tuple[str, ...]] = []
    for quantity in shown_quantities(material):
        tests = [row for row in material.tests.tests if row.measure == quantity.name]
        for effect in dict.fromkeys(row.effect for row in tests):
            by_analysis = {row.analysis: row for row in tests if row.effect == effect}
            cells = [
                cell
                for analysis in (PUBLISHED, WITHIN)
                for cell in _effect_cells(by_analysis.get(analysis))
            ]
            named = any(row[0] == quantity.title for row in rows)
            title = "" if named else quantity.title
            rows.append((title, EFFECTS.get(effect, effect), *cells))
    return Table(
        name="effects",
        title="Analyses of variance, as published and within subjects",
        note="Planned duration and its interaction are tested without manual. Within "
        "subjects the degrees of freedom are those after Greenhouse-Geisser, and p "
        "belongs to them. η²p: partial eta squared with its 95 % interval.",
        header=(
            "Measure",
            "Effect",
            "Pooled F (df)",
            "p",
            "η²p",
            "Within F (df)",
            "p",
            "η²p",
        ),
        rows=tuple(rows),
        num_labels=2,
    )


def mixed_table(material: StudyMaterial) -> Table | None:
    """Return the mixed models of measures with missing cells; None without any."""
    titles = {each.name: each.title for each in shown_quantities(material)}
    rows = [
        (titles[row.measure], EFFECTS.get(row.effect, row.effect), *_effect_cells(row))
        for row in material.tests.tests
        if row.analysis == MIXED and row.measure in titles
    ]
    if not rows:
        return None
    return Table(
        name="mixed",
        title="Mixed models with participant as random effect",
        note="For measures of which a participant lacks a cell: all cells that are "
        "there take part.",
        header=("Measure", "Effect", "F (df)", "p", "η²p"),
        rows=tuple(rows),
        num_labels=2,
    )


def _effect_cells(row: EffectRow | None) -> tuple[str, str, str]:
    if row is None or not math.isfinite(row.statistic):
        return NOTHING, NOTHING, row.note if row is not None else NOTHING
    df1, df2 = (degrees_of_freedom(row.epsilon * df) for df in (row.df1, row.df2))
    size = number(row.effect_size, 2)
    ends = interval(row.effect_size_low, row.effect_size_high, 2)
    return (
        f"{number(row.statistic, 2)} ({df1}, {df2})",
        f"{p_value(row.p_corrected)} {row.mark}".rstrip(),
        f"{size} {ends}".rstrip(),
    )


def again_table(material: StudyMaterial) -> Table | None:
    """Return trials beside the first of their condition; None if there are none."""
    shown = {each.name: each for each in shown_quantities(material)}
    rows = []
    for row in material.again:
        if row.measure not in shown:
            continue
        quantity = shown[row.measure]
        means = (row.mean_second, row.mean_first)
        told = [number(m * quantity.factor, quantity.digits) for m in means]
        title = f"{quantity.title} [{quantity.unit}]"
        pair = f"{row.first} − {row.second}"
        rows.append((title, pair, *told, *_pair_cells(row, quantity), str(row.n_first)))
    if not rows:
        return None
    return Table(
        name="again",
        title="Conditions that were driven again",
        note="Later trial minus the first, paired t tests, corrected over the pairs of "
        "a measure. Neither the order nor what lay between is taken out. Also in "
        "again.csv.",
        header=(
            *("Measure", "Pair", "First", "Later"),
            *("Difference", "t (df)", "p", "d_z", "n"),
        ),
        rows=tuple(rows),
        num_labels=2,
    )


def pairs_table(material: StudyMaterial, quantity: Quantity) -> Table:
    """Return the comparisons of one measure, as published beside within subjects."""
    pairs = [row for row in material.tests.pairs if row.measure == quantity.name]
    rows = []
    for first, second in dict.fromkeys((row.first, row.second) for row in pairs):
        by_analysis = {
            row.analysis: row for row in pairs if row[2:4] == (first, second)
        }
        cells = [
            cell
            for analysis in (PUBLISHED, WITHIN)
            for cell in _pair_cells(by_analysis.get(analysis), quantity)
        ]
        rows.append((f"{first} − {second}", *cells))
    return Table(
        name=f"pairs-{quantity.name.replace('_', '-')}",
        title=f"{quantity.title}: differences [{quantity.unit}]",
        note="",
        header=(
            "Pair",
            "Pooled difference",
            "t (df)",
            "p",
            "d",
            "Within difference",
            "t (df)",
            "p",
            "d_z",
        ),
        rows=tuple(rows),
    )


def _pair_cells(row: PairRow | None, quantity: Quantity) -> tuple[str, str, str, str]:
    if row is None:
        return NOTHING, NOTHING, NOTHING, NOTHING
    low, high = row.low * quantity.factor, row.high * quantity.factor
    difference = signed(row.mean_difference * quantity.factor, quantity.digits)
    if not math.isfinite(row.statistic):
        return difference, NOTHING, NOTHING, row.note or NOTHING
    size = number(row.effect_size, 2)
    ends = interval(row.effect_size_low, row.effect_size_high, 2)
    return (
        f"{difference}\n{interval(low, high, quantity.digits)}",
        f"{number(row.statistic, 2)} ({degrees_of_freedom(row.df)})",
        f"{p_value(row.p_corrected)} {row.mark}".rstrip(),
        f"{size}\n{ends}",
    )


def dropped_table(material: StudyMaterial) -> Table | None:
    """Return the data that no test could use; None if there are none."""
    titles = {each.name: each.title for each in shown_quantities(material)}
    rows = _dropped_crossings(material) + [
        (titles.get(row.measure, row.measure), row.participant, row.cell, row.reason)
        for row in material.tests.dropped
    ]
    if not rows:
        return None
    return Table(
        name="dropped",
        title="Dropped data",
        note="Also in dropped.csv; dropped crossings in trials.csv.",
        header=("Measure", "Participant", "Cell", "Reason"),
        rows=tuple(rows),
        num_labels=4,
        prose=True,
    )


def _dropped_crossings(material: StudyMaterial) -> list[tuple[str, str, str, str]]:
    """Name the crossings of the line that make no lane change."""
    if "dropped_changes" not in material.trials:
        return []
    known = material.trials.dropna(subset=["dropped_changes"])
    columns = (known[name] for name in ("participant", "condition", "dropped_changes"))
    return [
        (_ALL_OF_LANE_CHANGES, str(participant), f"{condition}, crossing at {at}", why)
        for participant, condition, text in zip(*columns, strict=True)
        for at, _, why in (each.partition(": ") for each in text.split("; ") if each)
    ]
