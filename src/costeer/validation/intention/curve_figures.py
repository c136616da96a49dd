"""Curves of all predictors: precision and recall, ROC, lead against false triggers."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    SMALL,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.training import metrics
from costeer.training.assessment import shown
from costeer.training.comparison import Judged
from costeer.training.operating import OperatingPoint, operating_curve
from costeer.training.verdicts import judged_samples
from costeer.validation.intention.material import Look, Material, looks, rate

CURVES, OPERATING = "curves", "operating-curve"
_FEWEST_FALSE, _MOST_FALSE = 0.004, 20.0
_SHORTEST_STEP = 0.002
"""Points of a curve that lie nearer to each other than this are not drawn."""

_DODGE = 1.06
_DOTTED = (0.0, (1.0, 1.5))
_GOAL = 2.0
"""Median lead that is asked for at the fixed rate [s]. Source: the issue's goal."""


def draw_curves(material: Material) -> Exhibit:
    """Draw precision over recall and ROC; call inside `styled`."""
    below = 15.0 + 3.6 * len(shown(material.assessment))
    figure = new_figure(FULL_WIDTH_MM, 71.0 + below)
    margins = Margins(left=13.0, right=3.0, top=7.0, bottom=below, between_columns=17.0)
    left, right = panels(figure, 1, 2, margins)[0]
    found = looks(material)
    for one in reversed(shown(material.assessment)):
        said, truth = judged_samples(one.judgement.drivers)
        edges = metrics.bin_edges(said, truth)
        positives, negatives = metrics.binned_counts(said, truth, edges)
        samples = one.judgement.facts["samples"]
        _line(left, found[one.name], *metrics.pr_curve(positives, negatives))
        left.lines[-1].set_label(_label(one.title, samples["pr_auc"]))
        _line(right, found[one.name], *metrics.roc_curve(positives, negatives))
        right.lines[-1].set_label(_label(one.title, samples["roc_auc"]))
    prevalence = material.facts["samples"]["prevalence"] or 0.0
    left.axhline(prevalence, color=FAINT, linewidth=0.7, linestyle=_DOTTED)
    right.plot([0.0, 1.0], [0.0, 1.0], color=FAINT, linewidth=0.7, linestyle=_DOTTED)
    _dress(left, ("Recall [-]", "Precision [-]"))
    _dress(right, ("False-positive rate [-]", "True-positive rate [-]"))
    panel_letter(left, "a")
    panel_letter(right, "b")
    return Exhibit(
        name=CURVES,
        title="Precision and recall, and ROC",
        caption="(a) Precision over recall and (b) true over false positives, over all "
        "thresholds, all samples of all drivers at natural prevalence, with the area "
        "under each curve. Dotted: a predictor that tells nothing.",
        description="Curves of each predictor; areas: " + _areas(material),
        figure=figure,
    )


def _areas(material: Material) -> str:
    told = []
    for one in shown(material.assessment):
        samples = one.judgement.facts["samples"]
        areas = [_told(samples[name]) for name in ("pr_auc", "roc_auc")]
        told.append(f"{one.title}: {areas[0]} and {areas[1]}")
    return "; ".join(told) + "."


def _told(area: float | None) -> str:
    return "–" if area is None else f"{area:.3f}"


def _label(title: str, area: float | None) -> str:
    return f"{title}  {_told(area)}"


def _line(
    axes: Axes, look: Look, x: NDArray[np.float64], y: NDArray[np.float64]
) -> None:
    """A curve without the points that do not show."""
    rows = _thinned(x, y)
    axes.plot(
        x[rows], y[rows], color=look.colour, linestyle=look.line, linewidth=look.width
    )


def _thinned(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int64]:
    """Rows that are some way from the last one that is kept."""
    here = np.floor(np.stack([x, y]) / _SHORTEST_STEP)
    moved = np.any(np.diff(here, axis=1, prepend=-1.0) != 0.0, axis=0)
    moved[-1] = True
    drawn = np.isfinite(x) & np.isfinite(y)
    return np.flatnonzero(moved & drawn)


def _dress(axes: Axes, names: tuple[str, str]) -> None:
    """Names and limits of a panel; a legend below it, the first predictor on top."""
    axes.set_xlabel(names[0])
    axes.set_ylabel(names[1])
    axes.set_xlim(0.0, 1.005)
    axes.set_ylim(0.0, 1.015)
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(
        handles[::-1],
        labels[::-1],
        loc="upper left",
        bbox_to_anchor=(0.0, -0.14),
        handlelength=2.6,
        title="Area under the curve",
        alignment="left",
        title_fontsize=SMALL,
    )


