"""The report of a sensitivity analysis: indices, curves to choose by, tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.base.files import write_text
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.frame import Section, picture, render_page, write_figures
from costeer.pages.numerals import plural
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
    styled,
)
from costeer.pages.tables import Table, versions_table
from costeer.sensitivity.factors import AIMS, FACTORS, Aim
from costeer.sensitivity.run import Index, Outcome, Point, Settings, indices_of, points
from costeer.study.trial_tables import write_csv

REPORT_FILE, INDICES_FILE, SAMPLES_FILE = "report.html", "indices.csv", "samples.csv"
_BINS = 8
_FIRST, _TOTAL = STRENGTH_COLOURS["strong"], STRENGTH_COLOURS["weak"]

Indices = dict[str, list[Index] | str]


def write_report(folder: Path, settings: Settings, outcomes: Sequence[Outcome]) -> Path:
    """Write `report.html`, `indices.csv`, `samples.csv` and `figures/`.

    Args:
        folder: Of the analysis.
        settings: As it was driven.
        outcomes: Of all samples, in order.

    Returns:
        Path of the page.

    Raises:
        OSError: If a file cannot be written.
    """
    drawn = points(settings)
    values = {aim.name: np.array([each[aim.name] for each in outcomes]) for aim in AIMS}
    found: Indices = {n: indices_of(settings, n, v) for n, v in values.items()}
    _write_tables(folder, drawn, outcomes, found)
    with styled():
        shares = picture(_shares(found))
        curves = [picture(_curves(aim, drawn, values[aim.name])) for aim in AIMS]
    write_figures(folder / "figures", [shares, *curves])
    sections = (
        Section("indices", "What decides what", (), (shares, _index_table(found))),
        Section("curves", "Curves to choose by", (_HOW,), tuple(curves)),
        Section("bounds", "What was varied", (), (_bounds_table(),)),
        Section("made", "How this was made", (), (versions_table(),)),
    )
    words = {
        "title": "Sensitivity",
        "heading": "Sensitivity of the intention-based guidance",
        "subtitle": f"costeer, {plural(settings.drivers, 'pilot driver')}",
        "looked_at": [
            f"{len(drawn)} samples of {len(FACTORS)} factors (Saltelli's scheme from "
            f"{settings.base}), each driven by the same "
            f"{plural(settings.drivers, 'pilot driver')} over "
            f"{settings.length / 1000.0:g} km with the same noise."
        ],
        "outcomes": _outcomes(found),
        "caution": (
            "These are virtual drivers who are in no study.",
            "Nothing here changes a default; an index is of these bounds.",
        ),
    }
    write_text(folder / REPORT_FILE, render_page("judgement.html", sections, words))
    return folder / REPORT_FILE


_HOW = (
    "Each panel has one factor: grey dots are samples in which all factors vary, the "
    "line is their mean in eighths of its range with the 95 % interval of that mean, "
    "dashed is the published value. A flat line is a factor that may be chosen freely."
)


def _write_tables(
    folder: Path, drawn: Sequence[Point], outcomes: Sequence[Outcome], found: Indices
) -> None:
    names = [each.place for each in FACTORS]
    rows = [
        {**dict(zip(names, point, strict=True)), **outcome}
        for point, outcome in zip(drawn, outcomes, strict=True)
    ]
    write_csv(folder / SAMPLES_FILE, rows)
    known = [each for each in found.values() if not isinstance(each, str)]
    indices = [row._asdict() for each in known for row in each]
    write_csv(folder / INDICES_FILE, indices, Index._fields)


def _outcomes(found: Indices) -> list[tuple[str, str]]:
    """The factor that counts most for each measure."""
    told = []
    for aim in AIMS:
        rows = found[aim.name]
        if isinstance(rows, str):
            told.append((aim.title, f"no index: {rows}."))
            continue
        first, second = sorted(rows, key=lambda row: -row.total)[:2]
        told.append(
            (
                aim.title,
                f"{first.factor} {first.total:.2f} ± {first.total_half_width:.2f}, "
                "then "
                f"{second.factor} {second.total:.2f} ± "
                f"{second.total_half_width:.2f} (total index).",
            )
        )
    return told


def _shares(found: Indices) -> Exhibit:
    """First-order and total indices of every measure, a panel each."""
    name, title = "indices", "Sobol indices"
    known = [aim for aim in AIMS if not isinstance(found[aim.name], str)]
    if not known:
        return not_drawn(name, title, "No measure varies over the samples.")
    num_rows = -(-len(known) // 3)
    figure = new_figure(FULL_WIDTH_MM, 12.0 + 55.0 * num_rows)
    margins = Margins(
        left=29.0,
        right=3.0,
        top=9.0,
        bottom=8.0,
        between_columns=4.0,
        between_rows=13.0,
    )
    grid = panels(figure, num_rows, 3, margins)
    places = np.arange(len(FACTORS))[::-1]
    every = [axes for row in grid for axes in row]
    for number, axes in enumerate(every):
        if number >= len(known):
            axes.set_visible(False)
            continue
        _bars(axes, places, found[known[number].name])
        axes.set_title(fill(known[number].title, 28))
        axes.set_yticks(places, [f.name for f in FACTORS] if number % 3 == 0 else [])
    every[0].legend(loc="lower right")
    return Exhibit(
        name,
        title,
        "Share of the variance by a factor alone (first order) and with all that it "
        "does together with others (total), with bootstrapped 95 % intervals.",
        "Horizontal bars, two for each factor, in a panel for each measure.",
        figure,
    )


def _bars(axes: Axes, places: NDArray[np.int_], rows: list[Index] | str) -> None:
    assert not isinstance(rows, str)  # of those that are known
    for shift, colour, label, value, half in (
        (0.2, _FIRST, "first order", "first_order", "first_order_half_width"),
        (-0.2, _TOTAL, "total", "total", "total_half_width"),
    ):
        axes.barh(
            places + shift,
            [getattr(row, value) for row in rows],
            0.36,
            xerr=[getattr(row, half) for row in rows],
            color=colour,
            error_kw={"elinewidth": 0.6},
            label=label,
        )
    axes.set_xlim(-0.1, 1.1)
    axes.axvline(0.0, color=FAINT, linewidth=0.5)


def _curves(aim: Aim, drawn: Sequence[Point], values: NDArray[np.float64]) -> Exhibit:
    """A measure against each factor."""
    name, title = f"curves-{aim.name}", f"{aim.title} against each factor"
    known = np.isfinite(values)
    if known.sum() < _BINS:
        return not_drawn(name, title, "Fewer than eight samples have a value.")
    figure = new_figure(FULL_WIDTH_MM, 120.0)
    margins = Margins(
        left=13.0,
        right=3.0,
        top=4.0,
        bottom=10.0,
        between_columns=5.0,
        between_rows=10.0,
    )
    grid = [axes for row in panels(figure, 3, 3, margins) for axes in row]
    for number, (axes, factor) in enumerate(zip(grid, FACTORS, strict=True)):
        x = np.array([point[number] for point in drawn])[known]
        axes.plot(x, values[known], ".", color=FAINT, markersize=1.5, alpha=0.5)
        middle, mean, half = binned(x, values[known], factor.low, factor.high)
        axes.errorbar(middle, mean, half, color=_FIRST, linewidth=1.0, capsize=1.5)
        axes.axvline(factor.usual, color=_TOTAL, linestyle="--", linewidth=0.7)
        axes.set_xlabel(f"{factor.name} [{factor.unit}]")
        axes.set_xlim(factor.low, factor.high)
        if number % 3:
            axes.set_yticklabels([])
        axes.set_ylim(*_range(values[known]))
    grid[3].set_ylabel(aim.title)
    better = "less" if aim.is_better < 0 else "more"
    caption = f"Means over pilot drivers; {better} is better."
    described = f"Nine panels of dots with a line of means: {aim.title} by factor."
    return Exhibit(name, title, caption, described, figure)


def _range(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    edge = 0.05 * (high - low) or 0.5
    return low - edge, high + edge


def binned(
    x: NDArray[np.float64], y: NDArray[np.float64], low: float, high: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Middles of the eighths of a range, means in them and 95 % half-widths."""
    edges = np.linspace(low, high, _BINS + 1)
    places = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, _BINS - 1)
    parts = [y[places == place] for place in range(_BINS)]
    mean = np.array([part.mean() if len(part) else np.nan for part in parts])
    half = np.array(
        [
            1.96 * part.std(ddof=1) / np.sqrt(len(part)) if len(part) > 1 else np.nan
            for part in parts
        ]
    )
    return (edges[:-1] + edges[1:]) / 2.0, mean, half


