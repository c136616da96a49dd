"""Distributions of manual driving beside the human ranges, as one figure."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    NORMAL,
    SMALL,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.validation.look import HUMAN, OURS, human_range, no_counts, num_bins
from costeer.validation.manual import (
    ManualDriving,
    TargetCheck,
    columns_of,
    compare,
)

_HEIGHT_MM = 122.0
_MARGINS = Margins(
    left=9.0,
    right=3.0,
    top=13.0,
    bottom=10.0,
    between_columns=11.0,
    between_rows=14.0,
)
_BINS = 28


class _Panel(NamedTuple):
    """One distribution.

    Attributes:
        table: `trials` (one value per driver) or `changes` (one per lane change).
        column: Of that table.
        factor: From SI to the unit shown.
        label: Of the axis, with its unit.
        centre: Target that the mean or median is held to.
        spread: Target that the standard deviation is held to, if any.
    """

    table: str
    column: str
    factor: Real
    label: str
    centre: str
    spread: str = ""


_PANELS = (
    _Panel("trials", "sdlp", 1.0, "SDLP [m]", "M1", "M2"),
    _Panel("trials", "swrr", 1.0, "Steering reversals [1/min]", "M3"),
    _Panel("trials", "driver_torque_rms", 1.0, "Driver torque RMS [N·m]", "M7"),
    _Panel("changes", "duration_by_speed", 1.0, "Duration (0.1 m/s) [s]", "M4", "M5"),
    _Panel("changes", "onset_to_crossing", 1.0, "Onset to crossing [s]", "M10"),
    _Panel("changes", "peak_lateral_speed", 1.0, "Peak lateral speed [m/s]", "M9"),
    _Panel(
        "changes",
        "peak_steering_angle",
        180.0 / math.pi,
        "Peak steering-wheel angle [°]",
        "M6",
    ),
    _Panel("changes", "overshoot", 1.0, "Overshoot [m]", "M8"),
)
_SHARES = {"M11": "before a\nlane change", "M12": "in 6 s of\nstraight driving"}


def population_svg(driving: ManualDriving) -> str:
    """Return the figure as SVG; the same driving gives the same text."""
    with styled():
        return svg_text(draw_population(driving), "drivers", description(driving))


def draw_population(driving: ManualDriving) -> Figure:
    """Draw what a population did in manual driving; call inside `styled`."""
    found = {comparison.target.name: comparison for comparison in compare(driving)}
    figure = new_figure(FULL_WIDTH_MM, _HEIGHT_MM)
    axes = [axis for row in panels(figure, 3, 3, _MARGINS) for axis in row]
    for axis, panel in zip(axes, _PANELS, strict=False):
        rows = driving.trials if panel.table == "trials" else driving.changes
        _distribution(axis, panel, columns_of(rows)(panel.column), found)
    _shares(axes[-1], found)
    _legend(figure, driving)
    return figure


def description(driving: ManualDriving) -> str:
    """Text for those who do not see the figure."""
    met = sum(comparison.met for comparison in compare(driving))
    return (
        f"Manual driving of {len(driving.trials)} virtual drivers: distributions of "
        f"eight measures and two shares of glances beside human ranges; {met} of "
        "twelve ranges are met."
    )


def _distribution(
    axes: Axes,
    panel: _Panel,
    values: NDArray[np.float64],
    found: dict[str, TargetCheck],
) -> None:
    """A histogram, the human range of its centre, and the population's."""
    shown = values * panel.factor
    centre = found[panel.centre]
    human_range(axes, centre.target.low, centre.target.high)
    if shown.size:
        top = max(float(np.percentile(shown, 99.5)), centre.target.high)
        count = num_bins(shown.size, _BINS)
        bins = np.linspace(min(0.0, float(shown.min())), 1.05 * top, count)
        axes.hist(
            np.clip(shown, bins[0], bins[-1]), bins=bins.tolist(), color=OURS, zorder=2
        )
        axes.axvline(centre.value, color=INK, linewidth=1.4, zorder=3)
        axes.set_xlim(bins[0], bins[-1])
    axes.set_xlabel(panel.label, size=NORMAL)
    no_counts(axes)
    axes.set_title(_words(panel, found), size=SMALL)


def _words(panel: _Panel, found: dict[str, TargetCheck]) -> str:
    """Values and human ranges in words."""
    lines = [_told(found[panel.centre])]
    if panel.spread:
        lines.append(_told(found[panel.spread]))
    return "\n".join(lines)


def _told(comparison: TargetCheck) -> str:
    target = comparison.target
    kind = target.quantity.rpartition(", ")[2].split(" ")[0]
    return (
        f"{target.name}  {kind} {comparison.value:.3g} "
        f"(human {target.low:g} to {target.high:g})"
    )


def _shares(axes: Axes, found: dict[str, TargetCheck]) -> None:
    """Shares with a glance: a bar each, on the human range."""
    for place, name in enumerate(_SHARES):
        comparison = found[name]
        target = comparison.target
        axes.bar(place, comparison.value, width=0.42, color=OURS, zorder=2)
        axes.fill_between(
            [place - 0.4, place + 0.4],
            target.low,
            target.high,
            color=HUMAN,
            alpha=0.35,
            linewidth=0.0,
            zorder=3,
        )
    axes.set_xticks(range(len(_SHARES)), list(_SHARES.values()))
    axes.set_xlim(-0.6, 1.6)
    axes.set_ylim(0.0, 100.0)
    axes.set_ylabel("Glances [%]", size=NORMAL)
    axes.set_title(
        "\n".join(
            f"{name}  {found[name].value:.3g} % "
            f"(human {found[name].target.low:g} to {found[name].target.high:g})"
            for name in _SHARES
        ),
        size=SMALL,
    )


def _legend(figure: Figure, driving: ManualDriving) -> None:
    """What colours mean, and how many drivers and lane changes there are."""
    drivers, changes = len(driving.trials), len(driving.changes)
    figure.text(
        0.012,
        0.984,
        f"{drivers} virtual drivers, {changes} lane changes, manual driving. Grey: how "
        "many; line: mean or median; green: its human range.",
        ha="left",
        va="top",
        fontsize=NORMAL,
    )
