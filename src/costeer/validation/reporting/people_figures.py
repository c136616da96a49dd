"""Figures of people beside virtual drivers: a small panel for each quantity."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from costeer.base.array import Real
from costeer.pages.exhibit import Exhibit
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FAINT,
    FULL_WIDTH_MM,
    SMALL,
    Margins,
    new_figure,
    panels,
)
from costeer.validation.look import HUMAN, LINE, human_range
from costeer.validation.people.compare import Spectra
from costeer.validation.people.findings import (
    SHARE,
    RealComparison,
    Values,
    known,
    people_value,
    value,
)
from costeer.validation.reporting.words import real_verdict_told, short

SPECTRA = "drift-spectra"

_COLUMNS, _PAIRED = 3, 2
_ROW_MM = 41.0
_WRAP = 38
_QUANTILES = (0.1, 0.5, 0.9)
_SHOWN = (0.5, 99.5)
"""Percentiles between which distributions are shown."""

_NORMAL_95 = 1.96
_TICKS = (0.05, 0.1, 0.2, 0.5, 1.0)


class Group(NamedTuple):
    """Quantities that stand in one figure.

    Attributes:
        name: Stem of its file.
        title: In a few words.
        sets: Recordings whose quantities they are.
    """

    name: str
    title: str
    sets: frozenset[str]


GROUPS = (
    Group(
        "people-lane-changes",
        "Lane changes of people and of virtual drivers",
        frozenset({"ngsim_lc", "gps_lane_changes"}),
    ),
    Group(
        "people-glances",
        "Glances of people and of virtual drivers",
        frozenset({"brain4cars_head"}),
    ),
    Group(
        "people-corrections",
        "Corrections of a heading error by people and by virtual drivers",
        frozenset({"leeds_steering_onset"}),
    ),
    Group(
        "people-lane-keeping",
        "Lane keeping of people and of virtual drivers",
        frozenset({"r3_driving", "ngsim_i80_following"}),
    ),
    Group(
        "people-steering",
        "Steering of people and of virtual drivers",
        frozenset({"udacity_steering"}),
    ),
)
OTHERS = Group("people-others", "More of people and of virtual drivers", frozenset())


def group_of(comparison: RealComparison) -> Group:
    """The figure in which a quantity stands: by the set that its source names."""
    for group in GROUPS:
        if any(f"({name})" in comparison.source for name in group.sets):
            return group
    return OTHERS


def draw_people(comparisons: Sequence[RealComparison]) -> Iterator[Exhibit]:
    """Draw a figure for each group that has quantities; call inside `styled`."""
    for group in (*GROUPS, OTHERS):
        own = [each for each in comparisons if group_of(each) == group]
        if own:
            yield Exhibit(
                name=group.name,
                title=group.title,
                caption=_CAPTION,
                description=_description(own),
                figure=_figure(own),
            )


_CAPTION = "Green: people; black: virtual drivers; green ground: accepted range."

HOW_TO_READ = (
    "In the figures a curve is the share of values up to the one below, its dot the "
    "median; where the quantity is itself a share, the dot is that share and the line "
    "its 95 % interval (Wilson). Green is people, black the virtual drivers in manual "
    "driving, the green ground the range that the drivers' median or share is held "
    "to; green crosses are published 10, 50 and 90 % where recordings are absent."
)


def _description(comparisons: Sequence[RealComparison]) -> str:
    """The panels in words."""
    told = [
        f"{each.name}, {each.quantity}: people {short(people_value(each))}, virtual "
        f"drivers {short(value(each))} {each.unit}, {real_verdict_told(each)}"
        for each in comparisons
    ]
    return "; ".join(told) + "."


def _figure(comparisons: Sequence[RealComparison]) -> Figure:
    columns = _PAIRED if len(comparisons) in (_PAIRED, 2 * _PAIRED) else _COLUMNS
    rows = -(-len(comparisons) // columns)
    figure = new_figure(FULL_WIDTH_MM, 4.0 + rows * _ROW_MM)
    margins = Margins(
        left=11.0,
        right=3.0,
        top=11.0,
        bottom=9.0,
        between_columns=12.0,
        between_rows=20.0,
    )
    axes = [a for row in panels(figure, rows, columns, margins) for a in row]
    for axis, each in zip(axes, comparisons, strict=False):
        (_share_panel if each.statistic == SHARE else _value_panel)(axis, each)
        axis.set_title(_title(each), size=SMALL, linespacing=1.25)
        axis.set_xlabel(f"[{each.unit}]  {_set_names(each)}", size=SMALL, labelpad=1.5)
    for axis in axes[len(comparisons) :]:
        axis.set_visible(False)
    return figure


def _set_names(comparison: RealComparison) -> str:
    """The source without the names of folders."""
    return re.sub(r" \([^)]*\)", "", comparison.source)


def _title(comparison: RealComparison) -> str:
    text = f"{comparison.name}  {comparison.quantity}"
    return "\n".join(textwrap.wrap(text, _WRAP, max_lines=3, placeholder=" …"))


def _value_panel(axes: Axes, comparison: RealComparison) -> None:
    """Cumulative shares of people and drivers over the accepted range."""
    human_range(axes, comparison.low, comparison.high)
    people, drivers = known(comparison.people), known(comparison.drivers)
    for values, colour in ((people, HUMAN), (drivers, LINE)):
        _cumulative(axes, values, colour)
    published = np.array(comparison.published)
    if not people.size:
        axes.plot(published, _QUANTILES, "+", color=HUMAN, markersize=6.0, mew=1.2)
    axes.set_xlim(*_extent(comparison))
    axes.set_ylim(0.0, 1.02)
    axes.set_yticks([0.0, 0.5, 1.0], ["0", "½", "1"])
    axes.locator_params(axis="x", nbins=6)


def _cumulative(axes: Axes, values: Values, colour: str) -> None:
    """Steps to 1 and a mark at the median; one value is a line by itself."""
    if values.size > 1:
        shares = np.arange(1, values.size + 1) / values.size
        ends = [float(np.sort(values)[0])]
        x = np.concatenate([ends, np.sort(values)])
        axes.step(x, np.concatenate([[0.0], shares]), where="post", color=colour)
        axes.plot(float(np.median(values)), 0.5, "o", color=colour, markersize=3.0)
    elif values.size:
        axes.axvline(float(values[0]), color=colour)


def _extent(comparison: RealComparison) -> tuple[Real, Real]:
    """From the smallest to the largest of what is shown, with some room."""
    ends: list[Real] = [comparison.low, comparison.high, *comparison.published]
    for values in (known(comparison.people), known(comparison.drivers)):
        if values.size:
            ends += np.percentile(values, _SHOWN).tolist()
    finite = [end for end in ends if math.isfinite(end)] or [0.0, 1.0]
    low, high = min(finite), max(finite)
    room = 0.06 * (high - low) or 0.5 * abs(high) or 0.5
    least = 0.0 if low >= 0.0 else low - room
    return max(low - room, least), high + room


def _share_panel(axes: Axes, comparison: RealComparison) -> None:
    """Two shares with their intervals, people above drivers."""
    human_range(axes, comparison.low, comparison.high)
    sides = ((1.0, comparison.people, HUMAN), (0.0, comparison.drivers, LINE))
    for height, values, colour in sides:
        _share(axes, height, known(values), colour)
    if not known(comparison.people).size:
        axes.plot(comparison.published[1], 1.0, "+", color=HUMAN, ms=6.0, mew=1.2)
    axes.set_yticks([0.0, 1.0], ["drivers", "people"])
    axes.tick_params(axis="y", length=0.0)
    axes.set_ylim(-0.7, 1.7)
    axes.set_xlim(0.0, 100.0)


def _share(axes: Axes, height: Real, values: Values, colour: str) -> None:
    """One share; nothing without values."""
    if values.size:
        share = float(values.mean())
        low, high = wilson(share / 100.0, values.size)
        axes.plot([100.0 * low, 100.0 * high], [height] * 2, color=colour, lw=1.4)
        axes.plot(share, height, "o", color=colour, markersize=4.0)


def wilson(share: Real, amount: int) -> tuple[Real, Real]:
    """95 % interval of a share (Wilson 1927).

    Args:
        share: Observed [-].
        amount: Of how many.
    """
    squared = _NORMAL_95**2
    middle = share + squared / (2.0 * amount)
    spread = math.sqrt(share * (1.0 - share) / amount + squared / (4.0 * amount**2))
    below = 1.0 + squared / amount
    return (
        (middle - _NORMAL_95 * spread) / below,
        (middle + _NORMAL_95 * spread) / below,
    )


def draw_spectra(spectra: Spectra) -> Exhibit:
    """Draw the spectra of lane position; call inside `styled`."""
    figure = new_figure(COLUMN_WIDTH_MM, 68.0)
    margins = Margins(left=15.0, right=3.0, top=4.0, bottom=10.0)
    ((axes,),) = panels(figure, 1, 1, margins)
    kinds = (
        (spectra.highway, HUMAN, "-", "people, instrumented car"),
        (spectra.following, HUMAN, "--", "people, filmed from above"),
        (spectra.drivers, LINE, "-", "virtual drivers"),
    )
    for density, colour, dashes, label in kinds:
        if density.size:
            shown = spectra.frequency > 0.0
            axes.loglog(
                spectra.frequency[shown],
                density[shown],
                dashes,
                color=colour,
                label=label,
            )
    axes.set_xticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
    axes.minorticks_off()
    axes.set_xlabel("Frequency [Hz]")
    axes.set_ylabel("Power of lane position [m²/Hz]")
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.4)
    axes.legend(loc="lower left")
    return Exhibit(
        name=SPECTRA,
        title="Spectra of the drift in the lane",
        caption="Mean power spectra of the lane position in windows of 20 s of lane "
        "keeping. The filmed vehicles carry the error of the film.",
        description="Power spectra of lane position over frequency, falling, of "
        "virtual drivers and of people where their recordings are present.",
        figure=figure,
    )
