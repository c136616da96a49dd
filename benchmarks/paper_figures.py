"""Figs. 1, 7 and 8 of the paper as costeer has them, drawn from what it runs.

    python -m benchmarks.paper_figures FOLDER

Writes `paper_loop.svg` (the stages of the controller and what goes between them),
`paper_course.svg` (the course, and one overtaking with and without guidance) and
`paper_session.svg` (the session of the shipped plan, in the orders of six participants)
into the folder.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Rectangle

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    RULE,
    SHADE,
    SMALL,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.records.record import TrialRecord
from costeer.sessions.plan import Step, session_steps
from costeer.sessions.plan_file import paper_plan_text, parsed_plan
from costeer.study.figures.colours import condition_colour

ORDERS = 6
"""Rows of the Williams square of six assisted conditions."""

PARTICIPANT, CONDITION = 1, "strong-normal"
"""Who is shown on the course; fixed before anything was looked at: the first driver,
and the condition in the middle of Table IV."""


class Box(NamedTuple):
    """A block of the loop.

    Attributes:
        name: What it is.
        source: Equation or section of the paper.
        module: File of the controller, empty outside it.
        place: Column and row of its middle.
    """

    name: str
    source: str
    module: str
    place: tuple[float, float]


BOXES = (
    Box("Driver", "τ_dr", "", (0.0, 1.0)),
    Box("Steering column\nand car", "Table II", "", (1.0, 0.0)),
    Box("Intention", "Eqs. (1), (2)", "inference", (1.0, 2.0)),
    Box("Mode and path", "Eq. (3)", "trajectory", (2.0, 2.0)),
    Box("Preview", "Fig. 4", "preview", (3.0, 2.0)),
    Box("Torque", "Eqs. (4), (5)", "guidance", (4.0, 2.0)),
    Box("Consistency", "Eqs. (7) to (9)", "consistency", (4.0, 1.0)),
    Box("Gain", "Eqs. (10) to (13)", "strength", (3.0, 1.0)),
    Box("Re-planning", "Sec. II-E", "replanning", (2.0, 1.0)),
    Box("Applied torque", "Eq. (6)", "actuation", (3.0, 0.0)),
)


class Arrow(NamedTuple):
    """From one point to the next, in columns and rows, with a word beside it."""

    points: tuple[tuple[float, float], ...]
    word: str = ""
    at: tuple[float, float] = (0.0, 0.0)


WIDE, HIGH = 0.36, 0.25
"""Half of a box, in columns and rows."""

ARROWS = (
    Arrow(((0, 1 + HIGH), (0, 2), (1 - WIDE, 2)), "head", (0.3, 2.06)),
    Arrow(((0, 1 - HIGH), (0, 0), (1 - WIDE, 0)), "hands, τ_dr", (0.3, 0.06)),
    Arrow(((1, HIGH), (1, 2 - HIGH)), "motion of the car", (1.04, 1.0)),
    Arrow(((1 + WIDE, 2), (2 - WIDE, 2)), "trigger", (1.5, 2.06)),
    Arrow(((2 + WIDE, 2), (3 - WIDE, 2)), "path", (2.5, 2.06)),
    Arrow(((3 + WIDE, 2), (4 - WIDE, 2)), "errors", (3.5, 2.06)),
    Arrow(((4, 2 - HIGH), (4, 1 + HIGH)), "τ_hapi", (4.04, 1.5)),
    Arrow(((4 - WIDE, 1), (3 + WIDE, 1)), "verdict", (3.5, 1.06)),
    Arrow(((3 - WIDE, 1), (2 + WIDE, 1)), "K_h", (2.5, 1.06)),
    Arrow(((2, 1 + HIGH), (2, 2 - HIGH)), "plan anew", (2.04, 1.5)),
    Arrow(((3, 1 - HIGH), (3, HIGH)), "K_h", (3.04, 0.5)),
    Arrow(((4 + WIDE, 2), (4.55, 2), (4.55, 0), (3 + WIDE, 0)), "τ_hapi", (4.1, 0.06)),
    Arrow(((3 - WIDE, 0), (1 + WIDE, 0)), "τ_hapa", (2.0, 0.06)),
)  # fmt: skip


LEGEND = (
    "Shaded: the controller, with its files. Each of them reads the measured motion of "
    "the car, Consistency also τ_dr."
)


def draw_loop() -> Figure:
    """Fig. 1: the blocks of the system, each with its file."""
    figure = new_figure(FULL_WIDTH_MM, 78.0)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-0.5, 4.7), ylim=(-0.45, 2.45))
    axes.axis("off")
    for box in BOXES:
        draw_box(axes, box)
    for arrow in ARROWS:
        for start, end in zip(arrow.points[:-1], arrow.points[1:], strict=True):
            head = "-|>" if end == arrow.points[-1] else "-"
            style = {"arrowstyle": head, "color": INK, "lw": 0.8, "shrinkA": 0.0}
            axes.annotate("", end, start, arrowprops={**style, "shrinkB": 0.0})
        side = "left" if arrow.points[0][0] == arrow.points[-1][0] else "center"
        axes.text(*arrow.at, arrow.word, ha=side, va="bottom", size=SMALL)
    axes.text(2.0, -0.42, LEGEND, ha="center", va="bottom", size=SMALL)
    return figure


def draw_box(axes: Axes, box: Box) -> None:
    """A block: name, source, file."""
    column, row = box.place
    colour = SHADE if box.module else "white"
    corner = (column - WIDE, row - HIGH)
    patch = FancyBboxPatch(
        corner, 2 * WIDE, 2 * HIGH, "round,pad=0,rounding_size=0.04",
        facecolor=colour, edgecolor=INK, linewidth=0.8,
    )  # fmt: skip
    axes.add_patch(patch)
    small = "\n".join(filter(None, (box.source, box.module and f"{box.module}.py")))
    axes.text(column, row + 0.21, box.name, ha="center", va="top", weight="bold")
    axes.text(column, row - 0.21, small, ha="center", va="bottom", size=SMALL)


def driven(condition: str) -> TrialRecord:
    """The participant's trial of the published study."""
    return simulate_trial(TrialSetup(participant=PARTICIPANT, condition=condition))


