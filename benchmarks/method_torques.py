"""What every method gives while a virtual driver changes lanes.

    python -m benchmarks.method_torques [FIGURE.svg]

The same pilot driver overtakes the same leader, once under each method, strong
guidance, path of 6 s where the condition says it. Methods that look at a predictor are
given a perfect one; the indicator is the driver's own. Prints for each method the mean
guidance torque along the lane change up to the crossing, the opposing part of it, and
the driver's largest torque; writes the figure of docs/methods.md where a file is named.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.ibhs import IBHS
from costeer.methods.rivals import RIVALS
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    SIGNAL_COLOURS,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)

PARTICIPANT = 10
LENGTH = 1400.0
BEFORE, AFTER = 1.0, 11.0
"""Shown before and after the driver begins [s]."""

COLUMNS = 3

Numbers = NDArray[np.float64]


class LaneChange(NamedTuple):
    """The first lane change of a trial.

    Attributes:
        time: From its onset on, `(time,)` [s].
        side: That it leads to, -1 right, +1 left [-].
        guidance: Torque towards that side, `(time,)` [N·m].
        driver: Torque towards that side, `(time,)` [N·m].
        crossing: Of the line [s]; NaN if the car does not cross.
    """

    time: Numbers
    side: float
    guidance: Numbers
    driver: Numbers
    crossing: float


def first_change(method: str) -> LaneChange:
    """Drive until the first lane change is over."""
    setup = TrialSetup(
        participant=PARTICIPANT,
        seed=PILOT_SEED,
        condition="manual" if method == "manual" else "strong-normal",
        method="ibhs" if method == "manual" else method,
        intention="scripted",
        length=LENGTH,
    )
    columns = simulate_trial(setup, "python").columns
    wanted = np.ma.filled(columns["driver_intention"], 0)
    onset = int(np.flatnonzero(wanted)[0])
    side, time = float(wanted[onset]), columns["time"] - columns["time"][onset]
    lane = np.ma.filled(columns["lane"], -1)
    crossed = np.flatnonzero((lane != lane[onset]) & (time > 0.0))
    shown = (time >= -BEFORE) & (time <= AFTER)
    return LaneChange(
        time=time[shown],
        side=side,
        guidance=side * columns["applied_torque"][shown],
        driver=side * columns["driver_torque"][shown],
        crossing=float(time[crossed[0]]) if len(crossed) else np.nan,
    )


def print_row(name: str, change: LaneChange) -> None:
    """One line of the table."""
    last = change.crossing if np.isfinite(change.crossing) else AFTER
    rows = (change.time >= 0.0) & (change.time <= last)
    guidance = change.guidance[rows]
    opposing = np.minimum(guidance, 0.0)
    print(
        f"{name:20s} {guidance.mean():+8.2f} {opposing.mean():+8.2f} "
        f"{np.abs(change.driver).max():8.2f} {change.crossing:8.2f}"
    )


def draw(axes: Axes, name: str, change: LaneChange, alone: LaneChange) -> None:
    """Torques of one method, and the driver's without it."""
    axes.plot(alone.time, alone.driver, color=INK, linewidth=0.6, linestyle=":")
    for torque, colour in (
        (change.driver, SIGNAL_COLOURS["driver"]),
        (change.guidance, SIGNAL_COLOURS["guidance"]),
    ):
        axes.plot(change.time, torque, color=colour, linewidth=1.1)
    axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.axvline(change.crossing, color=RULE, linewidth=1.0)
    axes.set_title(name)
    axes.set_xlim(-BEFORE, AFTER)
    axes.set_ylim(-5.0, 5.0)


def drawn(changes: dict[str, LaneChange], alone: LaneChange) -> Figure:
    """One panel a method."""
    rows = -(-len(changes) // COLUMNS)
    figure = new_figure(FULL_WIDTH_MM, 38.0 * rows + 20.0)
    margins = Margins(left=14.0, top=18.0, right=4.0, between_rows=15.0)
    grid = panels(figure, rows, COLUMNS, margins)
    every = [axes for line in grid for axes in line]
    for axes, (name, change) in zip(every, changes.items(), strict=False):
        draw(axes, name, change, alone)
    for axes in every[len(changes) :]:
        axes.set_visible(False)
    for k, axes in enumerate(every[: len(changes)]):
        last = k + COLUMNS >= len(changes)
        axes.tick_params(labelleft=k % COLUMNS == 0, labelbottom=last)
        if k % COLUMNS == 0:
            axes.set_ylabel("Torque [N·m]")
        if last:
            axes.set_xlabel("Since onset [s]")
    keys = [
        Line2D([], [], color=SIGNAL_COLOURS["driver"], label="driver"),
        Line2D([], [], color=SIGNAL_COLOURS["guidance"], label="guidance"),
        Line2D([], [], color=INK, linestyle=":", label="driver alone"),
        Line2D([], [], color=RULE, label="car on the line"),
    ]
    figure.legend(handles=keys, loc="upper center", ncol=4, frameon=False)
    return figure


def main() -> None:
    """Print the table and write the figure."""
    print("method               guidance  opposing  driver  crossing")
    print("                     [N·m]     [N·m]     [N·m]   [s]")
    alone = first_change("manual")
    print_row("manual", alone)
    changes = {}
    for method in (IBHS, *RIVALS):
        changes[method.name] = first_change(method.name)
        print_row(method.name, changes[method.name])
    if len(sys.argv) > 1:
        with styled():
            text = svg_text(
                drawn(changes, alone), "methods", "Torques in a lane change by method"
            )
        Path(sys.argv[1]).write_text(text, "utf-8")


if __name__ == "__main__":
    main()
