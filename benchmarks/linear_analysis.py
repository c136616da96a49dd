"""Poles and margins of the closed loop without hands, and their figure.

    python -m benchmarks.linear_analysis [FIGURE.svg]

Prints for three cars and four speeds, strong guidance: smallest damping ratio, gain
margin and delay margin, without friction compensation and with its slope at zero; then
the worst case over haptic gains of 0.02 to 1. Writes the figure of docs/stability.md
where a file is named. Exit code 1 if the loop without compensation is unstable
anywhere.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter

from benchmarks.hands_off import hands_off_setup
from costeer.loop.scenario import loop_parameters
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    Margins,
    new_figure,
    panel_letter,
    panels,
    styled,
    svg_text,
)
from costeer.plant.parameters import CARS
from costeer.validation.linear import (
    LinearLoop,
    damping_ratio,
    delay_margin,
    gain_margin,
    largest_modulus,
    linear_loop,
)
from costeer.validation.stability import SPEEDS

GAINS = np.geomspace(0.02, 1.0, 25)
"""Haptic gains of the table's worst case [-]."""

DRAWN_GAINS = {1.0: "#1a1a1a", 0.4: "#D55E00", 0.1: "#0072B2", 0.02: "#56B4E9"}
"""Gains of the figure and their colours, of Okabe and Ito."""

WIDTHS = {1.0: 1.8, 0.4: 1.4, 0.1: 1.1, 0.02: 0.8}
"""The widths tell them apart too [pt]."""

DRAWN_SPEEDS = np.linspace(50.0, 110.0, 13) / 3.6
DASHES = {False: (0.0, ()), True: (0.0, (3.0, 1.5))}
COMPENSATIONS = (False, True)


class Case(NamedTuple):
    """One car at one speed, with or without the compensation's slope."""

    car: str
    speed: float
    compensated: bool


def loops(speeds: Iterable[float]) -> dict[Case, LinearLoop]:
    """The linear loop of every car at these speeds."""
    cases = [Case(c, v, k) for k in COMPENSATIONS for c in CARS for v in speeds]
    return {
        case: linear_loop(
            loop_parameters(hands_off_setup(case.car, case.speed, 60.0)),
            case.compensated,
        )
        for case in cases
    }


def print_table(every: dict[Case, LinearLoop]) -> None:
    """Damping and margins at full gain, then the worst over all gains."""
    for compensated in COMPENSATIONS:
        name = "compensation's slope at zero" if compensated else "no compensation"
        print(f"\nstrong, K_h = 1, {name}")
        print("car      km/h  damping ratio  gain margin  delay margin ms")
        for case, loop in every.items():
            if case.compensated == compensated:
                print(
                    f"{case.car:8s} {case.speed * 3.6:4.0f} "
                    f"{damping_ratio(loop, 1.0):14.2f} {gain_margin(loop, 1.0):12.2f} "
                    f"{delay_margin(loop, 1.0) * 1e3:16.0f}"
                )
        print_worst({c: k for c, k in every.items() if c.compensated == compensated})


def print_worst(every: dict[Case, LinearLoop]) -> None:
    """Where over all gains the loop comes closest to instability."""
    grid = [(case, gain) for case in every for gain in GAINS.tolist()]
    case, gain = max(grid, key=lambda at: largest_modulus(every[at[0]], at[1]) ** 60)
    modulus = largest_modulus(every[case], gain)
    unstable = [at for at in grid if largest_modulus(every[at[0]], at[1]) >= 1.0]
    print(
        f"{len(unstable)} of {len(grid)} unstable; slowest decay "
        f"{-math.log(modulus) * 60.0:.3f} 1/s: {case.car} car at "
        f"{case.speed * 3.6:.0f} km/h, K_h = {gain:.2f}"
    )


def margins(loop: LinearLoop) -> list[tuple[float, float]]:
    """Gain margin and delay margin [s], NaN where unstable, at each drawn gain."""
    full = gain_margin(loop, 1.0)
    delays = [delay_margin(loop, gain) for gain in DRAWN_GAINS]
    known = [delay if delay > 0.0 else math.nan for delay in delays]
    return [(full / gain, d) for gain, d in zip(DRAWN_GAINS, known, strict=True)]


def draw_car(axes: Sequence[Axes], every: dict[Case, LinearLoop], car: str) -> None:
    """Both margins of one car over the speed."""
    for compensated in COMPENSATIONS:
        speeds = DRAWN_SPEEDS.tolist()
        values = [margins(every[Case(car, speed, compensated)]) for speed in speeds]
        series = np.transpose(values)  # margin, gain, speed
        for panel, (k, gain) in itertools.product((0, 1), enumerate(DRAWN_GAINS)):
            axes[panel].plot(
                DRAWN_SPEEDS * 3.6,
                series[panel, k],
                color=DRAWN_GAINS[gain],
                linewidth=WIDTHS[gain],
                linestyle=DASHES[compensated],
            )


def dress(axes: Axes, row: int, column: int) -> None:
    """Scales, labels and the line of no margin."""
    axes.set_xlim(50.0, 110.0)
    axes.set_xticks([50, 70, 90, 110])
    axes.grid(color=RULE, linewidth=0.4)
    if row == 0:
        axes.set_yscale("log")
        axes.set_ylim(0.5, 1000.0)
        axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
        axes.axhline(1.0, color=INK, linewidth=0.6, zorder=1.0)
        axes.tick_params(labelbottom=False)
    else:
        axes.set_ylim(0.0, 1.4)
        axes.set_xlabel("Speed [km/h]")
    axes.tick_params(labelleft=column == 0)
    if column == 0:
        axes.set_ylabel(("Gain margin [-]", "Delay margin [s]")[row])


def drawn(every: dict[Case, LinearLoop]) -> Figure:
    """Gain margin above, delay margin below, one column a car."""
    figure = new_figure(FULL_WIDTH_MM, 100.0)
    grid = panels(figure, 2, 3, Margins(left=14.0, top=12.0, right=4.0))
    for column, car in enumerate(CARS):
        draw_car([line[column] for line in grid], every, car)
        grid[0][column].set_title(f"{car.capitalize()} car")
        for row in (0, 1):
            dress(grid[row][column], row, column)
    for line, letter in zip(grid, "ab", strict=True):
        panel_letter(line[0], letter)
    keys = [
        Line2D([], [], color=DRAWN_GAINS[gain], linewidth=WIDTHS[gain])
        for gain in DRAWN_GAINS
    ]
    keys += [Line2D([], [], color=INK, linestyle=DASHES[c]) for c in COMPENSATIONS]
    names = [f"$K_h$ = {gain:g}" for gain in DRAWN_GAINS]
    names += ["without friction compensation", "with its slope at zero"]
    figure.legend(keys, names, loc="upper center", ncols=len(keys), columnspacing=1.4)
    return figure


def main() -> int:
    """Print, draw, and return 1 if a loop that should be stable is not."""
    every = loops(SPEEDS)
    print("python -m benchmarks.linear_analysis")
    print_table(every)
    if len(sys.argv) > 1:
        title = "Gain margin and delay margin of the closed loop without hands"
        with styled():
            text = svg_text(
                drawn(loops(DRAWN_SPEEDS.tolist())), "linear-margins", title
            )
        Path(sys.argv[1]).write_text(text, "utf-8")
    literal = [loop for case, loop in every.items() if not case.compensated]
    stable = all(
        largest_modulus(loop, gain) < 1.0 for loop in literal for gain in GAINS
    )
    return 0 if stable else 1


if __name__ == "__main__":
    sys.exit(main())
