"""Lead times of crossings and the spread over drivers, predictor by predictor."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FAINT,
    FULL_WIDTH_MM,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.training import metrics
from costeer.training.assessment import shown
from costeer.training.comparison import Judged
from costeer.training.verdicts import judged_samples
from costeer.validation.intention.material import (
    Look,
    Material,
    leads_at_rate,
    looks,
    place_at_rate,
    rate,
)

LEADS, SPREAD = "lead-times", "drivers"
_LONGEST = 5.0
_HORIZON = 3.0
_MOST_DOTS = 80
_GOLDEN = 0.618034
"""Multiples of it spread evenly between whole numbers."""
_DOTTED = (0.0, (1.0, 1.5))


def draw_leads(material: Material) -> Exhibit:
    """Draw how many crossings are announced how early; call inside `styled`."""
    title = "Lead times at the fixed rate of false triggers"
    rows = [one for one in shown(material.assessment) if leads_at_rate(one).size]
    if not rows:
        lacking = "No threshold keeps to the rate, or nobody crossed."
        return not_drawn(LEADS, title, lacking)
    figure = new_figure(COLUMN_WIDTH_MM, 88.0)
    margins = Margins(left=14.0, right=3.0, top=5.0 + 3.4 * len(rows))
    ((axes,),) = panels(figure, 1, 1, margins)
    found, at = looks(material), np.linspace(0.0, _LONGEST, 301)
    for one in reversed(rows):
        leads, look = leads_at_rate(one), found[one.name]
        share = [100.0 * np.mean((leads >= t) & (leads > 0.0)) for t in at]
        axes.plot(
            at,
            share,
            color=look.colour,
            linestyle=look.line,
            linewidth=look.width,
            label=f"{one.title}, {np.median(leads):.2f} s",
        )
    _announced_axes(axes)
    return Exhibit(
        name=LEADS,
        title=title,
        caption="Share of the crossings that were announced at least so long before, "
        f"at the threshold with the largest median lead of at most {rate(material):g} "
        "false triggers per km; with the medians. Dotted: the 3 s that are asked for.",
        description="; ".join(f"{o.title}: {_told(leads_at_rate(o))}" for o in rows),
        figure=figure,
    )


def _announced_axes(axes: Axes) -> None:
    """Names, limits and a legend above the panel, the first predictor on top."""
    axes.axvline(_HORIZON, color=FAINT, linewidth=0.7, linestyle=_DOTTED)
    axes.set_xlim(0.0, _LONGEST)
    axes.set_ylim(0.0, 102.0)
    axes.set_xlabel("Time before the crossing [s]")
    axes.set_ylabel("Crossings announced [%]")
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(
        handles[::-1],
        labels[::-1],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        handlelength=2.6,
    )


def _told(leads: NDArray[np.float64]) -> str:
    low, median, high = np.percentile(leads, [10, 50, 90])
    return f"median {median:.2f} s, 10 to 90 % {low:.2f} to {high:.2f} s"


def draw_spread(material: Material) -> Exhibit:
    """Draw each driver's scores, one row for each predictor; call inside `styled`."""
    title = "Spread over drivers"
    rows = shown(material.assessment)
    if len(rows[0].judgement.drivers) < 2:
        return not_drawn(SPREAD, title, "There is one driver only.")
    figure = new_figure(FULL_WIDTH_MM, 17.0 + 8.5 * len(rows))
    margins = Margins(left=39.0, right=3.0, top=6.0, bottom=9.0, between_columns=6.0)
    axes = panels(figure, 1, 3, margins)[0]
    found = looks(material)
    for place, one in enumerate(rows):
        for panel, values in zip(axes, driver_scores(one), strict=True):
            _row(panel, place, values, found[one.name])
    names = (
        "Area, precision and recall [-]",
        "Median lead [s]",
        "False triggers [1/km]",
    )
    for panel, name, letter in zip(axes, names, "abc", strict=True):
        panel.set_xlabel(name)
        panel.set_ylim(len(rows) - 0.5, -0.5)
        panel.set_yticks(range(len(rows)), [])
        panel.tick_params(axis="y", length=0.0)
        panel_letter(panel, letter)
    axes[0].set_yticklabels([one.title for one in rows])
    axes[0].set_xlim(axes[0].get_xlim()[0] - 0.02, 1.02)
    axes[1].set_xlim(-0.1, _LONGEST)
    largest = axes[2].get_xlim()[1]
    axes[2].set_xlim(-0.03 * largest, 1.05 * largest)
    return Exhibit(
        name=SPREAD,
        title=title,
        caption="Each dot is a driver, the bar their median, the line 10 to 90 %; "
        f"with more than {_MOST_DOTS} drivers there are no dots. (b) and (c) at the "
        "threshold with the largest median lead of all drivers together at no more "
        f"than {rate(material):g} false triggers per km.",
        description="Dots of drivers in a row for each predictor.",
        figure=figure,
    )


def driver_scores(one: Judged) -> tuple[NDArray[np.float64], ...]:
    """Area, median lead and false triggers per km of each driver, NaN if unknown."""
    drivers = one.judgement.drivers
    nothing = np.full(len(drivers), np.nan)
    areas = np.array([_area(one, place) for place in range(len(drivers))])
    place = place_at_rate(one)
    if place is None:
        return areas, nothing, nothing
    counts = one.judgement.operating
    with np.errstate(invalid="ignore", divide="ignore"):
        false = counts.false[place] / counts.kilometres
    own = [counts.leads[place][counts.driver == k] for k in range(len(drivers))]
    leads = np.array([np.median(each) if len(each) else np.nan for each in own])
    return areas, leads, false


def _area(one: Judged, place: int) -> float:
    said, truth = judged_samples([one.judgement.drivers[place]])
    return (
        float(metrics.pr_auc(*metrics.level_counts(said, truth)))
        if len(said)
        else np.nan
    )


def _row(axes: Axes, place: int, values: NDArray[np.float64], look: Look) -> None:
    known = values[np.isfinite(values)]
    if not known.size:
        return
    if known.size <= _MOST_DOTS:
        # Equal values must not hide each other: dots stand above one another.
        heights = place + 0.5 * (_GOLDEN * np.arange(known.size) % 1.0 - 0.5)
        axes.plot(
            np.sort(known), heights, "o", ms=2.4, mew=0.0, color=look.colour, alpha=0.55
        )
    low, median, high = np.percentile(known, [10, 50, 90])
    axes.plot([low, high], [place] * 2, color=look.colour, linewidth=0.8)
    axes.plot([median] * 2, [place - 0.36, place + 0.36], color=look.colour, lw=1.6)
