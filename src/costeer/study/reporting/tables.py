"""The tables of the report, as text in cells."""

from __future__ import annotations

import math
from collections.abc import Sequence

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import NOTHING, count, interval, number
from costeer.pages.tables import Table
from costeer.study.material import (
    StudyMaterial,
    conditions_driven,
    mark_of,
    pair,
    strengths_driven,
    summary,
)
from costeer.study.outcome import PUBLISHED, WITHIN
from costeer.study.quantities import BY_STRENGTH, DEG, Quantity
from costeer.study.reporting.comparisons import shown_quantities


def measures_table(material: StudyMaterial) -> Table:
    """Return the mean of each measure in each condition with its interval."""
    names = conditions_driven(material)
    rows = []
    for quantity in shown_quantities(material):
        means = _means(material, quantity, "condition", names)
        marks = [_marks(material, quantity, name) for name in names]
        cells = ["\n".join(parts) for parts in zip(means, marks, strict=True)]
        rows.append((f"{quantity.title}\n[{quantity.unit}]", *cells))
    return Table(
        name="measures",
        title="Measures by condition",
        note="Mean over participants' own means; below it the 95 % interval; then "
        "the marks of the difference from manual, within subjects | pooled as "
        "published: * p < 0.05, ** p < 0.01, *** p < 0.001, n.s. not significant.",
        header=("Measure", *names),
        rows=tuple(rows),
    )


def strengths_table(material: StudyMaterial) -> Table:
    """Return the measures of lane keeping by strength."""
    names = strengths_driven(material)
    shown = [each for each in shown_quantities(material) if each.name in BY_STRENGTH]
    return Table(
        name="strengths",
        title="Lane keeping by strength",
        note="Mean over participants' own means, below it the 95 % interval.",
        header=("Measure", *names),
        rows=tuple(
            (f"{each.title}\n[{each.unit}]", *_means(material, each, "strength", names))
            for each in shown
        ),
    )


def _means(
    material: StudyMaterial, quantity: Quantity, factor: str, levels: Sequence[str]
) -> list[str]:
    cells = []
    for level in levels:
        row = summary(material, quantity.name, factor, level)
        if row is None or not math.isfinite(row.mean):
            cells.append(NOTHING)
            continue
        mean = number(row.mean * quantity.factor, quantity.digits)
        ends = (row.low * quantity.factor, row.high * quantity.factor)
        cells.append(f"{mean}\n{interval(*ends, quantity.digits)}".rstrip())
    return cells


def _marks(material: StudyMaterial, quantity: Quantity, name: str) -> str:
    """Marks of both analyses against manual; nothing for manual itself."""
    if name == MANUAL:
        return ""
    rows = [
        pair(material, quantity.name, analysis, name, MANUAL)
        for analysis in (WITHIN, PUBLISHED)
    ]
    return " | ".join(mark_of(row) for row in rows)


_OF_TRIAL = {
    "sdlp": ("SDLP [m]", 1.0, 3),
    "swrr": ("Reversals [1/min]", 1.0, 2),
    "driver_torque_rms": ("Torque RMS [N·m]", 1.0, 3),
    "num_lane_changes": ("Lane changes", 1.0, 0),
    "num_dropped_changes": ("Dropped", 1.0, 0),
    "num_false_triggers": ("False triggers", 1.0, 0),
    "num_missed": ("Missed", 1.0, 0),
    "num_inconsistencies": ("Inconsistencies", 1.0, 0),
}
_OF_CHANGE = {
    "overshoot": ("Overshoot [m]", 1.0, 3),
    "steering_velocity_rms": ("RMS velocity [deg/s]", DEG, 2),
    "peak_steering_angle": ("Peak angle [deg]", DEG, 2),
    "duration": ("Duration [s]", 1.0, 2),
}
"""Columns of the table of trials: heading, shown value of one unit, decimals."""


def trials_table(material: StudyMaterial) -> Table:
    """Return each trial with its own measures."""
    key = ["participant", "condition"]
    own = material.lane_changes.groupby(key)[list(_OF_CHANGE)].mean()
    own = own.rename(columns=lambda name: f"change_{name}")
    table = material.trials.set_index(key)[["order", *_OF_TRIAL]].join(own)
    shown = _OF_TRIAL | {f"change_{name}": form for name, form in _OF_CHANGE.items()}
    rows = [
        (
            *(str(name) for name in names),
            count(float(row["order"])),
            *(number(float(row[c]) * f, digits) for c, (_, f, digits) in shown.items()),
        )
        for names, row in table.iterrows()
    ]
    headings = (heading for heading, _, _ in shown.values())
    return Table(
        name="trials",
        title="Every trial",
        note="The last four columns are means over the lane changes of the trial. More "
        "columns and every lane change stand in trials.csv and lane_changes.csv.",
        header=("Participant", "Condition", "Order", *headings),
        rows=tuple(rows),
        num_labels=2,
    )
