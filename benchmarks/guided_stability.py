"""Whether virtual drivers and guidance, who hold one wheel, make it swing.

    python -m benchmarks.guided_stability [FIGURE.svg] [--drivers 40] [--runs 40]

Prints for three cars at 50 to 110 km/h, strong guidance at full gain: least damping
ratio of the linear loop over so many drivers and its frequency, with K_theta constant
and as it is, rising with the speed. For the first of them (`--runs` in the default car,
`--others` in the other two, 40 each), as it is, from 20 s after a start beside the aim:
largest amplitude of the wheel and largest share of its motion that is found again a
period later, without dry friction and noise (free) and with both (driven), and the
hunting with dry friction alone. How many swing, by any of these looks. Writes the
figure of docs/stability.md where a file is named. Exit code 1 if a driver swings with
the guidance as it is.
"""

from __future__ import annotations

import argparse
import sys
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.drivers.population import participant_driver
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
from costeer.validation.guided import (
    CONSTANT,
    Guided,
    guided_drivers,
    least_damping,
    swinging,
)
from costeer.validation.stability import SPEEDS
from costeer.validation.swing import LEAST_DAMPING, MOST_KEPT

SEED = 101
NUM_DRIVERS = 40

SERIES = {"constant": CONSTANT, "rising with the speed": ()}
STYLES = {
    "constant": ("#D55E00", "--", "s"),
    "rising with the speed": ("#0072B2", "-", "o"),
}

HEADER = (
    "car      km/h  drivers  run  K constant: damping  below 0.1  as it is: damping  "
    "at rad/s  below 0.1  free: deg  kept  driven: deg  kept  hunting: deg    m  "
    "swinging"
)


class Looked(NamedTuple):
    """One car at one speed.

    Attributes:
        constant: Least damping ratio of each driver with K_theta constant [-].
        damping: The same with K_theta as it is [-].
        frequency: Of that swing [rad/s].
        found: The runs, and the loops of those who were run.
    """

    constant: NDArray[np.float64]
    damping: NDArray[np.float64]
    frequency: NDArray[np.float64]
    found: Guided


Table = dict[str, list[Looked]]


def looked_at(car: str, speed: float, number: int, runs: int) -> Looked:
    """So many drivers of the linear loop, the first of them in the simulation."""
    drivers = [participant_driver(SEED, n + 1, speed) for n in range(number)]
    constant, _ = least_damping(drivers, car, speed, CONSTANT)
    damping, frequency = least_damping(drivers, car, speed)
    found = guided_drivers(SEED, drivers[:runs], car, speed)
    return Looked(constant, damping, frequency, found)


def num_swinging(looked: Looked) -> int:
    """How many drivers swing, those who were not run by their linear loop."""
    slow = looked.damping < LEAST_DAMPING
    slow[: looked.found.hunting.size] |= swinging(looked.found)
    return int(np.count_nonzero(slow))


def line(looked: Looked) -> str:
    """One row of the table."""
    found, worst = looked.found, int(looked.damping.argmin())
    free, driven = found.free, found.driven
    return (
        f"{found.car:8s} {found.speed * 3.6:4.0f} {looked.damping.size:8d} "
        f"{found.hunting.size:4d} {looked.constant.min():20.2f} "
        f"{np.count_nonzero(looked.constant < LEAST_DAMPING):10d} "
        f"{looked.damping[worst]:18.2f} {looked.frequency[worst]:9.1f} "
        f"{np.count_nonzero(looked.damping < LEAST_DAMPING):10d} "
        f"{np.degrees(np.max(free.amplitude)):10.3f} {np.max(free.kept):5.2f} "
        f"{np.degrees(np.max(driven.amplitude)):12.2f} {np.max(driven.kept):5.2f} "
        f"{np.degrees(found.hunting.max()):13.2f} {found.drift.max():4.2f} "
        f"{num_swinging(looked):9d}"
    )


