"""Mean trajectories of lane changes, aligned at the crossing, with a 95 % band."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.methods.conditions import CONDITIONS, DURATIONS, MANUAL
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    STRENGTH_COLOURS,
    STRENGTH_LINES,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.records.record import read_record
from costeer.study.crossings import LEFT, RIGHT
from costeer.study.material import LANE_LINE, LANE_TICKS, StudyMaterial
from costeer.study.quantities import half_width

NAME = "trajectories"
TITLE = "Mean trajectories of lane changes"

TIME = np.linspace(-5.0, 7.0, 121)
"""Where trajectories are averaged, from the crossing [s]: 10 Hz, smoother than 1 cm."""

_WORDS = {RIGHT: "right", LEFT: "left"}

Key = tuple[str, int]
"""Condition and direction."""


class Mean(NamedTuple):
    """Mean trajectory of a condition and direction.

    Attributes:
        position: Mean over participants of their own means [m], shape `(time,)`.
        half_width: Half of its 95 % interval [m]; NaN with one participant.
        participants: How many have such a lane change.
        changes: How many lane changes went in.
    """

    position: NDArray[np.float64]
    half_width: NDArray[np.float64]
    participants: int
    changes: int


def draw(material: StudyMaterial) -> Exhibit:
    """Draw the means of each duration and direction: manual, strong and weak."""
    means = mean_trajectories(material)
    if not means:
        return not_drawn(NAME, TITLE, "No trial of this study holds a lane change.")
    durations = [name for name in DURATIONS if _has(means, name)] or [""]
    figure = new_figure(FULL_WIDTH_MM, 108.0)
    margins = Margins(
        left=16.0, top=11.0, bottom=10.0, between_columns=5.0, between_rows=9.0
    )
    grid = panels(figure, 2, len(durations), margins)
    for row, direction, letter in zip(grid, (RIGHT, LEFT), "ab", strict=True):
        for axes, duration in zip(row, durations, strict=True):
            _draw_panel(axes, means, duration, direction)
            axes.tick_params(labelleft=axes is row[0], labelbottom=row is grid[1])
        row[0].set_ylabel("Lateral position [m]")
        panel_letter(row[0], letter)
    for axes in grid[1]:
        axes.set_xlabel("Time from crossing [s]")
    handles = _legend(means)
    figure.legend(handles=handles, ncols=len(handles), loc="upper right")
    return Exhibit(NAME, TITLE, _caption(means), _DESCRIPTION, figure)


_DESCRIPTION = (
    "Six panels of lateral position against time from the crossing: lane changes to "
    "the right above, to the left below, one column for each planned duration, each "
    "with the mean curves of manual, strong and weak and their bands."
)


def _has(means: dict[Key, Mean], duration: str) -> bool:
    names = {each.name for each in CONDITIONS if each.duration == duration}
    return any(key[0] in names for key in means)


def mean_trajectories(material: StudyMaterial) -> dict[Key, Mean]:
    """Return the mean trajectory of every condition and direction there is."""
    own: dict[Key, list[NDArray[np.float64]]] = {}
    counts: dict[Key, int] = {}
    changes = material.lane_changes.groupby(["participant", "condition"])
    for (participant, name), rows in changes:
        path = material.records.get((int(participant), str(name)))
        if path is None:
            continue
        record = read_record(path, ["time", "lateral_position"])
        time, position = record.columns["time"], record.columns["lateral_position"]
        for direction, crossings in rows.groupby("direction")["crossing_time"]:
            key = (str(name), int(direction))
            aligned = _aligned(time, position, crossings)
            counts[key] = counts.get(key, 0) + len(aligned)
            own.setdefault(key, []).append(_column_means(aligned))
    return {key: _mean(np.array(values), counts[key]) for key, values in own.items()}


def _aligned(
    time: NDArray[np.float64], position: NDArray[np.float64], crossings: pd.Series
) -> NDArray[np.float64]:
    """Trajectories over `TIME`, shape `(changes, time)`; NaN outside the record."""
    return np.array(
        [
            np.interp(TIME + float(at), time, position, left=np.nan, right=np.nan)
            for at in crossings
        ]
    )


def _mean(own: NDArray[np.float64], changes: int) -> Mean:
    """Mean over participants, shape of `own` `(participants, time)`."""
    return Mean(
        position=_column_means(own),
        half_width=np.array([half_width(column) for column in own.T]),
        participants=len(own),
        changes=changes,
    )


def _column_means(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean of what is defined, shape `(time,)`; NaN where nothing is."""
    defined = np.isfinite(rows)
    total = np.where(defined, rows, 0.0).sum(axis=0)
    count = defined.sum(axis=0)
    means = np.full(len(TIME), np.nan)
    np.divide(total, count, out=means, where=count > 0)
    return means


def _draw_panel(
    axes: Axes, means: dict[Key, Mean], duration: str, direction: int
) -> None:
    for chosen in CONDITIONS:
        mean = means.get((chosen.name, direction))
        if mean is None or chosen.duration not in ("", duration):
            continue
        colour, line = (
            STRENGTH_COLOURS[chosen.strength],
            STRENGTH_LINES[chosen.strength],
        )
        low, high = mean.position - mean.half_width, mean.position + mean.half_width
        axes.fill_between(TIME, low, high, color=colour, alpha=0.22, linewidth=0)
        axes.plot(TIME, mean.position, color=colour, linestyle=line, linewidth=1.1)
    axes.axhline(LANE_LINE, color=FAINT, linewidth=0.7, linestyle=(0, (6.0, 4.0)))
    axes.axvline(0.0, color=FAINT, linewidth=0.5, zorder=0)
    axes.set_xlim(TIME[0], TIME[-1])
    axes.set_ylim(-4.3, 0.8)
    axes.set_yticks(LANE_TICKS)
    axes.set_xticks([-4, -2, 0, 2, 4, 6])
    planned = f"{duration} ({DURATIONS[duration]:g} s), " if duration else ""
    axes.set_title(f"{planned}to the {_WORDS[direction]}")


def _legend(means: dict[Key, Mean]) -> list[Line2D]:
    drawn = {name.split("-")[0] for name, _ in means}
    return [
        Line2D([], [], color=colour, linestyle=STRENGTH_LINES[name], label=name)
        for name, colour in STRENGTH_COLOURS.items()
        if name in drawn
    ]


def _caption(means: dict[Key, Mean]) -> str:
    changes = sum(mean.changes for mean in means.values())
    participants = max(mean.participants for mean in means.values())
    band = (
        "bands are 95 % intervals of that mean"
        if participants > 1
        else "one participant only, hence no band"
    )
    manual = (
        " The manual mean is the same in each row."
        if any(name == MANUAL for name, _ in means)
        else ""
    )
    return (
        f"{changes} lane changes of {participants} participants, aligned at the "
        "crossing of the lane line (dashed): (a) to the right, (b) to the left. Lines "
        "are "
        f"means over participants of each one's own mean; {band}.{manual} Lateral "
        "position is measured from the left lane's centre; the right lane's is at "
        "−3.5 m."
    )
