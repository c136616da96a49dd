"""When a signal passes a level: the line between the lanes, a threshold of yaw.

Instants between two samples are interpolated, so that they hardly depend on the
sampling rate.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    Flags,
    MeasureParameters,
    Signal,
)

LEFT = 1
RIGHT = -1


class Crossing(NamedTuple):
    """The centre of gravity crosses the line between the lanes.

    Attributes:
        time: When [s].
        direction: -1 to the right, +1 to the left.
    """

    time: float
    direction: int


def line_crossings(
    columns: Columns, parameters: MeasureParameters = DEFAULTS
) -> tuple[Crossing, ...]:
    """Where the centre of gravity crosses the line between the lanes."""
    time, offset = columns["time"], _beyond_line(columns, parameters)
    rows = np.flatnonzero(np.diff(offset >= 0.0))
    return tuple(
        Crossing(
            time=_instant(time, offset, int(row), 0.0),
            direction=LEFT if offset[row + 1] >= 0.0 else RIGHT,
        )
        for row in rows
    )


def _beyond_line(columns: Columns, parameters: MeasureParameters) -> Signal:
    """Distance to the left of the line between the lanes [m], shape `(time,)`."""
    return np.asarray(columns["lateral_position"] + parameters.lane_width / 2.0)


def in_left_lane(columns: Columns, parameters: MeasureParameters = DEFAULTS) -> Flags:
    """Samples with the centre of gravity in the left lane, shape `(time,)`."""
    return np.asarray(_beyond_line(columns, parameters) >= 0.0)


def _instant(time: Signal, signal: Signal, row: int, level: float) -> float:
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
        start = _instant(time, signal, int(below[place - 1]), threshold)
    if place < below.size:
        end = _instant(time, signal, int(below[place]) - 1, threshold)
    return start, end


def within(time: Signal, start: float, end: float) -> slice:
    """The rows from one instant to another, both included."""
    first = int(np.searchsorted(time, start, side="left"))
    return slice(first, int(np.searchsorted(time, end, side="right")))
