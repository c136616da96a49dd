"""A population as one figure: how its parameters are spread and go together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.population import USUAL, Population
from costeer.drivers.traits import FACTORS, Traits, correlation_matrix
from costeer.pages.numerals import number
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    SMALL,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.pages.units import shown
from costeer.validation.drawn import differing, drawn_correlations
from costeer.validation.look import OURS, no_counts, num_bins
from costeer.validation.populations import population_told

_COLUMNS = 5
_ROW_MM = 22.0
_CORRELATIONS_MM = 110.0
_BINS = 24
_LEAST_NAMED = 0.005
"""Correlations below this have no number in their cell [-]."""

_TEXT_ON_DARK = 0.45
_LOW, _HIGH = STRENGTH_COLOURS["weak"], STRENGTH_COLOURS["strong"]
"""Colours of negative and of positive correlations."""


class Drawn(NamedTuple):
    """Drivers as they are drawn.

    Attributes:
        seed: Of the population.
        drivers: Of `drawn_drivers`.
        population: That they are drawn from.
    """

    seed: int
    drivers: list[dict[str, Real]]
    population: Population = USUAL


def population_parameters_svg(drawn: Drawn) -> str:
    """Return the figure as SVG; the same population gives the same text."""
    with styled():
        figure = draw_parameters(drawn)
        return svg_text(figure, "population", parameters_description(drawn))


def parameters_description(drawn: Drawn) -> str:
    """Text for those who do not see the figure."""
    factors = "; ".join(
        f"{factor.name}: " + ", ".join(map(spoken, factor.loadings))
        for factor in FACTORS
    )
    return (
        f"Histograms of the {len(differing(drawn.population))} parameters that differ "
        f"between {len(drawn.drivers)} virtual drivers, and correlations of the "
        f"{len(Traits._fields)} traits behind them. Traits that go together: "
        f"{factors}."
    )


def spoken(name: str) -> str:
    """A name of the code in words."""
    return name.replace("_", " ")


def draw_parameters(drawn: Drawn) -> Figure:
    """Draw histograms above correlations and loadings; call inside `styled`."""
    rows = -(-len(differing(drawn.population)) // _COLUMNS)
    spread_mm = 9.0 + rows * _ROW_MM
    height = spread_mm + _CORRELATIONS_MM
    figure = new_figure(FULL_WIDTH_MM, height)
    _heading(figure, drawn, height)
    _histograms(figure, drawn, rows, height - spread_mm)
    margins = Margins(
        left=24.0, right=3.0, top=spread_mm + 9.0, bottom=22.0, between_columns=25.0
    )
    ((matrix, bars),) = panels(figure, 1, 2, margins, (2.2, 1.0))
    _correlations(matrix, drawn)
    _loadings(bars)
    return figure


def _heading(figure: Figure, drawn: Drawn, height: Real) -> None:
    figure.text(
        2.0 / FULL_WIDTH_MM,
        1.0 - 1.5 / height,
        f"{population_told(drawn.population).capitalize()}, seed {drawn.seed}, "
        f"{len(drawn.drivers)} virtual drivers. Histograms: how many drivers have "
        "that value; line: median.",
        ha="left",
        va="top",
    )


def _histograms(figure: Figure, drawn: Drawn, rows: int, below_mm: Real) -> None:
    margins = Margins(
        left=3.0,
        right=3.0,
        top=9.0,
        bottom=below_mm + 8.0,
        between_columns=5.0,
        between_rows=11.5,
    )
    axes = [a for row in panels(figure, rows, _COLUMNS, margins) for a in row]
    units = differing(drawn.population)
    for axis, (name, unit) in zip(axes, units.items(), strict=False):
        unit, factor = shown(unit)
        values = factor * np.array([driver[name] for driver in drawn.drivers])
        _histogram(axis, values)
        axis.set_title(spoken(name).replace(".", ": "), size=SMALL, pad=2.0)
        axis.set_xlabel(f"[{unit}]" if unit != "-" else "[–]", size=SMALL, labelpad=1.0)
    for axis in axes[len(units) :]:
        axis.set_visible(False)


def _histogram(axes: Axes, values: NDArray[np.float64]) -> None:
    bins = num_bins(values.size, _BINS)
    edges = np.linspace(values.min(), values.max(), bins + 1)
    axes.hist(values, bins=edges.tolist() if np.ptp(values) > 0.0 else 1, color=OURS)
    axes.axvline(float(np.median(values)), color=INK, linewidth=1.2)
    axes.locator_params(axis="x", nbins=3)
    no_counts(axes)


def _correlations(axes: Axes, drawn: Drawn) -> None:
    """As specified below the diagonal, as drawn above it."""
    from matplotlib.colors import LinearSegmentedColormap

    names = [spoken(name) for name in Traits._fields]
    given = correlation_matrix()
    found = drawn_correlations(drawn.seed, len(drawn.drivers))
    shown = np.tril(given, -1) + np.triu(found, 1)
    np.fill_diagonal(shown, np.nan)
    colours = LinearSegmentedColormap.from_list("both", [_LOW, "white", _HIGH])
    axes.imshow(shown, cmap=colours, vmin=-0.7, vmax=0.7, aspect="equal")
    for row, column in np.ndindex(shown.shape):
        value = float(shown[row, column])
        if row > column and abs(value) >= _LEAST_NAMED:
            _cell_text(axes, row, column, value)
    places = range(len(names))
    axes.set_xticks(places, names, rotation=90.0)
    axes.set_yticks(places, names)
    axes.tick_params(length=0.0)
    axes.plot([-0.5, len(names) - 0.5], [-0.5, len(names) - 0.5], color=RULE, lw=0.6)
    axes.spines[["top", "right"]].set_visible(True)
    axes.set_title(
        "Correlations of traits. Below the diagonal: as given;\n"
        "above: among these drivers (the rest is chance)",
        size=SMALL,
    )


def _cell_text(axes: Axes, row: int, column: int, value: Real) -> None:
    axes.text(
        column,
        row,
        number(value, 2).replace("0.", "."),
        ha="center",
        va="center",
        fontsize=SMALL - 2.0,
        color="white" if abs(value) > _TEXT_ON_DARK else INK,
    )


def _loadings(axes: Axes) -> None:
    """Each trait's correlation with its factor, factors one below the other."""
    place, ticks = 0.0, []
    for factor in FACTORS:
        axes.text(-0.98, place, factor.name, fontweight="bold", va="center", size=SMALL)
        place += 1.0
        for name, loading in factor.loadings.items():
            colour = _HIGH if loading > 0.0 else _LOW
            axes.barh(place, loading, height=0.62, color=colour)
            ticks.append((place, spoken(name)))
            place += 1.0
        place += 0.6
    axes.axvline(0.0, color=INK, linewidth=0.6)
    axes.set_yticks(*map(list, zip(*ticks, strict=True)))
    axes.tick_params(axis="y", length=0.0)
    axes.spines["left"].set_visible(False)
    axes.set_ylim(place - 0.6, -0.8)
    axes.set_xlim(-1.0, 1.0)
    axes.set_xlabel("Correlation with the factor [–]")
    axes.set_title("Factors behind the traits", size=SMALL)