def draw_course(manual: TrialRecord, guided: TrialRecord) -> Figure:
    """Fig. 7: the course of 8 km, and its first overtaking."""
    figure = new_figure(FULL_WIDTH_MM, 92.0)
    margins = Margins(left=16.0, top=7.0, bottom=10.0, right=3.0, between_rows=16.0)
    (course,), (event,) = panels(figure, 2, 1, margins)
    for axes in (course, event):
        for line in (1.75, -1.75, -5.25):
            dashed = "--" if line == -1.75 else "-"
            axes.axhline(line, color=FAINT, linewidth=0.8, linestyle=dashed)
        axes.set(ylabel="Lateral position [m]", ylim=(-5.8, 2.3))
    for record, name in ((manual, "manual"), (guided, CONDITION)):
        colour = condition_colour(name)
        along = record.columns["longitudinal_position"]
        for axes in (course, event):
            axes.plot(
                along, record.columns["lateral_position"], color=colour, label=name
            )
    shade_events(course, manual)
    first, last = first_event(manual)
    event.set(xlim=(first - 50.0, last + 50.0), xlabel="Along the road [m]")
    course.set(xlim=(0.0, 8000.0))
    course.set_title(
        f"a  The course: driver {PARTICIPANT}, leaders in the shaded zones"
    )
    event.set_title("b  The first overtaking")
    course.legend(loc="lower right", ncol=2, bbox_to_anchor=(1.0, 1.0), borderpad=0.0)
    return figure


def zones(record: TrialRecord) -> list[tuple[float, float]]:
    """Where along the road each event begins and ends [m]."""
    inside = np.concatenate([[False], np.asarray(record.columns["event"]) > 0, [False]])
    along = record.columns["longitudinal_position"]
    starts = np.flatnonzero(~inside[:-1] & inside[1:])
    ends = np.flatnonzero(inside[:-1] & ~inside[1:]) - 1
    return [
        (float(along[a]), float(along[b])) for a, b in zip(starts, ends, strict=True)
    ]


def first_event(record: TrialRecord) -> tuple[float, float]:
    """Where along the road the first event begins and ends [m]."""
    return zones(record)[0]


def shade_events(axes: Axes, record: TrialRecord) -> None:
    """Shade the zones of the events."""
    for start, end in zones(record):
        axes.axvspan(start, end, color=SHADE, zorder=0)


WORDS = {
    "consent": "consent",
    "demographics": "survey",
    "nasa-tlx": "TLX",
    "practise": "practice",
    "break": "break",
    "instruct": "text",
}


def word_of(step: Step) -> str:
    """What stands in the cell of a step."""
    if step.kind == "drive":
        return step.condition.replace("-", "\n")
    return WORDS[step.instrument or step.kind]


def is_light(colour: str) -> bool:
    """Whether dark type reads better on it."""
    return float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114))) > 0.55


def draw_session(orders: Sequence[Sequence[Step]]) -> Figure:
    """Fig. 8: what participants do, one row for each order."""
    figure = new_figure(FULL_WIDTH_MM, 74.0)
    axes = figure.add_axes((0.055, 0.02, 0.94, 0.90))
    axes.set(xlim=(0.0, max(map(len, orders))), ylim=(len(orders), 0.0))
    axes.axis("off")
    for row, steps in enumerate(orders):
        axes.text(-0.2, row + 0.5, f"P{row + 1:02d}", ha="right", va="center")
        for place, step in enumerate(steps):
            drives = step.kind == "drive"
            colour = condition_colour(step.condition) if drives else "white"
            cell = Rectangle(
                (place + 0.03, row + 0.06), 0.94, 0.88,
                facecolor=colour, edgecolor=RULE, linewidth=0.6,
            )  # fmt: skip
            axes.add_patch(cell)
            axes.text(
                place + 0.5, row + 0.5, word_of(step), rotation=90, size=SMALL,
                color=INK if is_light(colour) else "white", ha="center", va="center",
            )  # fmt: skip
    axes.set_title("Steps of a session, from left to right; coloured: trials of 8 km")
    return figure


def sessions() -> list[list[Step]]:
    """The steps of the shipped plan for each order, without the end."""
    plan = parsed_plan(paper_plan_text())
    return [list(session_steps(plan, slot))[:-1] for slot in range(1, ORDERS + 1)]


def main(folder: Path) -> None:
    """Write the three figures."""
    folder.mkdir(parents=True, exist_ok=True)
    made = {
        "paper_loop": ("The guidance as blocks", draw_loop),
        "paper_course": (
            "The course and one overtaking",
            lambda: draw_course(driven("manual"), driven(CONDITION)),
        ),
        "paper_session": ("A session with people", lambda: draw_session(sessions())),
    }
    for name, (title, draw) in made.items():
        with styled():
            text = svg_text(draw(), name, title)
        (folder / f"{name}.svg").write_text(text, "utf-8")
        print(folder / f"{name}.svg")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
