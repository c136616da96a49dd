"""A fitted driver in the population: each estimate on the spread between drivers."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from costeer.drivers.population import SECOND, participant_driver
from costeer.identification.fit import DriverFit
from costeer.identification.parameters import Estimate, value_of
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    NORMAL,
    SMALL,
    Margins,
    interval_bar,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.pages.units import shown
from costeer.validation.look import HUMAN, OURS, no_counts
from costeer.validation.populations import population_told

POPULATION_SEED = 1
NUM_DRIVERS = 500
"""Drivers behind the grey histograms."""

_COLUMNS = 4
_ROW_MM = 30.0
_BINS = 24


def fit_svg(fit: DriverFit, suggested_speed: float) -> str:
    """Return the figure as SVG; the same fit gives the same text.

    Args:
        fit: To draw.
        suggested_speed: To the population beside it [m/s].
    """
    with styled():
        return svg_text(draw_fit(fit, suggested_speed), "fit", description(fit))


def description(fit: DriverFit) -> str:
    """Text for those who do not see the figure."""
    estimates = map(_as_shown, fit.estimates)
    return (
        f"{len(fit.estimates)} estimates of a fitted driver with their 95 % intervals, "
        f"each on the histogram of {NUM_DRIVERS} virtual drivers: "
        + ", ".join(f"{e.name} {e.value:.3g} {e.unit}" for e in estimates)
        + "."
    )


def draw_fit(fit: DriverFit, suggested_speed: float) -> Figure:
    """Draw a panel for each estimate; call inside `styled`.

    Args:
        fit: To draw.
        suggested_speed: To the population beside it [m/s].
    """
    rows = -(-len(fit.estimates) // _COLUMNS)
    height = 10.0 + rows * _ROW_MM
    figure = new_figure(FULL_WIDTH_MM, height)
    figure.text(
        2.0 / FULL_WIDTH_MM,
        1.0 - 1.5 / height,
        f"Grey: {population_told(SECOND)} of virtual drivers; green: the "
        "fitted driver, with the 95 % interval.",
        ha="left",
        va="top",
        fontsize=NORMAL,
    )
    margins = Margins(
        left=4.0,
        right=4.0,
        top=10.0,
        bottom=9.0,
        between_columns=6.0,
        between_rows=13.0,
    )
    axes = [a for row in panels(figure, rows, _COLUMNS, margins) for a in row]
    drivers = [
        participant_driver(POPULATION_SEED, number, suggested_speed, SECOND)
        for number in range(1, NUM_DRIVERS + 1)
    ]
    for axis, estimate in zip(axes, fit.estimates, strict=False):
        values = np.array([value_of(driver, estimate.name) for driver in drivers])
        factor = shown(estimate.unit).factor
        _panel(axis, _as_shown(estimate), factor * values)
    for axis in axes[len(fit.estimates) :]:
        axis.set_visible(False)
    return figure


def _as_shown(estimate: Estimate) -> Estimate:
    """The estimate in people's units."""
    unit, factor = shown(estimate.unit)
    return estimate._replace(
        unit=unit,
        value=factor * estimate.value,
        low=factor * estimate.low,
        high=factor * estimate.high,
    )


def _panel(axes: Axes, estimate: Estimate, values: NDArray[np.float64]) -> None:
    """One estimate on the values of the population."""
    low = min(float(values.min()), estimate.low)
    high = max(float(values.max()), estimate.high)
    room = 0.05 * (high - low)
    axes.set_xlim(low - room, high + room)
    if np.ptp(values) > 0.0:
        counts, *_ = axes.hist(values, bins=_BINS, color=OURS, zorder=1)
        top = float(np.max(counts))
    else:
        axes.axvline(float(values[0]), color=OURS, linewidth=2.0, zorder=1)
        top = 1.0
    axes.set_ylim(0.0, 1.25 * top)
    place = (estimate.value, 1.1 * top)
    interval_bar(
        axes,
        place,
        False,
        estimate.value - estimate.low,
        estimate.high - estimate.value,
    )
    axes.plot(*place, "o", color=HUMAN, markersize=4.0, markeredgecolor=INK, zorder=4)
    axes.locator_params(axis="x", nbins=4)
    axes.set_title(estimate.name.replace("_", " ").replace(".", ": "), size=SMALL)
    axes.set_xlabel(f"[{estimate.unit.replace('-', '–')}]", size=SMALL, labelpad=1.0)
    no_counts(axes)
