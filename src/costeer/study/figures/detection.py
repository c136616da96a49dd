"""Detection of the intention: how early, how often in vain, how often missed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.methods.conditions import condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    SMALL,
    STRENGTH_COLOURS,
    STRENGTH_LINES,
    Margins,
    interval_bar,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.figures.colours import condition_colour
from costeer.study.material import StudyMaterial, conditions_driven, why_without
from costeer.study.quantities import half_width

NAME = "detection"
TITLE = "Detection of lane-change intentions"

_LONGEST_LEAD = 5.0
_HORIZON = 3.0
"""Asked of the network: a crossing within this time [s]. Source: Sec. II-B."""


def draw(material: StudyMaterial) -> Exhibit:
    """Draw lead times, false triggers and missed lane changes."""
    leads = lead_times(material)
    judged = [
        name
        for name in conditions_driven(material)
        if _rates(material, name, "false_triggers_per_km").size
    ]
    if not judged:
        lacking = "No trial of this study has triggers to judge."
        return not_drawn(NAME, TITLE, lacking)
    figure = new_figure(FULL_WIDTH_MM, 66.0)
    margins = Margins(left=14.0, right=11.0, top=8.0, between_columns=11.0)
    widths = (1.25, 0.2, 0.8, 0.8)
    left, spacer, middle, right = panels(figure, 1, 4, margins, widths)[0]
    spacer.remove()
    _cumulative(left, leads)
    _rate_bars(middle, material, judged, "false_triggers_per_km")
    _rate_bars(right, material, judged, "missed_per_km")
    middle.set_xlabel("False triggers [1/km]")
    right.set_xlabel("Missed changes [1/km]")
    # Marks without names would claim the numbers of the panel to their left.
    right.tick_params(labelleft=False, left=False)
    panel_letter(left, "a")
    panel_letter(middle, "b")
    panel_letter(right, "c")
    return Exhibit(NAME, TITLE, _caption(material), _DESCRIPTION, figure)


_DESCRIPTION = (
    "Left: share of intended lane changes announced at least so many seconds before "
    "the crossing, for manual, strong and weak. Middle and right: bars of false "
    "triggers and missed lane changes per kilometre for each condition."
)


def lead_times(material: StudyMaterial) -> dict[str, NDArray[np.float64]]:
    """Return the lead time [s] of every intended lane change by strength; 0: missed."""
    changes = material.lane_changes
    if "detection_lead_time" not in changes:
        return {}
    known = changes.dropna(subset=["detection_lead_time"])
    return {
        str(strength): values.to_numpy(np.float64)
        for strength, values in known.groupby("strength")["detection_lead_time"]
    }


def _cumulative(axes: Axes, leads: dict[str, NDArray[np.float64]]) -> None:
    lead = np.linspace(0.0, _LONGEST_LEAD, 251)
    for strength, colour in STRENGTH_COLOURS.items():
        values = leads.get(strength, np.array([]))
        if values.size:
            # A missed change has lead 0 and is announced at no time.
            share = [100.0 * np.mean((values >= at) & (values > 0.0)) for at in lead]
            label = f"{strength} (n = {values.size})"
            line = STRENGTH_LINES[strength]
            curve = axes.plot(lead, share, color=colour, linestyle=line, label=label)
            say(curve[0], strength)
    axes.axvline(_HORIZON, color=FAINT, linewidth=0.7)
    axes.set_xlim(0.0, _LONGEST_LEAD)
    axes.set_ylim(0.0, 102.0)
    axes.set_xlabel("Time before the crossing [s]")
    axes.set_ylabel("Lane changes announced [%]")
    if leads:
        axes.legend(loc="lower left")


def _rates(material: StudyMaterial, name: str, column: str) -> NDArray[np.float64]:
    """Each participant's rate in a condition [1/km], shape `(participants,)`."""
    trials = material.trials
    if column not in trials:
        return np.array([])
    values = trials.loc[trials["condition"] == name, column].dropna()
    return np.asarray(values, dtype=np.float64)


def _rate_bars(
    axes: Axes, material: StudyMaterial, names: list[str], column: str
) -> None:
    largest = 0.0
    for place, name in enumerate(names):
        values = _rates(material, name, column)
        mean, half = float(values.mean()), half_width(values)
        (bar,) = axes.barh(place, mean, height=0.7, color=condition_colour(name))
        ends = {"low": (mean - half,), "high": (mean + half,)} if half > 0.0 else {}
        say(bar, name, across=True, **ends)
        upper = half if np.isfinite(half) else 0.0
        lower = min(upper, mean)
        if upper > 0.0:
            interval_bar(axes, (mean, place), False, lower, upper)
        _value(axes, place, mean)
        largest = max(largest, mean + upper)
    if largest > 0.0:
        axes.set_xlim(0.0, 1.08 * largest)
        axes.locator_params(axis="x", nbins=4)
    else:
        _nothing(axes)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(range(len(names)), [_short(name) for name in names])


def _nothing(axes: Axes) -> None:
    """Say that there is none: numbers on an axis without a bar would mislead."""
    axes.set_xlim(0.0, 1.0)
    axes.set_xticks([0.0])
    axes.text(
        0.5,
        0.5,
        "none in any\ncondition",
        transform=axes.transAxes,
        fontsize=SMALL,
        ha="center",
        va="center",
    )


def _value(axes: Axes, place: int, mean: float) -> None:
    """Write the number at the right of the panel, where no bar is in its way."""
    axes.annotate(
        f"{mean:.2f}",
        xy=(1.0, place),
        xycoords=("axes fraction", "data"),
        xytext=(2.0, 0.0),
        textcoords="offset points",
        fontsize=SMALL,
        va="center",
    )


def _short(name: str) -> str:
    chosen = condition(name)
    return f"{chosen.strength} {chosen.duration}".strip()


def _reaches_below(material: StudyMaterial) -> bool:
    """Whether the interval of a rate is longer than its bar."""
    return any(
        half_width(values) > values.mean()
        for name in conditions_driven(material)
        for column in ("false_triggers_per_km", "missed_per_km")
        if (values := _rates(material, name, column)).size
    )


def _caption(material: StudyMaterial) -> str:
    many = material.trials["participant"].nunique() > 1
    cut = ", cut at zero where they reach below" if _reaches_below(material) else ""
    interval = f", with 95 % intervals{cut}" if many else ""
    silent = why_without(material, "num_triggers")
    why = f" Manual driving alone: {silent}." if silent else ""
    return (
        "(a) Share of the lane changes that the driver intended and that were "
        "announced at least so long before the crossing; missed ones count in the "
        "share. Grey: the 3 s that the network is asked for. (b) False triggers and "
        "(c) missed lane changes per kilometre: means over participants"
        f"{interval}. Under assistance triggers are judged against the driver's own "
        f"intention, not against crossings that the guidance made.{why}"
    )
