"""Small drawings of the worst cases: where the car was, and who pushed which way."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.comparison.worst import WORST, WorstCase
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    SIGNAL_COLOURS,
    SMALL,
    Margins,
    new_figure,
    panels,
)
from costeer.records.record import read_record
from costeer.study.definitions import MeasureParameters
from costeer.study.lanes import centre
from costeer.study.measures import parameters_of

BEFORE, AFTER = 6.0, 4.0
"""What is drawn around the event [s]."""

_COLUMNS = 3
_TWO_ROWS = 4
"""So many drives stand in two rows of two, without a hole."""
_TOP_MM = 13.0
"""Title of the first row, and the legend above it."""
_CLOSER_MM = 6.5
"""The torques stand so much nearer to the path above than to the next drive."""

_READ = ("time", "lateral_position", "driver_torque", "applied_torque")


def worst_drawings(folder: Path, cases: Sequence[WorstCase]) -> Exhibit:
    """Path and torques around the first event of each of the worst drives.

    Raises:
        ValueError: If a record cannot be read.
        OSError: If it is missing.
    """
    name, title = "worst-cases", "The worst drive of each method"
    if not cases:
        return not_drawn(name, title, "Nobody left a lane or hit anything.")
    num_columns = 2 if len(cases) == _TWO_ROWS else min(len(cases), _COLUMNS)
    num_rows = -(-len(cases) // num_columns)
    figure = new_figure(FULL_WIDTH_MM, _height_mm(num_rows))
    margins = Margins(
        left=17.0,
        right=3.0,
        top=_TOP_MM,
        bottom=3.0,
        between_columns=10.0,
        between_rows=9.0,
    )
    grid = panels(figure, 2 * num_rows, num_columns, margins, None, (3, 2) * num_rows)
    for place in range(num_columns * num_rows):
        row, column = divmod(place, num_columns)
        upper, lower = grid[2 * row][column], grid[2 * row + 1][column]
        if place >= len(cases):
            upper.set_axis_off()
            lower.set_axis_off()
            continue
        _raise(lower, _CLOSER_MM / _height_mm(num_rows))
        _draw(upper, lower, folder / WORST / cases[place].record, cases[place])
        if column == 0:
            upper.set_ylabel("y [m]")
            lower.set_ylabel("Torque\n[N·m]")
    figure.legend(*grid[1][0].get_legend_handles_labels(), loc="upper right", ncol=2)
    caption = (
        "Upper: lateral position of the car's middle (line) and sides (band), lines of "
        "the road grey. Lower: torques at the wheel, positive to the left. Time is "
        "from the first collision or departure of the drive, at the vertical line."
    )
    described = (
        f"Small drawings of {len(cases)} drives: lateral position and torques around "
        "the first event."
    )
    return Exhibit(name, title, caption, described, figure)


def _height_mm(num_rows: int) -> float:
    return _TOP_MM - 4.0 + 46.0 * num_rows


def _raise(axes: Axes, share: float) -> None:
    """Move a panel up by a share of the figure's height."""
    left, bottom, width, height = axes.get_position().bounds
    axes.set_position((left, bottom + share, width, height))


def _draw(upper: Axes, lower: Axes, path: Path, case: WorstCase) -> None:
    record = read_record(path, _READ)
    parameters = parameters_of(record)
    time = np.asarray(record.columns["time"]) - case.time
    seen = (time >= -BEFORE) & (time <= AFTER)
    columns = {name: np.ma.filled(record.columns[name])[seen] for name in _READ}
    columns["time"] = time[seen]
    _path(upper, columns, parameters)
    _torques(lower, columns)
    upper.set_title(_words(case), fontsize=SMALL)
    upper.tick_params(labelbottom=False)
    for axes in (upper, lower):
        axes.axvline(0.0, color=INK, linewidth=0.6, linestyle=(0.0, (1.0, 1.2)))
        axes.set_xlim(-BEFORE, AFTER)
    lower.set_xlabel("Time [s]")


def _words(case: WorstCase) -> str:
    mistake = "" if case.mistake == "none" else f", {case.mistake}"
    return f"{case.method}\n{case.scenario}{mistake}, driver {case.participant}"


# Any: the element type differs from column to column.
def _path(
    axes: Axes, columns: dict[str, NDArray[Any]], parameters: MeasureParameters
) -> None:
    time, y = columns["time"], columns["lateral_position"]
    half = parameters.car_width / 2.0
    for lane in range(int(parameters.num_lanes) + 1):
        line = centre(parameters, lane) - parameters.lane_width / 2.0
        edge = lane in (0, int(parameters.num_lanes))
        axes.axhline(line, color=RULE, linewidth=1.2 if edge else 0.7, zorder=0.5)
    axes.fill_between(time, y - half, y + half, color=RULE, alpha=0.6, linewidth=0.0)
    axes.plot(time, y, color=INK, linewidth=0.9)
    middle = float(np.mean(y)) if y.size else 0.0
    reach = max(3.2, float(np.ptp(y)) / 2.0 + half + 0.5) if y.size else 3.2
    axes.set_ylim(middle - reach, middle + reach)


def _torques(axes: Axes, columns: dict[str, NDArray[Any]]) -> None:
    axes.axhline(0.0, color=RULE, linewidth=0.6)
    for name, label in (("driver_torque", "driver"), ("applied_torque", "guidance")):
        axes.plot(
            columns["time"],
            columns[name],
            color=SIGNAL_COLOURS[label],
            linewidth=0.9,
            linestyle="-" if label == "driver" else (0.0, (4.0, 1.5)),
            label=label,
        )
