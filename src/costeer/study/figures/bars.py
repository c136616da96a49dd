"""Bar charts of the measures: means, 95 % intervals, participants, marks."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from costeer.methods.conditions import MANUAL, condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FAINT,
    FULL_WIDTH_MM,
    INK,
    NORMAL,
    SMALL,
    STRENGTH_COLOURS,
    Margins,
    interval_bar,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.figures.colours import condition_colour
from costeer.study.material import (
    StudyMaterial,
    conditions_driven,
    mark_of,
    pair,
    participant_means,
    strengths_driven,
    summary,
)
from costeer.study.outcome import PUBLISHED, WITHIN
from costeer.study.quantities import BY_STRENGTH, Quantity

_HEIGHT_MM = 66.0
_MARGINS = Margins(left=15.0, right=2.0, top=13.0, bottom=11.0, between_columns=19.0)
_ANALYSES = ((WITHIN, "within"), (PUBLISHED, "pooled"))
_BRACKETS = {(MANUAL, "strong"): 0.5, ("strong", "weak"): 0.5, (MANUAL, "weak"): 1.7}
"""Pairs of strengths and how high their bracket stands."""

_MOST_CIRCLES = 40
"""Participants shown one by one; more would hide the bars."""

_ROW_HEIGHT = 9.0
"""Between two rows of marks [pt]."""


def file_name(quantity: Quantity) -> str:
    """Return the stem of the figure's file."""
    return quantity.name.replace("_", "-")


def draw(material: StudyMaterial, quantity: Quantity) -> Exhibit:
    """Draw a measure by condition, and by strength where the paper does."""
    name = file_name(quantity)
    levels = [
        each
        for each in conditions_driven(material)
        if _interval(material, quantity, "condition", each)
    ]
    if not levels:
        return not_drawn(
            name, quantity.title, f"{quantity.title}: no trial has a value."
        )
    both = quantity.name in BY_STRENGTH and len(strengths_driven(material)) > 1
    figure = new_figure(FULL_WIDTH_MM if both else COLUMN_WIDTH_MM, _HEIGHT_MM)
    axes = panels(figure, 1, 2 if both else 1, _MARGINS, (3, 7) if both else None)[0]
    if both:
        _by_strength(axes[0], material, quantity)
        for panel, letter in zip(axes, "ab", strict=True):
            panel_letter(panel, letter)
    _by_condition(axes[-1], material, quantity, levels)
    axes[-1].set_ylim(axes[0].get_ylim())
    for panel in axes:
        panel.set_ylabel(f"{quantity.label} [{quantity.unit}]", size=NORMAL)
    caption = _caption(material, quantity, both)
    return Exhibit(name, quantity.title, caption, _description(quantity), figure)


def _caption(material: StudyMaterial, quantity: Quantity, both: bool) -> str:
    participants = material.trials["participant"].nunique()
    what = "(a) By strength, (b) by condition. " if both else ""
    unit = (
        ""
        if quantity.table == "trials"
        else "of the lane changes of each participant, "
    )
    brackets = (
        " Brackets in (a): the same for each pair, within | pooled." if both else ""
    )
    who = f"{participants} participant" + ("s" if participants > 1 else "")
    circles = "; circles are participants" if participants <= _MOST_CIRCLES else ""
    interval = (
        f"bars with 95 % intervals{circles}"
        if participants > 1
        else "no interval from one participant"
    )
    return (
        f"{what}Means {unit}over {who}, {interval}. Rows above: "
        "difference from manual, Benjamini-Hochberg corrected, within subjects and "
        f"pooled as published: * p < 0.05, ** p < 0.01, *** p < 0.001, n.s. not "
        f"significant, – not tested.{brackets}{_cut(material, quantity, both)}"
    )


def _cut(material: StudyMaterial, quantity: Quantity, both: bool) -> str:
    """Say that an interval goes below the axis, where one does."""
    drawn = [("condition", each) for each in conditions_driven(material)]
    drawn += [("strength", each) for each in strengths_driven(material) if both]
    found = (_interval(material, quantity, *each) for each in drawn)
    below = any(each is not None and each[0] < each[1] for each in found)
    return " Intervals that reach below zero are cut at zero." if below else ""


def _description(quantity: Quantity) -> str:
    return (
        f"Bar chart of {quantity.title} in {quantity.unit} for manual driving and each "
        "assisted condition; the numbers stand in the table of measures."
    )


def _interval(
    material: StudyMaterial, quantity: Quantity, factor: str, level: str
) -> tuple[float, float] | None:
    """Mean and half of its interval in shown units; None without a value."""
    row = summary(material, quantity.name, factor, level)
    if row is None or not math.isfinite(row.mean):
        return None
    return row.mean * quantity.factor, (row.high - row.mean) * quantity.factor


def _by_condition(
    axes: Axes, material: StudyMaterial, quantity: Quantity, levels: list[str]
) -> None:
    places = _places(levels)
    _bars(axes, material, quantity, "condition", places)
    axes.set_xticks(list(places.values()))
    axes.set_xticklabels([condition(name).duration or name for name in places])
    _group_labels(axes, places)
    for row, (analysis, label) in enumerate(_ANALYSES):
        marks = {
            places[name]: _mark(material, quantity, analysis, name, MANUAL)
            for name in places
            if name != MANUAL
        }
        _row_of_marks(axes, row, label, marks)


