"""Figures of a comparison: paired effects against a baseline, trade-offs of aims."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.comparison.criteria import (
    AIMS,
    LESS,
    MORE,
    SPEAKING,
    Criterion,
)
from costeer.comparison.effects import LEVEL, METHODS, NO_EVENTS, EffectRow
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results
from costeer.comparison.winners import turned
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.numerals import listed
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    SHADE,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.quantities import half_width

_OTHERS = (
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#8C3B00",
    "#00456B",
    "#7A5195",
)
_MARKERS = ("s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*", "d", "8")
_COLUMNS = 3
LETTERS = "abcdefghijklmnopqrstuvwxyz"
_LEGEND_ROW_MM = 4.0
_TALL = 9
"""Rows of a legend that fit beside panels [-]."""


class Look(NamedTuple):
    """Colour and marker of a method or a scenario, the same in every figure."""

    colour: str
    marker: str


def looks(methods: Sequence[str]) -> dict[str, Look]:
    """How each method is drawn: manual driving is grey, the paper's method blue."""
    known = {
        "manual": Look(STRENGTH_COLOURS["manual"], "o"),
        "ibhs": Look(STRENGTH_COLOURS["strong"], "o"),
    }
    others = [name for name in methods if name not in known]
    found = {
        name: Look(_OTHERS[place % len(_OTHERS)], _MARKERS[place % len(_MARKERS)])
        for place, name in enumerate(others)
    }
    return known | found


def effects_against(
    results: Results, effects: Sequence[EffectRow], baseline: str
) -> Exhibit:
    """Forest plots of every other method minus a baseline, one panel a measure."""
    name, title = f"against-{baseline}", f"Every method against {baseline}"
    rows = [_turned(row, baseline) for row in effects if _is_of(row, baseline)]
    rows = [row for row in rows if row.note != NO_EVENTS]
    shown = [each for each in SPEAKING if any(r.measure == each.name for r in rows)]
    silent = [each.title for each in SPEAKING if each.is_count and each not in shown]
    others = [each for each in results.methods if each != baseline]
    others = [each for each in others if any(row.first == each for row in rows)]
    if not rows:
        return not_drawn(name, title, f"Nothing could be compared with {baseline}.")
    height = max(5.0, 1.3 * len(results.scenarios) + 1.6) * len(others)
    margins = Margins(
        left=_label_width(others),
        right=3.0,
        top=7.0,
        bottom=12.0,
        between_columns=6.0,
        between_rows=17.0,
    )
    legend = _scenario_handles(results.scenarios)
    grid = panel_grid(len(shown), height, margins, legend)
    for place, (axes, measure) in enumerate(zip(grid.panels, shown, strict=True)):
        own = [row for row in rows if row.measure == measure.name]
        _forest(axes, results, measure, own, others)
        axes.set_yticklabels(others if place % grid.num_columns == 0 else [])
        panel_letter(axes, LETTERS[place])
    caption = (
        f"Paired differences, method minus {baseline}, on the same drivers, noise and "
        "traffic: means and 95 % intervals over drivers, one mark a scenario. Filled: "
        f"p < {LEVEL:g} after Benjamini-Hochberg over all comparisons of the measure; "
        "open: not shown to differ. No mark: no value, as a lead time of a method that "
        "starts no lane change, or no event with either method. The shaded side is the "
        f"better one.{_left_out(silent)}"
    )
    described = (
        f"Forest plots with one panel for each of {len(shown)} measures and a row for "
        f"each method; the numbers stand in effects.csv."
    )
    return Exhibit(name, title, caption, described, grid.figure)


class Grid(NamedTuple):
    """A figure, its panels, and in how many columns they stand."""

    figure: Figure
    panels: list[Axes]
    num_columns: int


