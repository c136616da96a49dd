"""Mean trajectories of lane changes, aligned at the crossing, with a 95 % band."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.methods.conditions import CONDITIONS, DURATIONS, MANUAL
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    NORMAL,
    STRENGTH_COLOURS,
    STRENGTH_LINES,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.records.record import read_record
from costeer.study.crossings import LEFT, RIGHT
from costeer.study.definitions import MeasureParameters
from costeer.study.lanes import lines
from costeer.study.material import StudyMaterial
from costeer.study.people import Who
from costeer.study.quantities import half_width

NAME = "trajectories"
TITLE = "Mean trajectories of lane changes"

TIME = np.linspace(-5.0, 7.0, 121)
"""Where trajectories are averaged, from the crossing [s]: 10 Hz, smoother than 1 cm."""

_WORDS = {RIGHT: "right", LEFT: "left"}

Key = tuple[str, int]
"""Condition and direction."""


class Own(NamedTuple):
    """Trajectories of one condition and direction by participant.

    Attributes:
        positions: Own mean of each [m], shape `(time,)`.
        changes: Lane changes of each.
    """

    positions: dict[Who, NDArray[np.float64]]
    changes: dict[Who, int]


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
    """Draw the means of each duration and direction, and what they differ by."""
    own = own_trajectories(material)
    if not own:
        return not_drawn(NAME, TITLE, "No trial of this study holds a lane change.")
    means = {key: mean_of(each) for key, each in own.items()}
    apart = differences(own)
    durations = [name for name in DURATIONS if _has(means, name)] or [""]
    heights = [1.0, 0.8, 1.0, 0.8] if apart else [1.0, 1.0]
    figure = new_figure(FULL_WIDTH_MM, 168.0 if apart else 108.0)
    margins = Margins(
        left=16.0, top=12.0, bottom=10.0, between_columns=5.0, between_rows=9.0
    )
    grid = panels(figure, len(heights), len(durations), margins, row_heights=heights)
    for at, direction in enumerate((RIGHT, LEFT)):
        rows = grid[2 * at : 2 * at + 2] if apart else grid[at : at + 1]
        for column, duration in enumerate(durations):
            _draw_panel(rows[0][column], means, duration, direction)
            _draw_lanes(rows[0][column], material.road.lane_width)
            if apart:
                _draw_difference(rows[1][column], apart, duration, direction)
        rows[0][0].set_ylabel("Lateral position [m]")
        rows[-1][0].set_ylabel(rows[-1][0].get_ylabel() or "Minus manual [m]")
    _label(grid)
    handles = _legend(means)
    figure.legend(
        handles=handles,
        ncols=len(handles),
        loc="upper right",
        fontsize=NORMAL,
        handlelength=2.8,
    )
    words = _caption(own, means, material.road)
    return Exhibit(NAME, TITLE, words, _DESCRIPTION, figure)


def _label(grid: list[list[Axes]]) -> None:
    """Numbers at the outer panels only, and a letter for each row."""
    for row, letter in zip(grid, "abcd", strict=False):
        for axes in row:
            axes.tick_params(labelleft=axes is row[0], labelbottom=row is grid[-1])
        panel_letter(row[0], letter)
    for axes in grid[-1]:
        axes.set_xlabel("Time from crossing [s]")


_DESCRIPTION = (
    "Lateral position against time from the crossing: lane changes to the right above, "
    "to the left below, one column for each planned duration, each with the mean "
    "curves of manual, strong and weak and their bands; below them strong and weak "
    "less manual."
)


def _has(means: dict[Key, Mean], duration: str) -> bool:
    names = {each.name for each in CONDITIONS if each.duration == duration}
    return any(key[0] in names for key in means)


def own_trajectories(material: StudyMaterial) -> dict[Key, Own]:
    """Return each participant's mean in every condition and direction there is."""
    own: dict[Key, Own] = {}
    changes = material.lane_changes.groupby(["participant", "condition"])
    for (participant, name), rows in changes:
        path = material.records.get((participant, str(name)))
        if path is None:
            continue
        record = read_record(path, ["time", "lateral_position"])
        time, position = record.columns["time"], record.columns["lateral_position"]
        for direction, crossings in rows.groupby("direction")["crossing_time"]:
            aligned = _aligned(time, position, crossings, material.road)
            known = own.setdefault((str(name), int(direction)), Own({}, {}))
            known.positions[participant] = _column_means(aligned)
            known.changes[participant] = len(aligned)
    return own


def differences(own: dict[Key, Own]) -> dict[Key, Mean]:
    """Mean of what each participant's trajectory has more than the own manual one."""
    found = {}
    for (name, direction), each in own.items():
        manual = own.get((MANUAL, direction))
        if name == MANUAL or manual is None:
            continue
        apart = {
            who: position - manual.positions[who]
            for who, position in each.positions.items()
            if who in manual.positions
        }
        if apart:
            found[name, direction] = mean_of(each._replace(positions=apart))
    return found