def draw_damping(axes: Axes, looked: list[Looked]) -> None:
    """Least damping ratio over the speed, K_theta constant and as it is."""
    for name, (colour, dashes, marker) in STYLES.items():
        series = "constant" if name == "constant" else "damping"
        axes.plot(
            [each.found.speed * 3.6 for each in looked],
            [getattr(each, series).min() for each in looked],
            color=colour,
            linestyle=dashes,
            marker=marker,
            markersize=4.0,
        )
    axes.axhline(LEAST_DAMPING, color=INK, linewidth=0.6, zorder=1.0)
    axes.set_ylim(-0.1, 0.5)
    axes.tick_params(labelbottom=False)


def draw_kept(axes: Axes, looked: list[Looked]) -> None:
    """What of the wheel's motion is found again, median and span over the drivers."""
    colour, dashes, marker = STYLES["rising with the speed"]
    kept = [np.percentile(each.found.driven.kept, [0, 50, 100]) for each in looked]
    low, middle, high = np.array(kept).T
    axes.errorbar(
        [each.found.speed * 3.6 for each in looked],
        middle,
        np.array([middle - low, high - middle]),
        color=colour,
        linestyle=dashes,
        marker=marker,
        markersize=4.0,
        elinewidth=0.8,
        capsize=2.0,
    )
    axes.axhline(MOST_KEPT, color=INK, linewidth=0.6, zorder=1.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("Speed [km/h]")


def drawn(table: Table) -> Figure:
    """One column a car."""
    figure = new_figure(FULL_WIDTH_MM, 90.0)
    grid = panels(figure, 2, 3, Margins(left=14.0, top=12.0, right=4.0))
    for column, car in enumerate(CARS):
        grid[0][column].set_title(f"{car.capitalize()} car")
        draw_damping(grid[0][column], table[car])
        draw_kept(grid[1][column], table[car])
        for row in (0, 1):
            axes = grid[row][column]
            axes.set_xlim(46.0, 114.0)
            axes.set_xticks([50, 70, 90, 110])
            axes.grid(color=RULE, linewidth=0.4)
            axes.tick_params(labelleft=column == 0)
    labels = ("Least damping [-]", "Found again [-]")
    for row_of, letter, label in zip(grid, "ab", labels, strict=True):
        row_of[0].set_ylabel(label)
        panel_letter(row_of[0], letter)
    keys = [
        Line2D([], [], color=colour, linestyle=dashes, marker=marker, markersize=4.0)
        for colour, dashes, marker in STYLES.values()
    ]
    names = [f"$K_θ$ {name}" for name in STYLES]
    figure.legend(keys, names, loc="upper center", ncols=2)
    return figure


def main() -> int:
    """Print, draw, and return 1 if a driver swings with the guidance as it is."""
    parser = argparse.ArgumentParser(prog="benchmarks.guided_stability")
    parser.add_argument("figure", type=Path, nargs="?")
    parser.add_argument("--drivers", type=int, default=NUM_DRIVERS)
    parser.add_argument("--runs", type=int, default=NUM_DRIVERS)
    parser.add_argument("--others", type=int, default=NUM_DRIVERS)
    asked = parser.parse_args()
    print(f"drivers of seed {SEED}\n{HEADER}")
    table: Table = {car: [] for car in CARS}
    for car, speed in product(CARS, SPEEDS):
        runs = asked.runs if car == "default" else asked.others
        table[car].append(looked_at(car, speed, asked.drivers, runs))
        print(line(table[car][-1]), flush=True)
    if asked.figure is not None:
        title = "Damping and repetition of drivers with guidance, over the speed"
        with styled():
            text = svg_text(drawn(table), "guided-stability", title)
        asked.figure.write_text(text, "utf-8")
    return int(any(num_swinging(each) for looked in table.values() for each in looked))


if __name__ == "__main__":
    sys.exit(main())
