"""What ends a trial: its road, its time, a collision, or a car that stands for good.

A driver who has stopped behind an obstacle has no room to steer past it without
reversing, which no driver here does. So the trial ends, and its record says so.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.loop.parameters import DT
from costeer.plant.place import BARRIER
from costeer.records.metadata import ARRIVED, COLLISION, OUT_OF_TIME, STOPPED
from costeer.records.row import ROW_COLUMNS

STANDS = 0.1
"""A car that is slower stands [m/s]. Source: assumed."""

STOPPED_AFTER = 30.0
"""A trial ends when its car has stood for so long [s]. Source: assumed, longer than
those that queue need to get past an obstacle one after the other."""

_PLACE = ROW_COLUMNS.index("longitudinal_position")
_SPEED = ROW_COLUMNS.index("longitudinal_velocity")
_CONTACT = ROW_COLUMNS.index("contact")

Rows = NDArray[np.float64]


@compiled
def still(standing: Real, velocity: Real) -> Real:
    """For how long the car has stood after a step [s].

    Args:
        standing: For how long it had before [s].
        velocity: At this step [m/s].
    """
    return xp.select(velocity < STANDS, standing + DT, 0.0)


@compiled
def has_stopped(standing: Real) -> Flag:
    """Whether who has stood for so long [s] will not drive on."""
    return standing >= STOPPED_AFTER - DT / 2.0


def stopped_rows(rows: Rows) -> NDArray[np.bool_]:
    """Rows at which a car has stood for so long that its trial ends, `(time,)`.

    Args:
        rows: In the order of `ROW_COLUMNS`, shape `(time, column)`.
    """
    here = np.arange(len(rows))
    moved = np.maximum.accumulate(np.where(rows[:, _SPEED] < STANDS, -1, here))
    return np.asarray(here - moved >= round(STOPPED_AFTER / DT))


def outcome_of(rows: Rows, length: Real) -> str:
    """How a trial ended, one of `records.metadata.OUTCOMES`.

    Args:
        rows: Of the whole trial, shape `(time, column)`.
        length: Of the course [m].
    """
    last = rows[-1]
    if last[_CONTACT] >= BARRIER:
        return COLLISION
    if stopped_rows(rows)[-1]:
        return STOPPED
    # The step after the last row is the one that arrives.
    reached = last[_PLACE] + 2.0 * DT * last[_SPEED] >= length
    return ARRIVED if reached else OUT_OF_TIME
