"""What happens on stretches of the road: gusts, a lost head, lane changes to make."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.lookup import interval, rows_of

MOST_STRETCHES = 32
"""Stretches that a scenario may have."""


class Stretch(NamedTuple):
    """A part of the road on which something happens.

    Attributes:
        start: Along the road [m].
        end: [m].
        side_force: On the car in the middle of it, left positive; it rises from nothing
            at the start and is gone at the end [N].
        head_lost: 1 while the head tracker sees nothing [-].
        wanted_side: Of a lane change that the driver is to make, -1 right, +1 left, 0
            none [-].
    """

    start: Real = np.inf
    end: Real = np.inf
    side_force: Real = 0.0
    head_lost: Real = 0.0
    wanted_side: Real = 0.0


_ROWS = rows_of(Stretch())
_read_stretch, _WIDTH = _ROWS.read, _ROWS.width


class Stretches(NamedTuple):
    """All stretches of a road, in their order; they do not overlap.

    Attributes:
        num_stretches: In use [-]. Source: the scenario.
        table: A `Stretch` in each row, flat.
    """

    num_stretches: Real
    table: NDArray[np.float64]


def stretches(given: Sequence[Stretch]) -> Stretches:
    """The stretches of a road.

    Raises:
        ValueError: If there are too many, or two overlap.
    """
    ordered = sorted(given)
    if len(ordered) > MOST_STRETCHES:
        raise ValueError(f"there are {len(ordered)} events; give {MOST_STRETCHES}")
    for one, after in pairwise(ordered):
        if after.start < one.end:
            raise ValueError(
                f"the event at {after.start:g} m begins before the one at "
                f"{one.start:g} m has ended, at {one.end:g} m"
            )
    rows = [*ordered, *[Stretch()] * (MOST_STRETCHES - len(ordered))]
    return Stretches(float(max(len(ordered), 1)), np.array(rows).ravel())


NOTHING_HAPPENS = stretches(())
"""A road on which nothing happens."""


@compiled
def stretch_at(road: Stretches, position: Real) -> tuple[Stretch, Flag]:
    """The last stretch that began before a position [m], and whether it still lasts."""
    last: Stretch = _read_stretch(
        road.table, interval(road.table, _WIDTH, road.num_stretches, position)
    )
    return last, (position >= last.start) & (position < last.end)


@compiled
def side_force(stretch: Stretch, lasts: Flag, position: Real) -> Real:
    """Force of a gust on the car [N]: a rise and a fall without a corner.

    Args:
        stretch: With the gust.
        lasts: Whether the car is on it.
        position: Of the car along the road [m].
    """
    # No NaN in what is not taken: it would spoil gradients.
    reached = xp.select(lasts, position - stretch.start, 0.0)
    length = xp.select(lasts, stretch.end - stretch.start, 1.0)
    there = xp.clip(reached / length, 0.0, 1.0)
    rise = 4.0 * there * (1.0 - there)
    return stretch.side_force * rise * rise
