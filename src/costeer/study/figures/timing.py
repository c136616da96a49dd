"""Inconsistencies by condition, and when in a lane change they come: Fig. 22."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from costeer.methods.conditions import MANUAL, STRENGTHS
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    STRENGTH_COLOURS,
    Margins,
    interval_bar,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.disputes import FARTHEST, Dispute
from costeer.study.figures.colours import condition_colour
from costeer.study.material import StudyMaterial, conditions_driven
from costeer.study.quantities import half_width

NAME = "inconsistency-timing"
TITLE = "Inconsistencies by condition, and when they come"

_BINS = np.arange(-FARTHEST, FARTHEST + 0.5, 1.0)
_SHARES = np.linspace(0.0, 100.0, 11)


def draw(material: StudyMaterial, found: Sequence[Dispute]) -> Exhibit:
    """Draw inconsistencies per lane change, and their time in it.

    Args:
        material: The study.
        found: Its inconsistencies.
    """
    if not found:
        why = "No verdict was inconsistent in any trial of this study."
        return not_drawn(NAME, TITLE, why)
    figure = new_figure(FULL_WIDTH_MM, 60.0)
    margins = Margins(left=25.0, right=4.0, top=8.0, bottom=10.0, between_columns=15.0)
    left, middle, right = panels(figure, 1, 3, margins, (0.8, 1.2, 0.8))[0]
    _per_change(left, material)
    _histogram(middle, found, "from_crossing", 1.0, _BINS)
    _histogram(right, found, "share", 100.0, _SHARES)
    middle.axvline(0.0, color=FAINT, linewidth=0.7, linestyle=(0, (6, 4)))
    middle.set_xlabel("Time from crossing [s]")
    middle.set_ylabel("Inconsistencies [–]")
    right.set_xlabel("Share of the lane change [%]")
    right.set_ylabel("Inconsistencies [–]")
    middle.legend(loc="upper left")
    for axes, letter in zip((left, middle, right), "abc", strict=True):
        panel_letter(axes, letter)
    return Exhibit(NAME, TITLE, _caption(found), _DESCRIPTION, figure)


_DESCRIPTION = (
    "Left: bars of inconsistencies per lane change for each assisted condition. Middle "
    "and right: histograms of the time from the crossing, and of the share of the lane "
    "change that had passed, for strong and weak."
)


def _caption(found: Sequence[Dispute]) -> str:
    far = sum(bool(np.isnan(each.from_crossing)) for each in found)
    outside = sum(bool(np.isnan(each.share)) for each in found)
    return (
        "(a) Inconsistencies in a lane change, means over participants with 95 % "
        "intervals, cut at zero. (b) Time of the first inconsistent verdict from the "
        f"nearest crossing of the lane line; {far} of {len(found)} were farther than "
        f"{FARTHEST:g} s from any. (c) Share of the lane change, by yaw, that had "
        f"passed; {outside} began outside of one."
    )


def _per_change(axes: Axes, material: StudyMaterial) -> None:
    names = [name for name in conditions_driven(material) if name != MANUAL]
    changes, reach = material.lane_changes, 0.0
    for place, name in enumerate(names):
        own = changes[changes["condition"] == name].groupby("participant")
        values = own["num_inconsistencies"].mean().dropna().to_numpy(np.float64)
        if not values.size:
            continue
        mean, half = float(values.mean()), half_width(values)
        reach = max(reach, mean, np.nan_to_num(mean + half))
        (bar,) = axes.barh(place, mean, height=0.74, color=condition_colour(name))
        ends = {"low": (mean - half,), "high": (mean + half,)} if half > 0.0 else {}
        say(bar, name, across=True, **ends)
        if np.isfinite(half):
            interval_bar(axes, (mean, place), False, min(half, mean), half)
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.08 * reach if reach > 0.0 else 1.0)
    axes.set_xlabel("Per lane change [–]")


def _histogram(
    axes: Axes, found: Sequence[Dispute], field: str, factor: float, bins: np.ndarray
) -> None:
    """Stacked counts, strong below weak."""
    values = {
        strength: [
            factor * getattr(each, field)
            for each in found
            if each.condition.startswith(strength) and np.isfinite(getattr(each, field))
        ]
        for strength in STRENGTHS
    }
    axes.hist(
        list(values.values()),
        bins=bins.tolist(),
        stacked=True,
        color=[STRENGTH_COLOURS[strength] for strength in values],
        label=list(values),
        rwidth=0.92,
    )
    for place, bar in enumerate(axes.patches):
        say(bar, list(values)[place // (len(bins) - 1)])
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
