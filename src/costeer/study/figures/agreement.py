"""People beside virtual drivers: the means of every measure in every condition."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from costeer.methods.conditions import CONDITION_NAMES, MANUAL, condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.numerals import number
from costeer.pages.series import say
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    SHADE,
    SMALL,
    Margins,
    new_figure,
    panels,
)
from costeer.study.agreement import AgreementRow, agreement
from costeer.study.figures.colours import condition_colour
from costeer.study.material import StudyMaterial
from costeer.study.quantities import QUANTITIES, Quantity

NAME = "agreement"
TITLE = "People beside virtual drivers"

_COLUMNS = 2
_GROUPS = {"o": "people", "s": "virtual drivers"}
_APART = 0.17
"""Of people and virtual drivers from the middle of a condition."""


def draw(material: StudyMaterial) -> list[Exhibit]:
    """Draw both groups in one panel for each measure; nothing without both."""
    if material.beside is None:
        return []
    rows = agreement(material, material.beside)
    shown = [each for each in QUANTITIES if any(r.measure == each.name for r in rows)]
    if not shown:
        return [not_drawn(NAME, TITLE, "No measure has a mean in both studies.")]
    lines = -(-len(shown) // _COLUMNS)
    figure = new_figure(FULL_WIDTH_MM, 12.0 + 44.0 * lines)
    margins = Margins(
        left=15.0, top=11.0, bottom=10.0, between_columns=17.0, between_rows=15.0
    )
    grid = panels(figure, lines, _COLUMNS, margins)
    places = [axes for row in grid for axes in row]
    for axes, quantity in zip(places, shown, strict=False):
        _panel(axes, quantity, [each for each in rows if each.measure == quantity.name])
    for axes in places[len(shown) :]:
        axes.remove()
    figure.legend(handles=_legend(), ncols=3, loc="upper right")
    return [Exhibit(NAME, TITLE, _CAPTION, _DESCRIPTION, figure)]


_CAPTION = (
    "Means over participants' own means with 95 % intervals: filled circles are "
    "people, open squares virtual drivers. Grey: 95 % prediction interval of the "
    "virtual drivers for the mean of as many others as there are people. r: "
    "correlation of both means over the conditions."
)
_DESCRIPTION = (
    "A panel for each measure; in each condition the mean of people beside that of "
    "virtual drivers. The numbers stand in the table of agreement."
)


def _panel(axes: Axes, quantity: Quantity, rows: list[AgreementRow]) -> None:
    names = [name for name in CONDITION_NAMES if any(r.condition == name for r in rows)]
    for row in rows:
        _draw(axes, names.index(row.condition), row, quantity.factor)
    axes.set_xlim(-0.6, len(names) - 0.4)
    axes.set_xticks(range(len(names)))
    axes.set_xticklabels(list(map(_label, names)), size=SMALL)
    axes.set_ylabel(f"{quantity.label} [{quantity.unit}]")
    r = number(rows[0].correlation, 2)
    axes.set_title(f"r = {r}", size=SMALL, loc="right")


def _label(name: str) -> str:
    if name == MANUAL:
        return MANUAL
    chosen = condition(name)
    return f"{chosen.strength}\n{chosen.duration}"


def _draw(axes: Axes, place: int, row: AgreementRow, factor: float) -> None:
    colour = condition_colour(row.condition)
    low, high = row.prediction_low * factor, row.prediction_high * factor
    axes.bar(place, high - low, width=0.8, bottom=low, color=SHADE, zorder=0)
    groups = (
        (-_APART, row.mean_people, row.high_people, "o", colour),
        (_APART, row.mean_virtual, row.high_virtual, "s", "white"),
    )
    for shift, mean, upper, marker, filled in groups:
        drawn = axes.errorbar(
            place + shift,
            mean * factor,
            yerr=(upper - mean) * factor,
            color=colour,
            marker=marker,
            markersize=3.6,
            markerfacecolor=filled,
            linewidth=0.9,
            capsize=1.8,
        )
        lower = 2.0 * mean - upper
        ends = {"low": (lower * factor,), "high": (upper * factor,)}
        say(drawn.lines[0], f"{row.condition}, {_GROUPS[marker]}", **ends)


def _legend() -> list[Line2D | Patch]:
    points = (("o", INK, "people"), ("s", "white", "virtual drivers"))
    drawn: list[Line2D | Patch] = [
        Line2D(
            [],
            [],
            color=INK,
            marker=marker,
            linestyle="none",
            markersize=3.6,
            markerfacecolor=face,
            label=label,
        )
        for marker, face, label in points
    ]
    return [*drawn, Patch(color=SHADE, label="prediction for people")]
