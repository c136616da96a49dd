"""When a signal passes a level: a line between two lanes, a threshold of yaw.

Instants between two samples are interpolated, so that they hardly depend on the
sampling rate.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    MeasureParameters,
    Signal,
)
from costeer.study.lanes import lines

LEFT = 1
RIGHT = -1


class Crossing(NamedTuple):
    """The centre of gravity crosses a line between two lanes.

    Attributes:
        time: When [s].
        direction: -1 to the right, +1 to the left.
        lane: That it leads to, counted from the right.
    """

    time: float
    direction: int
    lane: int


def line_crossings(
    columns: Columns, parameters: MeasureParameters = DEFAULTS
) -> tuple[Crossing, ...]:
    """Where the centre of gravity crosses lines between lanes, in order of time."""
    found: list[Crossing] = []
    for place, line in enumerate(lines(parameters)):
        left = int(parameters.num_lanes) - 1 - place
        offset = np.asarray(columns["lateral_position"] + line)
        found += _crossings_of(columns["time"], offset, left)
    return tuple(sorted(found, key=lambda crossing: crossing.time))


def _crossings_of(time: Signal, offset: Signal, left: int) -> list[Crossing]:
    """Crossings of one line.

    Args:
        time: [s], shape `(time,)`.
        offset: Distance to the left of the line [m], shape `(time,)`.
        left: Number of the lane on its left.
    """
    rows = np.flatnonzero(np.diff(offset >= 0.0))
    leftward = [bool(offset[row + 1] >= 0.0) for row in rows]
    return [
        Crossing(
            time=passing(time, offset, int(row), 0.0),
            direction=LEFT if to_left else RIGHT,
            lane=left if to_left else left - 1,
        )
        for row, to_left in zip(rows, leftward, strict=True)
    ]


def passing(time: Signal, signal: Signal, row: int, level: float) -> float:
    """When a signal passes a level between a row and the next [s]."""
    before, after = signal[row] - level, signal[row + 1] - level
    share = before / (before - after)
    return float(time[row] + share * (time[row + 1] - time[row]))


def excursion(
    time: Signal, signal: Signal, threshold: float, instant: float
) -> tuple[float, float] | None:
    """Start and end [s] of the stretch above a threshold around an instant.

    Args:
        time: Sample times [s], shape `(time,)`.
        signal: Yaw or lateral speed towards the new lane, shape `(time,)`.
        threshold: Level it must exceed.
        instant: A time inside the stretch [s].

    Returns:
        Start and end; -inf or inf where the record begins or stops before. None if
        the signal does not exceed the threshold at the instant.
    """
    if np.interp(instant, time, signal) <= threshold:
        return None
    below = np.flatnonzero(signal <= threshold)
    place = int(np.searchsorted(below, np.searchsorted(time, instant)))
    start, end = -inf, inf
    if place > 0:
        start = passing(time, signal, int(below[place - 1]), threshold)
    if place < below.size:
        end = passing(time, signal, int(below[place]) - 1, threshold)
    return start, end


def within(time: Signal, start: float, end: float) -> slice:
    """The rows from one instant to another, both included."""
    first = int(np.searchsorted(time, start, side="left"))
    return slice(first, int(np.searchsorted(time, end, side="right")))
