"""Figures of a sensitivity analysis: indices, and curves to choose by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    RULE,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
)
from costeer.sensitivity.factors import AIMS, FACTORS, Aim
from costeer.sensitivity.run import Index, Point

_BINS = 8
_FIRST, _TOTAL = STRENGTH_COLOURS["strong"], STRENGTH_COLOURS["weak"]
_LOWEST, _HIGHEST = -0.1, 1.1
"""Ends of the axis of indices; what reaches further is cut off there."""

Values = NDArray[np.float64]


def shares(found: Mapping[str, list[Index] | str]) -> Exhibit:
    """First-order and total indices of every measure, a panel each."""
    name, title = "indices", "Sobol indices"
    known = {
        aim.title: rows for aim in AIMS if not isinstance(rows := found[aim.name], str)
    }
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
    every = [axes for row in panels(figure, num_rows, 3, margins) for axes in row]
    places = np.arange(len(FACTORS))[::-1]
    for number, (words, rows) in enumerate(known.items()):
        axes = every[number]
        _bars(axes, places, rows)
        axes.set_title(fill(words, 28))
        axes.set_yticks(places, [f.name for f in FACTORS] if number % 3 == 0 else [])
    for axes in every[len(known) :]:
        axes.set_visible(False)
    every[0].legend(loc="lower right")
    return Exhibit(
        name,
        title,
        "Share of the variance by a factor alone (first order) and with all that it "
        "does together with others (total), with bootstrapped 95 % intervals. An "
        "interval that reaches the edge of its panel goes on beyond it.",
        "Horizontal bars, two for each factor, in a panel for each measure.",
        figure,
    )


def _bars(axes: Axes, places: NDArray[np.int_], rows: Sequence[Index]) -> None:
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
    axes.set_xlim(_LOWEST, _HIGHEST)
    axes.axvline(0.0, color=FAINT, linewidth=0.5)


def curves(aim: Aim, drawn: Sequence[Point], values: Values) -> Exhibit:
    """A measure against each factor.

    Args:
        aim: The measure.
        drawn: All samples, in the order of `points`.
        values: Of the measure, one for each sample; NaN if missing.
    """
    name, title = f"curves-{aim.name}", f"{aim.title} against each factor"
    if np.isfinite(values).sum() < _BINS:
        return not_drawn(name, title, "Fewer than eight samples have a value.")
    figure = new_figure(FULL_WIDTH_MM, 120.0)
    margins = Margins(
        left=15.0,
        right=4.0,
        top=4.0,
        bottom=10.0,
        between_columns=6.0,
        between_rows=10.0,
    )
    grid = [axes for row in panels(figure, 3, 3, margins) for axes in row]
    found = [bins(place, drawn, values) for place in range(len(FACTORS))]
    lowest, highest = _range(found)
    for number, (axes, factor) in enumerate(zip(grid, FACTORS, strict=True)):
        _curve(axes, found[number])
        axes.axvline(factor.usual, color=_TOTAL, linestyle="--", linewidth=1.0)
        axes.set_xlabel(f"{factor.name} [{factor.unit}]")
        margin = 0.02 * (factor.high - factor.low)
        axes.set_xlim(factor.low - margin, factor.high + margin)
        axes.set_ylim(lowest, highest)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        if number % 3:
            axes.set_yticklabels([])
    grid[3].set_ylabel(aim.title)
    better = "less" if aim.is_better < 0 else "more"
    caption = f"Means over pilot drivers; {better} is better."
    described = f"Nine panels of a line with a band: {aim.title} by factor."
    return Exhibit(name, title, caption, described, figure)


def _curve(axes: Axes, found: Bins) -> None:
    """The mean with its interval, over the middle of the samples."""
    axes.fill_between(
        found.middle, found.tenth, found.ninetieth, color=RULE, linewidth=0.0
    )
    axes.errorbar(
        found.middle, found.mean, found.half, color=_FIRST, linewidth=1.0, capsize=1.5
    )


def _range(found: Sequence[Bins]) -> tuple[float, float]:
    """One axis for all panels, so that steep and flat are told apart."""
    ends = [
        np.concatenate(
            (each.tenth, each.ninetieth, each.mean - each.half, each.mean + each.half)
        )
        for each in found
    ]
    low, high = float(np.nanmin(ends)), float(np.nanmax(ends))
    edge = 0.05 * (high - low) or 0.5
    return low - edge, high + edge


class Bins(NamedTuple):
    """A measure in each eighth of a factor's range; NaN where nothing is known.

    Attributes:
        middle: Of the eighth, in the factor's unit.
        mean: Of the measure.
        half: Half-width of the mean's 95 % interval; NaN for a single draw.
        tenth: 10th percentile of the samples.
        ninetieth: 90th percentile.
    """

    middle: Values
    mean: Values
    half: Values
    tenth: Values
    ninetieth: Values


def bins(place: int, drawn: Sequence[Point], values: Values) -> Bins:
    """A measure by the factor at `place`, in eighths of its range.

    Mean and interval are over separate draws (`separate`), the percentiles over all
    samples.

    Args:
        place: Of the factor in `FACTORS`.
        drawn: All samples, in the order of `points`.
        values: Of the measure, one for each sample; NaN if missing.
    """
    factor = FACTORS[place]
    edges = np.linspace(factor.low, factor.high, _BINS + 1)

    def parts(x: Values, y: Values) -> list[Values]:
        known = np.isfinite(y)
        into = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, _BINS - 1)
        return [y[known & (into == number)] for number in range(_BINS)]

    x = np.array([point[place] for point in drawn])
    alone, every = parts(*separate(place, x, values)), parts(x, values)
    return Bins(
        middle=(edges[:-1] + edges[1:]) / 2.0,
        mean=np.array([part.mean() if len(part) else np.nan for part in alone]),
        half=np.array([_half_width(part) for part in alone]),
        tenth=np.array([np.percentile(p, 10) if len(p) else np.nan for p in every]),
        ninetieth=np.array([np.percentile(p, 90) if len(p) else np.nan for p in every]),
    )


def _half_width(part: Values) -> float:
    if len(part) < 2:
        return float("nan")
    return float(1.96 * part.std(ddof=1) / np.sqrt(len(part)))


def separate(place: int, x: Values, y: Values) -> tuple[Values, Values]:
    """Draws of one factor that do not depend on each other, and the mean at each.

    Saltelli's scheme draws two points at a time, and drives the first again with each
    coordinate of the second. So ten values of a factor in eleven are repeats, in
    samples that are nearly the same: to count each would make an interval of their
    mean far too narrow.

    Args:
        place: Of the factor.
        x: Its values, in the order of `points`, shape `(sample,)`.
        y: A measure, same shape; NaN if missing.

    Returns:
        Values of the factor and means of the measure, shape `(2 · base,)`; a mean is
        NaN where no sample has a value.
    """
    width = len(FACTORS) + 2
    rows, given = y.reshape(-1, width), x.reshape(-1, width)
    of_second = np.zeros(width, bool)
    of_second[[place + 1, width - 1]] = True
    means = [_mean_of_known(rows[:, ~of_second]), _mean_of_known(rows[:, of_second])]
    return np.concatenate((given[:, 0], given[:, -1])), np.concatenate(means)


def _mean_of_known(rows: Values) -> Values:
    """Mean of each row without its NaN; NaN if it has nothing else."""
    known = np.isfinite(rows)
    sums, counts = np.where(known, rows, 0.0).sum(axis=1), known.sum(axis=1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