def draw_operating(material: Material) -> Exhibit:
    """Draw lead time against false triggers; call inside `styled`."""
    figure = new_figure(FULL_WIDTH_MM, 84.0)
    margins = Margins(left=13.0, right=52.0, top=7.0, bottom=10.0)
    ((axes,),) = panels(figure, 1, 1, margins)
    found = looks(material)
    rows = shown(material.assessment)
    for place, one in reversed(list(enumerate(rows))):
        # Side by side on the log axis, so that intervals do not hide each other.
        beside = _DODGE ** (place - (len(rows) - 1) / 2.0)
        _trade(axes, found[one.name], one, beside)
    allowed = rate(material)
    axes.axvline(allowed, color=FAINT, linewidth=0.7, linestyle=_DOTTED, zorder=0.5)
    axes.axhline(_GOAL, color=FAINT, linewidth=0.7, linestyle=_DOTTED, zorder=0.5)
    axes.annotate(
        f"{allowed:g} per km",
        xy=(allowed, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(2.0, 1.0),
        textcoords="offset points",
        fontsize=SMALL,
        color=INK,
        va="bottom",
        ha="center",
    )
    _trade_axes(axes, figure)
    return Exhibit(
        name=OPERATING,
        title="Lead time against false triggers",
        caption="Median time from the first trigger to the crossing against false "
        "triggers per kilometre, over all thresholds; missed crossings count as 0 s. A "
        "point shows the largest lead that any threshold with at most so many false "
        f"triggers gives. Circles: at {allowed:g} per km (moved sideways to be told "
        "apart), with 95 % intervals over drivers; dotted: that rate, and a lead of "
        f"{_GOAL:g} s. What lies left of the axis, no false trigger at all, is drawn "
        "at its edge.",
        description="Lead at the rate: " + _leads(material),
        figure=figure,
    )


def _leads(material: Material) -> str:
    told = []
    for one in shown(material.assessment):
        lead = one.judgement.facts["at_false_rate"].get("lead_time_median")
        told.append(f"{one.title} " + ("none" if lead is None else f"{lead:.2f} s"))
    return "; ".join(told) + "."


def frontier(points: list[OperatingPoint]) -> tuple[list[float], list[float]]:
    """Largest lead [s] at no more than each rate of false triggers [1/km]."""
    rates, leads, best = [], [], -1.0
    for point in sorted(points, key=lambda p: (p.false_per_km, -p.lead_time_median)):
        if point.lead_time_median > best:
            best = point.lead_time_median
            rates.append(point.false_per_km)
            leads.append(best)
    return rates, leads


def _trade(axes: Axes, look: Look, one: Judged, beside: float) -> None:
    """One predictor's curve, and its point at the rate with the interval."""
    rates, leads = frontier(operating_curve(one.judgement.operating))
    shown_rates = np.maximum(rates, _FEWEST_FALSE)
    axes.step(
        np.append(shown_rates, _MOST_FALSE),
        np.append(leads, leads[-1:] or [np.nan]),
        where="post",
        color=look.colour,
        linestyle=look.line,
        linewidth=look.width,
        label=one.title,
    )
    facts = one.judgement.facts
    lead = facts["at_false_rate"].get("lead_time_median")
    ends = facts["interval_95"].get("lead_time_at_false_rate")
    if lead is None or len(one.judgement.drivers) < 2 or ends is None:
        return
    place = facts["false_per_km_allowed"] * beside
    axes.plot([place] * 2, ends, color=look.colour, linewidth=0.9, zorder=2.5)
    axes.plot(
        place, lead, "o", ms=4.5, color=look.colour, mec="white", mew=0.6, zorder=3.0
    )


def _trade_axes(axes: Axes, figure: Figure) -> None:
    axes.set_xscale("log")
    axes.set_xlim(_FEWEST_FALSE, _MOST_FALSE)
    ticks = (0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 20.0)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(0.0, 5.05)
    axes.set_xlabel("False triggers [1/km]")
    axes.set_ylabel("Median lead before the crossing [s]")
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(
        handles[::-1],
        labels[::-1],
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),
        handlelength=2.6,
    )
