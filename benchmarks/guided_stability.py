"""Whether virtual drivers and guidance, who hold one wheel, make it swing.

    python -m benchmarks.guided_stability [FIGURE.svg] [--drivers 40]

Prints for three cars at 50 to 110 km/h, strong guidance at full gain: least damping
ratio of the linear loop over so many drivers, its frequency, the largest amplitude of
the wheel 40 s after a start beside the aim; first with K_theta constant, then as it is,
rising with the speed. Writes the figure of docs/stability.md where a file is named.
Exit code 1 if a driver swings with the guidance as it is.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

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
    LEAST_DAMPING,
    Guided,
    guided_drivers,
    swinging,
)
from costeer.validation.stability import SPEEDS

SEED = 101
NUM_DRIVERS = 40

SERIES = {"constant": CONSTANT, "rising with the speed": ()}
STYLES = {
    "constant": ("#D55E00", "--", "s"),
    "rising with the speed": ("#0072B2", "-", "o"),
}

Table = dict[str, dict[str, list[Guided]]]


def looked_at(number: int) -> Table:
    """Every car at every speed with so many drivers, for both forms of K_theta."""
    return {
        name: {
            car: [guided_drivers(SEED, number, car, v, values) for v in SPEEDS]
            for car in CARS
        }
        for name, values in SERIES.items()
    }


def print_table(table: Table) -> None:
    """One row for each car and speed."""
    for name, cars in table.items():
        print(f"\nK_theta {name}; drivers of seed {SEED}")
        print("drivers  car      km/h  damping ratio  at rad/s  wheel deg  swinging")
        for found in (each for speeds in cars.values() for each in speeds):
            worst = int(found.damping_ratio.argmin())
            print(
                f"{found.swing.size:7d}  {found.car:8s} {found.speed * 3.6:4.0f} "
                f"{found.damping_ratio[worst]:14.2f} {found.frequency[worst]:9.1f} "
                f"{np.degrees(found.swing.max()):10.2f} "
                f"{np.count_nonzero(swinging(found)):9d}"
            )


def draw(axes: Axes, table: Table, car: str, row: int) -> None:
    """Damping above, amplitude of the wheel below, over the speed."""
    for name, (colour, dashes, marker) in STYLES.items():
        found = table[name][car]
        damping = [each.damping_ratio.min() for each in found]
        swing = [float(np.degrees(each.swing.max())) for each in found]
        axes.plot(
            [each.speed * 3.6 for each in found],
            (damping, swing)[row],
            color=colour,
            linestyle=dashes,
            marker=marker,
            markersize=4.0,
        )
    axes.axhline((LEAST_DAMPING, 1.0)[row], color=INK, linewidth=0.6, zorder=1.0)
    axes.set_xlim(46.0, 114.0)
    axes.set_xticks([50, 70, 90, 110])
    axes.grid(color=RULE, linewidth=0.4)
    if row == 0:
        axes.set_ylim(-0.1, 0.5)
        axes.tick_params(labelbottom=False)
    else:
        axes.set_ylim(0.0, 1.2)
        axes.set_xlabel("Speed [km/h]")


def drawn(table: Table) -> Figure:
    """One column a car."""
    figure = new_figure(FULL_WIDTH_MM, 90.0)
    grid = panels(figure, 2, 3, Margins(left=14.0, top=12.0, right=4.0))
    for column, car in enumerate(CARS):
        grid[0][column].set_title(f"{car.capitalize()} car")
        for row in (0, 1):
            draw(grid[row][column], table, car, row)
            grid[row][column].tick_params(labelleft=column == 0)
    labels = ("Least damping [-]", "Wheel after 40 s [deg]")
    for line, letter, label in zip(grid, "ab", labels, strict=True):
        line[0].set_ylabel(label)
        panel_letter(line[0], letter)
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
    asked = parser.parse_args()
    table = looked_at(asked.drivers)
    print_table(table)
    if asked.figure is not None:
        title = "Damping and lasting swing of drivers with guidance, over the speed"
        with styled():
            text = svg_text(drawn(table), "guided-stability", title)
        asked.figure.write_text(text, "utf-8")
    now = table["rising with the speed"].values()
    return int(any(swinging(found).any() for speeds in now for found in speeds))


if __name__ == "__main__":
    sys.exit(main())
