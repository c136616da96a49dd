"""Glances before manoeuvres (set `brain4cars_head`, Jain et al. 2015).

Head yaw in the 6 s before a wheel touches the line, and in 6 s of going straight, in
right-hand traffic. Their lane change to the left, towards the overtaking lane, is our
OUT (to the right in left-hand traffic), theirs to the right our BACK. The camera does
not look straight ahead, so yaw counts from the window's median; a window needs the
head tracked in 70 % of its frames.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.base.array import Real
from costeer.study.definitions import Signal
from costeer.validation.people.findings import Values
from costeer.validation.people.folder import (
    Columns,
    Table,
    groups,
    read_table,
    table_path,
)

OUT = 0
BACK = 1

GLANCE_ANGLES = (0.30, 0.25)
"""Least head yaw of a glance OUT and BACK [rad]; of the set's description. The mirror
on the passenger's side is seen with less yaw of the head."""

SHOULDER_ANGLE = 0.60
"""Head yaw of a look over the shoulder [rad]. Source: assumed; a mirror needs less."""

LEAST_TRACKED = 0.7
"""Share of a window's frames in which the head must be tracked [-]."""

_COLUMNS = Columns(numbers=("t", "yaw"), texts=("label", "sample"))
# Yaw is negative to the driver's left in this set.
_SIGNS = (-1.0, 1.0)


class Look(NamedTuple):
    """What the head did towards one side in a window.

    Attributes:
        glanced: 1 if the yaw reached that of a glance, else 0 [-].
        lead: From the first of these samples to the end of the window [s]; NaN if
            there was none.
        peak: Largest yaw to that side [rad].
    """

    glanced: Real
    lead: Real
    peak: Real


UNSEEN = Look(math.nan, math.nan, math.nan)
"""Of a window in which the head was hardly tracked."""


class PeopleGlances(NamedTuple):
    """Looks of people, OUT and BACK.

    Attributes:
        before: A look per lane change to that side, for both sides.
        straight: 1 per window of going straight with a glance to a side, both sides
            one after the other, shape `(window,)` [-].
    """

    before: tuple[list[Look], list[Look]]
    straight: Values


def look(time: Signal, yaw: Signal, angle: Real) -> Look:
    """What the head did towards a side in one window.

    Args:
        time: From any instant, shape `(time,)` [s].
        yaw: Towards the side; NaN where the head was not tracked, shape `(time,)`
            [rad].
        angle: Least yaw of a glance [rad].

    Returns:
        `UNSEEN` if the head was tracked in too few frames.
    """
    tracked = np.isfinite(yaw)
    if not tracked.size or tracked.mean() < LEAST_TRACKED:
        return UNSEEN
    towards = np.where(tracked, yaw - np.median(yaw[tracked]), -np.inf)
    reached = np.flatnonzero(towards >= angle)
    lead = float(time[-1] - time[reached[0]]) if reached.size else math.nan
    return Look(float(reached.size > 0), lead, float(towards.max()))


def glances(folder: Path | None) -> PeopleGlances:
    """Looks in all windows with a tracked head; none if the set is absent.

    Args:
        folder: With the sets.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "brain4cars_head")
    if path is None:
        return PeopleGlances(([], []), np.empty(0))
    table = read_table(path, _COLUMNS)
    straight = [_looks(table, "end_action", side) for side in (OUT, BACK)]
    return PeopleGlances(
        before=(_looks(table, "lchange", OUT), _looks(table, "rchange", BACK)),
        straight=np.array([each.glanced for looks in straight for each in looks]),
    )


def _looks(table: Table, label: str, side: int) -> list[Look]:
    """Looks to one side in all windows of one label."""
    here = np.flatnonzero(table["label"] == label)
    found = [
        look(
            table["t"][here[rows]],
            _SIGNS[side] * table["yaw"][here[rows]],
            GLANCE_ANGLES[side],
        )
        for rows in groups(table["sample"][here])
    ]
    return [each for each in found if math.isfinite(each.peak)]