def _places(levels: list[str]) -> dict[str, float]:
    """Where each bar stands: one apart, groups of a strength a little more."""
    places: dict[str, float] = {}
    strength, x = "", -1.0
    for name in levels:
        x += 1.0 if condition(name).strength == strength else 1.35
        strength = condition(name).strength
        places[name] = x
    return places


def _by_strength(axes: Axes, material: StudyMaterial, quantity: Quantity) -> None:
    names = [
        name
        for name in strengths_driven(material)
        if _interval(material, quantity, "strength", name)
    ]
    places = {name: float(place) for place, name in enumerate(names)}
    top = _bars(axes, material, quantity, "strength", places)
    axes.set_xticks(list(places.values()))
    axes.set_xticklabels(names)
    step = 0.13 * top
    for (first, second), level in _BRACKETS.items():
        if first in places and second in places:
            ends = (places[first] + 0.06, places[second] - 0.06)
            tested = (second, first) if first == MANUAL else (first, second)
            marks = [_mark(material, quantity, kind, *tested) for kind, _ in _ANALYSES]
            _bracket(axes, ends, top + level * step, " | ".join(marks))
    axes.set_ylim(0.0, top + 2.8 * step)


def _bars(
    axes: Axes,
    material: StudyMaterial,
    quantity: Quantity,
    factor: str,
    places: dict[str, float],
) -> float:
    """Draw bars, intervals and participants; return the height of the highest."""
    own = participant_means(material, quantity, factor)
    top = 0.0
    for name, x in places.items():
        mean, half = _interval(material, quantity, factor, name) or (math.nan, math.nan)
        colour = (condition_colour if factor == "condition" else _strength_colour)(name)
        (bar,) = axes.bar(x, mean, width=0.74, color=colour)
        ends = (
            {} if math.isnan(half) else {"low": (mean - half,), "high": (mean + half,)}
        )
        say(bar, name, **ends)
        values = own.get(name, pd.Series(dtype=float))
        if values.size > 1:
            if values.size <= _MOST_CIRCLES:
                _participants(axes, x, values, name)
            interval_bar(axes, (x, mean), True, half, half)
        top = max(top, mean, *(mean + half, values.max()) if values.size > 1 else ())
    axes.set_xlim(min(places.values()) - 0.6, max(places.values()) + 0.6)
    axes.set_ylim(0.0, 1.04 * top if top > 0.0 else 1.0)
    return top if top > 0.0 else 1.0


def _participants(axes: Axes, x: float, values: pd.Series[float], name: str) -> None:
    """Circles beside the interval, participants in order from left to right."""
    offsets = np.linspace(-0.29, 0.29, values.size)
    (circles,) = axes.plot(
        x + offsets,
        values.to_numpy(),
        linestyle="none",
        marker="o",
        markersize=2.0,
        markerfacecolor="white",
        markeredgecolor=INK,
        markeredgewidth=0.4,
        alpha=0.75,
    )
    say(circles, name, points=tuple(f"participant {who}" for who in values.index))


def _strength_colour(name: str) -> str:
    return STRENGTH_COLOURS[name]


def _mark(
    material: StudyMaterial, quantity: Quantity, analysis: str, first: str, second: str
) -> str:
    return mark_of(pair(material, quantity.name, analysis, first, second))


def _group_labels(axes: Axes, places: dict[str, float]) -> None:
    """Name each strength below its bars."""
    for strength in STRENGTH_COLOURS:
        xs = [x for name, x in places.items() if condition(name).strength == strength]
        if not xs or strength == MANUAL:
            continue
        axes.annotate(
            strength,
            xy=(float(np.mean(xs)), 0.0),
            xycoords=("data", "axes fraction"),
            xytext=(0.0, -14.0),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=SMALL,
            color=STRENGTH_COLOURS[strength],
        )


def _row_of_marks(axes: Axes, row: int, label: str, marks: dict[float, str]) -> None:
    """One row above the panel: its label at the left, a mark above each bar."""
    height = 4.0 + row * _ROW_HEIGHT
    texts = {0.0: label} | marks
    for x, text in texts.items():
        axes.annotate(
            text,
            xy=(x, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0.0, height),
            textcoords="offset points",
            ha="center",
            va="baseline",
            fontsize=SMALL,
            color=INK if text != "n.s." else FAINT,
        )


def _bracket(axes: Axes, ends: tuple[float, float], height: float, text: str) -> None:
    drop = 0.02 * height
    xs = [ends[0], ends[0], ends[1], ends[1]]
    axes.plot(xs, [height - drop, height, height, height - drop], color=INK, lw=0.6)
    axes.annotate(
        text,
        xy=((ends[0] + ends[1]) / 2.0, height),
        xytext=(0.0, 1.5),
        textcoords="offset points",
        ha="center",
        va="bottom",
        fontsize=SMALL,
    )