def _index_table(found: Indices) -> Table:
    rows = []
    for aim in AIMS:
        each = found[aim.name]
        if isinstance(each, str):
            rows.append((aim.title, *["–"] * len(FACTORS)))
        else:
            cells = (f"{row.total:.2f} ± {row.total_half_width:.2f}" for row in each)
            rows.append((aim.title, *cells))
    return Table(
        name="total-indices",
        title="Total indices",
        note="With half the width of the 95 % interval. An interval that holds 0 is a "
        "factor that these samples cannot tell from none.",
        header=("Measure", *(each.name for each in FACTORS)),
        rows=tuple(rows),
    )


def _bounds_table() -> Table:
    return Table(
        name="bounds",
        title="Factors and bounds",
        note="Uniform between the bounds.",
        header=("Factor", "Parameter", "From", "To", "Published", "Unit", "Source"),
        rows=tuple(
            (
                f.name,
                f.place,
                f"{f.low:g}",
                f"{f.high:g}",
                f"{f.usual:g}",
                f.unit,
                f.source,
            )
            for f in FACTORS
        ),
        num_labels=2,
        num_words=2,
        prose=True,
    )


def _three(low: float, high: float, usual: float) -> tuple[str, str, str]:
    return f"{low:g}", f"{high:g}", f"{usual:g}"
