"""Figures of the emergencies: collisions by time left, what driver and wheel did."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from costeer.emergencies.design import SITUATIONS, TIMES
from costeer.emergencies.outcome import EmergencyRow
from costeer.pages.exhibit import Exhibit
from costeer.pages.style import (
    FULL_WIDTH_MM,
    Margins,
    interval_bar,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.figures.colours import condition_colour
from costeer.study.rates import wilson_interval

MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_SPREAD = 0.12

Rows = Sequence[EmergencyRow]


def conditions_of(rows: Rows) -> list[str]:
    """Conditions in the order in which they were driven."""
    return list(dict.fromkeys(row.condition for row in rows))


def collisions(rows: Rows) -> Exhibit:
    """Share of collisions against the time to collision, a panel for each situation."""
    figure = new_figure(FULL_WIDTH_MM, 92.0)
    margins = Margins(
        left=14.0,
        right=3.0,
        top=8.0,
        bottom=11.0,
        between_columns=14.0,
        between_rows=18.0,
    )
    grid = panels(figure, 2, 2, margins)
    names = conditions_of(rows)
    for axes, (number, words) in zip(
        [each for line in grid for each in line], SITUATIONS.items(), strict=True
    ):
        own = [row for row in rows if row.meant_situation == number]
        for place, name in enumerate(names):
            _shares(axes, [row for row in own if row.condition == name], name, place)
        axes.set_title(f"({number}) {words}", fontsize=8)
        axes.set_ylim(-4.0, 104.0)
        axes.set_xticks(TIMES)
        axes.set_xlim(TIMES[0] - 0.3, TIMES[-1] + 0.3)
        axes.set_xlabel("Time to collision at appearance [s]")
        axes.set_ylabel("Collisions [%]")
    handles, labels = grid[0][0].get_legend_handles_labels()
    grid[0][1].legend(handles, labels, loc="upper right")
    return Exhibit(
        "collisions",
        "Collisions by situation and time left",
        "Share of drives that ended in a collision with the obstacle, another car or a "
        "barrier, both speeds and both states of the lane beside together; bars are "
        "95 % intervals (Wilson). The number of a panel is the situation that the "
        "drives were meant to come to.",
        "Four panels, one for each situation. Collisions fall from nearly all at 1.5 s "
        "to few at 4 s.",
        figure,
    )


def _shares(axes: Axes, rows: Rows, name: str, place: int) -> None:
    xs, shares = [], []
    for time in TIMES:
        own = [row.collided for row in rows if row.time_to_collision == time]
        if not own:
            continue
        low, high = wilson_interval(sum(own), len(own))
        x, share = time + _SPREAD * (place - 1), 100.0 * sum(own) / len(own)
        interval_bar(axes, (x, share), True, share - 100.0 * low, 100.0 * high - share)
        xs.append(x)
        shares.append(share)
    if xs:
        axes.plot(
            xs,
            shares,
            marker=MARKERS[place % len(MARKERS)],
            color=condition_colour(name),
            label=name,
            markersize=4,
            linewidth=1.0,
        )


def behaviour(rows: Rows) -> Exhibit:
    """Reaction, wheel rate, driver torque and gain, by condition and situation."""
    figure = new_figure(FULL_WIDTH_MM, 64.0)
    margins = Margins(left=14.0, right=3.0, top=12.0, bottom=11.0, between_columns=12.0)
    line = panels(figure, 1, 4, margins)[0]
    quantities = (
        ("reaction_time", 1.0, "Reaction time [s]"),
        ("peak_wheel_rate", 180.0 / np.pi, "Peak wheel rate [°/s]"),
        ("peak_driver_torque", 1.0, "Peak driver torque [N·m]"),
        ("gain_at_obstacle", 1.0, "K$_h$ at the obstacle [–]"),
    )
    for axes, letter, (name, factor, label) in zip(
        line, "abcd", quantities, strict=True
    ):
        _spreads(axes, rows, name, factor)
        axes.set_ylabel(label)
        axes.set_xlabel("Situation")
        panel_letter(axes, letter)
    handles, labels = line[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper right", ncol=len(labels))
    return Exhibit(
        "behaviour",
        "What driver, wheel and guidance did",
        "Medians with quartiles over drives. (a) From the appearance until wheel or "
        "brake differed from the same drive without an obstacle. (b), (c) Until the "
        "car had passed the obstacle, hit it or stood. (d) The haptic gain when the "
        "car was beside the obstacle.",
        "Four panels of medians with quartiles, by situation, for each condition.",
        figure,
    )


def _spreads(axes: Axes, rows: Rows, quantity: str, factor: float) -> None:
    for place, name in enumerate(conditions_of(rows)):
        xs, middles = [], []
        for number in SITUATIONS:
            own = [
                factor * float(getattr(row, quantity))
                for row in rows
                if (row.condition, row.meant_situation) == (name, number)
            ]
            known = np.array([value for value in own if np.isfinite(value)])
            if not known.size:
                continue
            low, middle, high = np.percentile(known, (25, 50, 75))
            x = number + 1.6 * _SPREAD * (place - 1)
            interval_bar(
                axes, (x, middle), True, float(middle - low), float(high - middle)
            )
            xs.append(x)
            middles.append(float(middle))
        axes.plot(
            xs,
            middles,
            marker=MARKERS[place % len(MARKERS)],
            color=condition_colour(name),
            label=name,
            markersize=3.5,
            linestyle="none",
        )
    axes.set_xticks(list(SITUATIONS))
    axes.set_xlim(0.5, len(SITUATIONS) + 0.5)
    axes.set_ylim(bottom=0.0)
