"""NASA-TLX from people; virtual drivers have no subjective workload."""

from __future__ import annotations

import math

from matplotlib.axes import Axes

from costeer.methods.conditions import MANUAL, condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FULL_WIDTH_MM,
    SMALL,
    Margins,
    interval_bar,
    new_figure,
    panels,
)
from costeer.study.figures import bars
from costeer.study.figures.colours import condition_colour
from costeer.study.material import StudyMaterial, is_virtual, mark_of
from costeer.study.outcome import WILCOXON, StudyTests, SummaryRow
from costeer.study.quantities import WORKLOAD, WORKLOAD_ITEMS, Quantity

NAME = "workload"
ITEMS_NAME = "workload-items"
TITLE = "NASA-TLX"
_ITEMS_TITLE = "NASA-TLX, its six items"


def draw(material: StudyMaterial) -> list[Exhibit]:
    """Draw raw and weighted scores and the items, or say why there are none."""
    answered = [
        each
        for each in WORKLOAD
        if each.name in material.trials and material.trials[each.name].notna().any()
    ]
    if is_virtual(material):
        lacking = (
            "NASA-TLX is asked of people only. These are virtual drivers: they have no "
            "subjective workload, and no numbers are made up for it."
        )
        return [not_drawn(NAME, TITLE, lacking)]
    if not answered:
        columns = " and ".join(each.name for each in WORKLOAD)
        lacking = f"No answers to the NASA-TLX are in trials.csv (columns {columns})."
        return [not_drawn(NAME, TITLE, lacking)]
    items = [] if material.answers is None else [_items(material.answers)]
    return [*(bars.draw(material, each) for each in answered), *items]


def _items(tests: StudyTests) -> Exhibit:
    """Draw each item by condition: Fig. 21."""
    figure = new_figure(FULL_WIDTH_MM, 140.0)
    margins = Margins(
        left=14.0, top=11.0, bottom=10.0, between_columns=14.0, between_rows=19.0
    )
    grid = panels(figure, 3, 2, margins)
    places = [axes for row in grid for axes in row]
    for axes, item in zip(places, WORKLOAD_ITEMS, strict=True):
        _panel(axes, item, tests)
    for row in grid:
        row[0].set_ylabel("Rating [0–100]")
    return Exhibit(ITEMS_NAME, _ITEMS_TITLE, _CAPTION, _DESCRIPTION, figure)


_CAPTION = (
    "Means over participants with 95 % intervals, cut at the ends of the scale; more "
    "is load in every item, also of performance (perfect to failure). Above: "
    "Wilcoxon's signed-rank test against manual, Benjamini-Hochberg corrected: "
    "* p < 0.05, "
    "** p < 0.01, *** p < 0.001, n.s. not significant, – not tested."
)
_DESCRIPTION = (
    "Six bar charts, one for each item of the NASA-TLX, by condition; the numbers "
    "stand in the table of answers."
)


def _panel(axes: Axes, item: Quantity, tests: StudyTests) -> None:
    rows = [
        row
        for row in tests.summaries
        if row.measure == item.name and row.analysis == "within"
    ]
    for place, row in enumerate(rows):
        if math.isfinite(row.mean):
            colour = condition_colour(row.level)
            (bar,) = axes.bar(place, row.mean, width=0.74, color=colour)
            say(bar, row.level, low=(row.low,), high=(row.high,))
            _interval(axes, place, row)
        if row.level != MANUAL:
            axes.annotate(
                _mark(tests, item.name, row.level),
                xy=(place, 103.0),
                ha="center",
                fontsize=SMALL,
                annotation_clip=False,
            )
    axes.set_ylim(0.0, 100.0)
    axes.set_yticks([0, 25, 50, 75, 100])
    axes.set_xlim(-0.6, len(rows) - 0.4)
    axes.set_xticks(range(len(rows)))
    axes.set_xticklabels([_label(row.level) for row in rows], size=SMALL)
    axes.set_title(item.title, pad=13.0)


def _interval(axes: Axes, place: int, row: SummaryRow) -> None:
    half = row.high - row.mean
    if math.isfinite(half):
        ends = min(half, row.mean), min(half, 100.0 - row.mean)
        interval_bar(axes, (place, row.mean), True, *ends)


def _mark(tests: StudyTests, item: str, level: str) -> str:
    wanted = (item, WILCOXON, level, MANUAL)
    return mark_of(next((row for row in tests.pairs if row[:4] == wanted), None))


def _label(name: str) -> str:
    chosen = condition(name)
    return f"{chosen.strength}\n{chosen.duration}".strip()
