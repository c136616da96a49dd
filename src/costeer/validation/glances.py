"""Glances counted as in the recordings of real drivers (Jain et al. 2015).

A glance is a head yaw of at least 0.25 rad to a side. Before a lane change the 6 s
before the wheel touches the line are looked at, in straight driving windows of 6 s.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.records.columns import TrialRecord

GLANCE_ANGLE = 0.25
"""Least head yaw of a glance [rad]."""

HEAD_YAW_SCALE = math.pi / 2.0
"""Head yaw of 1 in a record [rad]."""

WINDOW = 6.0
"""Before a lane change, and of straight driving [s]."""


def _looks(head_yaw: NDArray[np.float64], side: int) -> NDArray[np.bool_]:
    """Samples with the head turned far enough to `side`."""
    return side * head_yaw * HEAD_YAW_SCALE >= GLANCE_ANGLE


def touching_time(record: TrialRecord, crossing_time: Real, direction: int) -> Real:
    """When the first wheel touched the line before a crossing [s]."""
    time = record.columns["time"]
    lateral = record.columns["lateral_position"]
    line = -RoadParameters().lane_width / 2.0
    edge = lateral + direction * CarParameters().width / 2.0
    before = time <= crossing_time
    inside = direction * (edge - line) < 0.0
    clear = np.flatnonzero(before & inside)
    return float(time[clear[-1]]) if clear.size else float(time[0])


def glance_before_change(record: TrialRecord, change: dict[str, Any]) -> float:
    """1 if the driver looked to that side in the 6 s before the wheel touched, else 0.

    Args:
        record: The trial.
        change: Row of the lane change, with `crossing_time` and `direction`.
    """
    time, looks, _ = _before_touching(record, change)
    return float(bool(time[looks].size))


def first_glance_lead(record: TrialRecord, change: dict[str, Any]) -> Real:
    """How long before the wheel touched the first of those glances was [s].

    Args:
        record: The trial.
        change: Row of the lane change, as above.

    Returns:
        NaN if there was none.
    """
    time, looks, touch = _before_touching(record, change)
    return float(touch - time[looks][0]) if looks.any() else math.nan


def _before_touching(
    record: TrialRecord, change: dict[str, Any]
) -> tuple[NDArray[np.float64], NDArray[np.bool_], Real]:
    """Times of the 6 s before the wheel touched, looks to that side, and the touch."""
    direction = int(change["direction"])
    touch = touching_time(record, change["crossing_time"], direction)
    time = record.columns["time"]
    window = (time > touch - WINDOW) & (time <= touch)
    return time[window], _looks(record.columns["head_yaw"][window], direction), touch


def false_glance_share(record: TrialRecord) -> Real:
    """Share of 6 s windows of straight driving with a glance to the adjacent lane [-].

    Straight driving: outside event zones, no lane change intended.
    """
    columns = record.columns
    quiet = (columns["event"] == 0) & (columns["driver_intention"] == 0)
    lane_side = np.where(columns["lane"] == 0, 1, -1)
    looks = lane_side * columns["head_yaw"] * HEAD_YAW_SCALE >= GLANCE_ANGLE
    length = round(WINDOW * 60.0)
    count = len(looks) // length
    quiet = np.asarray(quiet)[: count * length].reshape(count, length).all(axis=1)
    looked = looks[: count * length].reshape(count, length).any(axis=1)
    return float(looked[quiet].mean()) if quiet.any() else math.nan
