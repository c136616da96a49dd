"""The report on emergencies: page, tables, figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from costeer.base.files import write_text
from costeer.drivers.population import POPULATION_VERSION
from costeer.emergencies.design import SITUATIONS, SPEEDS, TIMES, Settings
from costeer.emergencies.figures import behaviour, collisions, conditions_of
from costeer.emergencies.outcome import EmergencyRow
from costeer.emergencies.run import WORST, worst_name, worst_of, write_outcome
from costeer.methods.conditions import MANUAL
from costeer.methods.registry import method_named
from costeer.pages.frame import Section, picture, render_page, write_figures
from costeer.pages.numerals import plural
from costeer.pages.style import styled
from costeer.pages.tables import Table, versions_table

REPORT_FILE = "report.html"

_CAUTION = (
    "These are virtual drivers.",
    "Their evasive manoeuvre was set on manual driving: a prediction, which people "
    "must test.",
)

Rows = Sequence[EmergencyRow]


def write_report(folder: Path, settings: Settings, rows: Rows) -> Path:
    """Write `report.html`, `emergencies.csv`, `figures/` and the worst records.

    Args:
        folder: Of `run.prepare`.
        settings: As they were driven.
        rows: All drives.

    Returns:
        Path of the page.

    Raises:
        OSError: If a file cannot be written.
    """
    write_outcome(folder, settings, rows)
    with styled():
        pictures = [picture(collisions(rows)), picture(behaviour(rows))]
    write_figures(folder / "figures", pictures)
    sections = (
        Section(
            "collisions",
            "Collisions",
            (
                "What a drive was meant to come to is planned; what it came to is read "
                "from mode and verdict when the obstacle appeared.",
            ),
            (pictures[0], _collision_table(rows), _situation_table(rows)),
        ),
        Section(
            "behaviour",
            "Drivers and guidance",
            (),
            (pictures[1], _behaviour_table(rows)),
        ),
        Section("worst", "The worst cases", _worst_words(rows), (_worst_table(rows),)),
        Section("made", "How this was made", (), (versions_table(),)),
    )
    words = {
        "title": "Emergencies",
        "heading": "Emergencies with shared steering",
        "subtitle": f"costeer, population {POPULATION_VERSION}, seed {settings.seed}",
        "looked_at": _looked_at(settings, rows),
        "outcomes": _outcomes(rows),
        "caution": _CAUTION,
    }
    write_text(folder / REPORT_FILE, render_page("judgement.html", sections, words))
    return folder / REPORT_FILE


def _looked_at(settings: Settings, rows: Rows) -> list[str]:
    speeds = " and ".join(f"{each * 3.6:.0f}" for each in SPEEDS)
    times = ", ".join(f"{each:g}" for each in TIMES)
    return [
        f"{plural(settings.drivers, 'virtual driver')} at {speeds} km/h, {len(rows)} "
        "drives. What a drive was meant to come to is not always what it came to.",
        f"An obstacle half a lane wide appeared {times} s ahead, in the lane driven in "
        "or changed to; in half of the drives a car drove in the other lane.",
        f"Conditions: {', '.join(conditions_of(rows))}; method {_method(settings)}.",
        *_never_reached(rows),
    ]


def _method(settings: Settings) -> str:
    """Name and version of the method, wherever its file is."""
    method = method_named(settings.method)
    return f"{method.name} {method.version}"


def _never_reached(rows: Rows) -> list[str]:
    """What the method makes of no drive: it may start no lane change, or not judge."""
    assisted = [row for row in rows if row.situation]
    lacking = sorted(
        {row.meant_situation for row in assisted} - {row.situation for row in assisted}
    )
    if not lacking:
        return []
    told = ", ".join(f"({number})" for number in lacking)
    return [
        f"No drive came to {told}: the method starts no lane change there, or gives no "
        "verdict. Rows of such a situation show how drivers fared without."
    ]


def _share(rows: Rows) -> str:
    hit = sum(row.collided for row in rows)
    return f"{hit} of {len(rows)}" if rows else "–"


def _outcomes(rows: Rows) -> list[tuple[str, str]]:
    """Collisions of all conditions side by side, for each situation."""
    told = []
    for number, words in SITUATIONS.items():
        parts = []
        for name in conditions_of(rows):
            own = [
                row
                for row in rows
                if (row.condition, row.meant_situation) == (name, number)
            ]
            if own:
                parts.append(f"{name} {_share(own)}")
        if parts:
            told.append((f"Collisions, meant as ({number}) {words}", "; ".join(parts)))
    return told


def _collision_table(rows: Rows) -> Table:
    cells = []
    for name in conditions_of(rows):
        for number, words in SITUATIONS.items():
            own = [
                r for r in rows if (r.condition, r.meant_situation) == (name, number)
            ]
            if not own:
                continue
            for is_free in (True, False):
                some = [r for r in own if r.lane_is_free == is_free]
                shares = [
                    _share([r for r in some if r.time_to_collision == time])
                    for time in TIMES
                ]
                beside = "free" if is_free else "a car"
                cells.append((name, f"({number}) {words}", beside, *shares))
    return Table(
        name="collision-table",
        title="Collisions by condition, situation and time to collision",
        note="Both speeds together.",
        header=(
            "Condition",
            "Meant situation",
            "Lane beside",
            *(f"{time:g} s" for time in TIMES),
        ),
        rows=tuple(cells),
        num_labels=3,
    )


def _situation_table(rows: Rows) -> Table:
    cells = []
    for name in conditions_of(rows):
        if name == MANUAL:
            continue
        for meant in SITUATIONS:
            own = [r for r in rows if (r.condition, r.meant_situation) == (name, meant)]
            counts = [str(sum(r.situation == each for r in own)) for each in SITUATIONS]
            cells.append((name, f"({meant})", *counts))
    return Table(
        name="situations",
        title="Situations that the drives came to",
        note="By mode and verdict of the guidance when the obstacle appeared.",
        header=("Condition", "Meant", *(f"came to ({each})" for each in SITUATIONS)),
        rows=tuple(cells),
        num_labels=2,
    )


def _median(values: Sequence[float], factor: float = 1.0, digits: int = 2) -> str:
    known = [factor * value for value in values if np.isfinite(value)]
    return f"{np.median(known):.{digits}f}" if known else "–"


_DEGREES = 180.0 / np.pi

_BEHAVIOUR = (
    ("reaction_time", "Reaction [s]", 1.0, 2),
    ("smallest_distance", "Smallest distance [m]", 1.0, 2),
    ("smallest_time", "Smallest time [s]", 1.0, 2),
    ("peak_wheel_angle", "Peak angle [°]", _DEGREES, 0),
    ("peak_wheel_rate", "Peak rate [°/s]", _DEGREES, 0),
    ("peak_driver_torque", "Peak torque [N·m]", 1.0, 1),
    ("haptic_gain", "Gain at appearance", 1.0, 2),
    ("gain_at_obstacle", "Gain at obstacle", 1.0, 2),
    ("time_to_settle", "Settled after [s]", 1.0, 1),
)
"""Columns of the table: measure, heading, factor and digits."""


def _behaviour_table(rows: Rows) -> Table:
    cells = []
    for name in conditions_of(rows):
        for number in SITUATIONS:
            own = [
                r for r in rows if (r.condition, r.meant_situation) == (name, number)
            ]
            if own:
                medians = [
                    _median([getattr(r, measure) for r in own], factor, digits)
                    for measure, _, factor, digits in _BEHAVIOUR
                ]
                outside = f"{sum(r.left_road for r in own)} of {len(own)}"
                cells.append((name, f"({number})", *medians, outside))
    headings = [heading for _, heading, _, _ in _BEHAVIOUR]
    return Table(
        name="behaviour-table",
        title="Medians over drives",
        note="A driver who never settled has no time to settle.",
        header=("Condition", "Situation", *headings, "Over the outer line"),
        rows=tuple(cells),
        num_labels=2,
    )


def _worst_words(rows: Rows) -> tuple[str, ...]:
    if not worst_of(rows):
        return ("Nobody hit anything.",)
    return (
        "Of each condition and situation, the collision that had the most time. "
        f"To replay one: costeer replay {WORST}/NAME.",
    )


def _worst_table(rows: Rows) -> Table:
    cells = [
        (
            worst_name(row),
            row.hit,
            f"{row.speed * 3.6:.0f}",
            f"{row.time_to_collision:g}",
            _median([row.reaction_time]),
            _median([row.haptic_gain]),
        )
        for row in worst_of(rows)
    ]
    return Table(
        name="worst-table",
        title="Records of the worst cases",
        note="",
        header=(
            "Record",
            "Hit",
            "Speed [km/h]",
            "Time left [s]",
            "Reaction [s]",
            "K_h",
        ),
        rows=tuple(cells),
        num_labels=2,
    )
