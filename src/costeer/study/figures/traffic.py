"""How near other cars came: time to collision, headway, and gaps at lane changes."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FULL_WIDTH_MM,
    STRENGTH_COLOURS,
    STRENGTH_LINES,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.material import StudyMaterial

NAME = "traffic"
TITLE = "How near other cars came"

_PANELS = {
    "time_to_collision_minimum": ("Least time to collision [s]", "Trials [%]", 15.0),
    "time_headway_mean": ("Mean time headway [s]", "Trials [%]", 6.0),
    "lead_time_gap": ("Accepted lead gap [s]", "Lane changes [%]", 8.0),
    "lag_time_gap": ("Accepted lag gap [s]", "Lane changes [%]", 8.0),
}
"""Measures by panel: what stands at its axes, and the largest value shown [s]."""


def draw(material: StudyMaterial) -> list[Exhibit]:
    """Draw the share of trials and lane changes below each value; nothing without."""
    if material.scenario is None:
        return []
    found = {name: values_of(material.scenario, name) for name in _PANELS}
    if not any(values for values in found.values()):
        lacking = "No car was near in any trial of this study."
        return [not_drawn(NAME, TITLE, lacking)]
    figure = new_figure(FULL_WIDTH_MM, 62.0)
    margins = Margins(left=13.0, right=3.0, top=12.0, bottom=11.0, between_columns=13.0)
    grid = panels(figure, 1, len(_PANELS), margins)[0]
    for axes, letter, name in zip(grid, "abcd", _PANELS, strict=True):
        _cumulative(axes, found[name], name)
        panel_letter(axes, letter)
    for axes in grid[1::2]:  # shares of the same as the panel to their left
        axes.set_ylabel("")
    handles = _legend(found)
    figure.legend(handles=handles, ncols=len(handles), loc="upper right")
    return [Exhibit(NAME, TITLE, _caption(found), _DESCRIPTION, figure)]


def values_of(table: pd.DataFrame, measure: str) -> dict[str, NDArray[np.float64]]:
    """Return the defined values of a measure over the whole course, by strength."""
    rows = table[(table["measure"] == measure) & (table["zone"] == "whole course")]
    known = rows.dropna(subset=["value"])
    return {
        str(strength): values.to_numpy(np.float64)
        for strength, values in known.groupby("strength")["value"]
    }


def _cumulative(
    axes: Axes, values: dict[str, NDArray[np.float64]], measure: str
) -> None:
    """Share of values that are at most so large, in steps."""
    label, share, longest = _PANELS[measure]
    for strength, colour in STRENGTH_COLOURS.items():
        own = np.sort(values.get(strength, np.zeros(0)))
        if own.size:
            places = np.concatenate([[0.0], own, [max(longest, own[-1])]])
            below = 100.0 * np.arange(own.size + 1) / own.size
            steps = np.concatenate([below, below[-1:]])
            line = STRENGTH_LINES[strength]
            curve = axes.step(places, steps, where="post", color=colour, linestyle=line)
            say(curve[0], strength)
    axes.set_xlim(0.0, longest)
    axes.set_ylim(0.0, 102.0)
    axes.set_xlabel(label)
    axes.set_ylabel(share)


def _legend(found: dict[str, dict[str, NDArray[np.float64]]]) -> list[Line2D]:
    drawn = {strength for values in found.values() for strength in values}
    return [
        Line2D([], [], color=colour, linestyle=STRENGTH_LINES[name], label=name)
        for name, colour in STRENGTH_COLOURS.items()
        if name in drawn
    ]


def _caption(found: dict[str, dict[str, NDArray[np.float64]]]) -> str:
    counts = {name: sum(map(len, values.values())) for name, values in found.items()}
    beyond = sum(
        int(np.sum(values > _PANELS[name][2]))
        for name, by_strength in found.items()
        for values in by_strength.values()
    )
    further = f" {beyond} values lie beyond the axes and count." if beyond else ""
    return (
        "Share of trials, or of lane changes, with at most so much: (a) least time to "
        f"collision with the car ahead (n = {counts['time_to_collision_minimum']} "
        "trials in which the car came nearer to one), (b) mean time headway while one "
        f"was followed (n = {counts['time_headway_mean']}), (c) time gap to the car "
        f"ahead (n = {counts['lead_time_gap']}) and (d) that of the car behind (n = "
        f"{counts['lag_time_gap']}) in the new lane when a lane change began. A gap "
        f"below zero was beside a car.{further}"
    )


_DESCRIPTION = (
    "Four panels with rising steps for manual, strong and weak: least time to "
    "collision, mean time headway, accepted gap ahead and accepted gap behind."
)