def panel_grid(
    number: int, panel_mm: float, margins: Margins, handles: Sequence[Line2D]
) -> Grid:
    """A figure with so many panels and a legend, in which no place is empty.

    The legend fills what the last row has left; if that is full it stands above all.

    Args:
        number: Of panels.
        panel_mm: Height of each.
        margins: White space without that of the legend.
        handles: Of the legend.
    """
    num_columns = min(number, _COLUMNS)
    num_rows = -(-number // num_columns)
    is_full = number == num_columns * num_rows
    across = max(1, min(len(handles), 5))
    if is_full:
        extra = 2.0 + _LEGEND_ROW_MM * -(-len(handles) // across)
        margins = margins._replace(top=margins.top + extra)
    height = margins.top + margins.bottom + num_rows * panel_mm
    figure = new_figure(FULL_WIDTH_MM, height + (num_rows - 1) * margins.between_rows)
    flat = [a for line in panels(figure, num_rows, num_columns, margins) for a in line]
    if is_full:
        figure.legend(handles=handles, loc="upper center", ncol=across)
        return Grid(figure, flat, num_columns)
    for axes in flat[number:]:
        axes.set_axis_off()
    beside = 2 if len(handles) > _TALL and len(flat) - number > 1 else 1
    flat[number].legend(handles=handles, loc="upper left", ncol=beside)
    return Grid(figure, flat[:number], num_columns)


def _is_of(row: EffectRow, baseline: str) -> bool:
    named = baseline in (row.first, row.second)
    return row.kind == METHODS and row.mistake == NONE and named


def _turned(row: EffectRow, baseline: str) -> EffectRow:
    """The same comparison as other minus baseline."""
    return row if row.second == baseline else turned(row)


def _label_width(names: Sequence[str]) -> float:
    """White space for the names of methods [mm]."""
    return 8.0 + 1.25 * max(len(name) for name in names)


def _forest(
    axes: Axes,
    results: Results,
    measure: Criterion,
    rows: Sequence[EffectRow],
    others: Sequence[str],
) -> None:
    step = 0.76 / max(len(results.scenarios), 1)
    scenario_looks = _scenario_looks(results.scenarios)
    for row in rows:
        offset = (
            results.scenarios.index(row.scenario) - (len(results.scenarios) - 1) / 2
        )
        y = others.index(row.first) + step * offset
        look = scenario_looks[row.scenario]
        low, mean, high = (
            measure.factor * value for value in (row.low, row.difference, row.high)
        )
        axes.plot([low, high], [y, y], color=look.colour, linewidth=0.9, zorder=2.0)
        filled = row.p_corrected < LEVEL
        axes.plot(
            [mean],
            [y],
            marker=look.marker,
            markersize=3.2,
            markeredgewidth=0.7,
            color=look.colour,
            markerfacecolor=look.colour if filled else "white",
            zorder=3.0,
        )
    _frame_forest(axes, measure, len(others))


def _frame_forest(axes: Axes, measure: Criterion, number: int) -> None:
    """Rows of a forest plot, the line of no difference, and the better side shaded."""
    axes.set_yticks(range(number))
    axes.set_ylim(number - 0.5, -0.5)
    axes.tick_params(axis="y", length=0.0)
    for place in range(1, number):
        axes.axhline(place - 0.5, color=RULE, linewidth=0.4, zorder=0.5)
    axes.margins(x=0.08)
    axes.autoscale_view(scaley=False)
    low, high = axes.get_xlim()
    low, high = min(low, 0.0), max(high, 0.0)
    better = (low, 0.0) if measure.better == LESS else (0.0, high)
    axes.axvspan(*better, color=SHADE, linewidth=0.0, zorder=0.0)
    axes.axvline(0.0, color=INK, linewidth=0.6, zorder=1.0)
    axes.set_xlim(low, high)
    axes.locator_params(axis="x", nbins=4)
    axes.set_xlabel(f"Δ {measure.label}\n[{measure.unit}]")


def _scenario_looks(scenarios: Sequence[str]) -> dict[str, Look]:
    colours = (INK, *_OTHERS)
    markers = ("o", *_MARKERS)
    return {
        name: Look(colours[place % len(colours)], markers[place % len(markers)])
        for place, name in enumerate(scenarios)
    }


def _scenario_handles(scenarios: Sequence[str]) -> list[Line2D]:
    return [
        Line2D(
            [], [], color=look.colour, marker=look.marker, markersize=3.5, label=name
        )
        for name, look in _scenario_looks(scenarios).items()
    ]


class Point(NamedTuple):
    """A method in one measure, over scenarios: mean and half of its interval."""

    mean: float
    half: float


def trade_offs(results: Results) -> Exhibit:
    """A panel for each pair of aims, with a point for each method."""
    name, title = "trade-offs", "Trade-offs between aims"
    spoken = {each.aim: each for each in SPEAKING}  # the last one of an aim
    points = {aim: over_scenarios(results, spoken[aim].name) for aim in AIMS}
    silent = [
        aim
        for aim in AIMS
        if spoken[aim].is_count and not any(p.mean for p in points[aim].values())
    ]
    pairs = [
        (first, second)
        for first, second in itertools.combinations(AIMS, 2)
        if len(points[first].keys() & points[second].keys()) > 1
        and not {first, second} & set(silent)
    ]
    if not pairs:
        return not_drawn(name, title, "Two methods with values of two aims are needed.")
    drawn = [m for m in results.methods if any(m in each for each in points.values())]
    looked = looks(results.methods)
    handles = [_method_handle(each, looked[each]) for each in drawn]
    grid = panel_grid(len(pairs), 30.0, _SCATTER_MARGINS, handles)
    for axes, letter, (first, second) in zip(grid.panels, LETTERS, pairs, strict=False):
        measures = spoken[first], spoken[second]
        _scatter(axes, (points[first], points[second]), measures, looked)
        panel_letter(axes, letter)
    described = f"{len(pairs)} scatter plots of methods, one for each pair of aims."
    return Exhibit(name, title, _trade_off_caption(silent), described, grid.figure)


_SCATTER_MARGINS = Margins(
    left=14.0,
    right=3.0,
    top=7.0,
    bottom=10.0,
    between_columns=17.0,
    between_rows=14.0,
)


def _trade_off_caption(silent: list[str]) -> str:
    return (
        "Means over drivers with 95 % intervals, each driver's mean over the scenarios "
        "in which every method has values. Axes are turned so that the lower left is "
        "better in both. Safety is the smallest time to the line, performance SDLP, "
        "effort the driver's torque, comfort lateral jerk, annoyance false "
        f"activations, intention the lead time.{_left_out(silent)}"
    )


def _left_out(silent: list[str]) -> str:
    """That a count has no panel, since all of it is zero."""
    return f" Left out, as there was no event: {listed(silent)}." if silent else ""


def over_scenarios(results: Results, measure: str) -> dict[str, Point]:
    """Mean of each method over drivers of their means over scenarios.

    Only scenarios in which every method that has values at all has some, and drivers
    with a value in each of them: methods are judged on the same drives.
    """
    columns = {
        method: {
            scenario: results.column((scenario, NONE, method), measure)
            for scenario in results.scenarios
        }
        for method in results.methods
    }
    some = {
        method: {s for s, column in each.items() if np.isfinite(column).sum() > 1}
        for method, each in columns.items()
    }
    there = [method for method, scenarios in some.items() if scenarios]
    common = set(results.scenarios).intersection(*(some[method] for method in there))
    found = {}
    for method in there if common else ():
        each = np.array([columns[method][s] for s in results.scenarios if s in common])
        values: NDArray[np.float64] = each.mean(axis=0)
        values = values[np.isfinite(values)]
        if values.size > 1:
            found[method] = Point(float(values.mean()), half_width(values))
    return found


def _scatter(
    axes: Axes,
    points: tuple[dict[str, Point], dict[str, Point]],
    measures: tuple[Criterion, Criterion],
    looked: dict[str, Look],
) -> None:
    for method in points[0]:
        if method not in points[1]:
            continue
        x, y = points[0][method], points[1][method]
        look = looked[method]
        axes.errorbar(
            x.mean * measures[0].factor,
            y.mean * measures[1].factor,
            xerr=x.half * measures[0].factor,
            yerr=y.half * measures[1].factor,
            color=look.colour,
            marker=look.marker,
            markersize=4.0,
            elinewidth=0.8,
        )
    axes.margins(0.12)
    axes.set_xlabel(f"{measures[0].label} [{measures[0].unit}]")
    axes.set_ylabel(f"{measures[1].label} [{measures[1].unit}]")
    axes.locator_params(nbins=4)
    if measures[0].better == MORE:
        axes.invert_xaxis()
    if measures[1].better == MORE:
        axes.invert_yaxis()


def _method_handle(name: str, look: Look) -> Line2D:
    return Line2D(
        [],
        [],
        color=look.colour,
        marker=look.marker,
        markersize=4.0,
        linestyle="none",
        label=name,
    )