def _aligned(
    time: NDArray[np.float64],
    position: NDArray[np.float64],
    crossings: pd.Series,
    road: MeasureParameters,
) -> NDArray[np.float64]:
    """Trajectories over `TIME`, shape `(changes, time)`; NaN outside the record.

    They are measured from the centre of the left one of the two lanes that are changed.
    """
    # The centre of a line's left lane is half a lane beside it.
    left = np.array([0.5 * road.lane_width - line for line in lines(road)])
    found = []
    for at in crossings:
        there = float(np.interp(at, time, position)) + 0.5 * road.lane_width
        origin = left[int(np.argmin(np.abs(left - there)))]
        path = np.interp(TIME + float(at), time, position, left=np.nan, right=np.nan)
        found.append(path - origin)
    return np.array(found)


def mean_of(own: Own) -> Mean:
    """Mean over participants of their own means."""
    positions = np.array(list(own.positions.values()))
    return Mean(
        position=_column_means(positions),
        half_width=np.array([half_width(column) for column in positions.T]),
        participants=len(positions),
        changes=sum(own.changes[who] for who in own.positions),
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
    _draw_means(axes, means, duration, direction)
    planned = f"{duration} ({DURATIONS[duration]:g} s), " if duration else ""
    axes.set_title(f"{planned}to the {_WORDS[direction]}")


def _draw_lanes(axes: Axes, width: float) -> None:
    """The line between the two lanes, and marks at their centres."""
    line = -width / 2.0
    axes.axhline(line, color=FAINT, linewidth=0.7, linestyle=(0, (6.0, 4.0)))
    axes.set_ylim(-width - 0.8, 0.8)
    axes.set_yticks((-width, line, 0.0))


def _draw_difference(
    axes: Axes, apart: dict[Key, Mean], duration: str, direction: int
) -> None:
    _draw_means(axes, apart, duration, direction)
    axes.axhline(0.0, color=STRENGTH_COLOURS["manual"], **_MANUAL_LINE)
    limit = _limit(apart)
    axes.set_ylim(-limit, limit)


_MANUAL_LINE: Any = {"linewidth": 1.1, "linestyle": STRENGTH_LINES["manual"]}
_WIDEST_BAND = 2.0  # of the largest difference; that of two participants is no scale


def _limit(apart: dict[Key, Mean]) -> float:
    """Half of the range of the differences, one for all panels [m]."""
    largest = max(float(np.nanmax(np.abs(each.position))) for each in apart.values())
    reached = max(
        float(np.nanmax(np.abs(each.position) + np.nan_to_num(each.half_width)))
        for each in apart.values()
    )
    return 1.05 * min(reached, _WIDEST_BAND * largest) or 1.0


def _draw_means(
    axes: Axes, means: dict[Key, Mean], duration: str, direction: int
) -> None:
    """Lines and bands of the conditions of one duration, and manual."""
    for chosen in CONDITIONS:
        mean = means.get((chosen.name, direction))
        if mean is None or chosen.duration not in ("", duration):
            continue
        colour = STRENGTH_COLOURS[chosen.strength]
        line = STRENGTH_LINES[chosen.strength]
        low, high = mean.position - mean.half_width, mean.position + mean.half_width
        axes.fill_between(TIME, low, high, color=colour, alpha=0.22, linewidth=0)
        curve = axes.plot(TIME, mean.position, color=colour, ls=line, linewidth=1.1)
        say(curve[0], chosen.name, low=tuple(low), high=tuple(high))
    axes.axvline(0.0, color=FAINT, linewidth=0.5, zorder=0)
    axes.set_xlim(TIME[0], TIME[-1])
    axes.set_xticks([-4, -2, 0, 2, 4, 6])


def _legend(means: dict[Key, Mean]) -> list[Line2D]:
    drawn = {name.split("-")[0] for name, _ in means}
    return [
        Line2D([], [], color=colour, linestyle=STRENGTH_LINES[name], label=name)
        for name, colour in STRENGTH_COLOURS.items()
        if name in drawn
    ]


def _caption(
    own: dict[Key, Own], means: dict[Key, Mean], road: MeasureParameters
) -> str:
    changes = sum(mean.changes for mean in means.values())
    participants = len({who for each in own.values() for who in each.positions})
    band = (
        "bands are 95 % intervals of that mean"
        if participants > 1
        else "one participant only, hence no band"
    )
    apart = any(name == MANUAL for name, _ in means) and len({n for n, _ in means}) > 1
    letters = ("a", "c") if apart else ("a", "b")
    differing = (
        " (b, d) The same less the participant's own manual mean, which is the dotted "
        "zero: above it the car is farther to the left. The manual mean is the same "
        "in each column."
        if apart
        else ""
    )
    return (
        f"{changes} lane changes of {participants} participants, aligned at the "
        f"crossing of the lane line (dashed): ({letters[0]}) to the right, "
        f"({letters[1]}) to the left. Lines are means over participants of each one's "
        f"own mean; {band}. Lateral position is measured from the centre of the left "
        f"one of the two lanes; the right one's is at −{road.lane_width:g} m."
        f"{differing}"
    )
