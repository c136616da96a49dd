"""Lanes of the road that a record was driven on: numbers, centres, lines between.

Lanes count from the right, 0 first; lateral positions are from the left lane's centre,
left positive. The outer lanes reach outwards without end.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.study.definitions import Columns, Flags, MeasureParameters, Signal


def lines(parameters: MeasureParameters) -> list[float]:
    """Distance of each line between two lanes from the left lane's centre [m].

    To the right, the leftmost line first.
    """
    between = range(int(parameters.num_lanes) - 1)
    return [(place + 0.5) * parameters.lane_width for place in between]


def lanes(position: Signal, parameters: MeasureParameters) -> NDArray[np.int64]:
    """Number of the lane at lateral positions [m], shape `(time,)`."""
    from_left = sum(
        (np.asarray(position + line < 0.0, np.int64) for line in lines(parameters)),
        np.zeros(np.shape(position), np.int64),
    )
    return np.asarray(int(parameters.num_lanes) - 1 - from_left)


def centre(parameters: MeasureParameters, lane: int) -> float:
    """Lateral position of a lane's centre [m]."""
    return (lane - (int(parameters.num_lanes) - 1)) * parameters.lane_width


def centres(parameters: MeasureParameters, lane: NDArray[np.int64]) -> Signal:
    """Lateral position of the centre of the lane at each sample [m], `(time,)`."""
    from_left = lane - (int(parameters.num_lanes) - 1)
    return np.asarray(from_left * parameters.lane_width, np.float64)


def from_centre(position: Signal, parameters: MeasureParameters) -> Signal:
    """Distance to the left of the centre of the lane one is in [m], `(time,)`."""
    return np.asarray(position - centres(parameters, lanes(position, parameters)))


def home_lane(parameters: MeasureParameters) -> int:
    """The lane that is driven in when nobody is overtaken."""
    return int(parameters.num_lanes) - 1 if parameters.overtaking_side < 0.0 else 0


def adjacent_side(parameters: MeasureParameters, lane: int) -> int:
    """Side to which the inference of the intention looks in a lane: -1 right, +1 left.

    The overtaking side, unless the lane is the outermost of that side.
    """
    side = 1 if parameters.overtaking_side > 0.0 else -1
    return side if 0 <= lane + side < int(parameters.num_lanes) else -side


def keeps_home(parameters: MeasureParameters) -> bool:
    """Whether lane keeping counts in one lane alone.

    On two lanes it does: the other one is for overtaking. With more lanes people may
    keep any, and lane keeping is measured in that which is driven in.
    """
    return not parameters.any_lane and int(parameters.num_lanes) == 2


def in_kept_lane(columns: Columns, parameters: MeasureParameters) -> Flags:
    """Samples in a lane in which lane keeping counts, shape `(time,)`."""
    position = columns["lateral_position"]
    if not keeps_home(parameters):
        return np.ones(len(position), bool)
    return np.asarray(lanes(position, parameters) == home_lane(parameters))
