"""From one manual trial what the comparison with people needs, and no more."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from costeer.base.array import Real
from costeer.records.columns import TrialRecord
from costeer.study.crossings import RIGHT
from costeer.study.lane_keeping import lateral_speed
from costeer.validation.glances import HEAD_YAW_SCALE, WINDOW, touching_time
from costeer.validation.people.brain4cars import (
    BACK,
    GLANCE_ANGLES,
    OUT,
    Look,
    look,
)
from costeer.validation.people.drift import Drift, drift, record_windows
from costeer.validation.people.findings import Values
from costeer.validation.people.shape import (
    SHAPE_POINTS,
    ChangeMeasures,
    change_measures,
)
from costeer.validation.people.torque import record_reversal_rate, record_torque_levels

Row = dict[str, Any]  # Any: as the study's tables

_RATE = 60.0


class Observations(NamedTuple):
    """What one virtual driver did in one manual trial.

    Attributes:
        changes: By lateral speed; those seen from onset to end.
        looks: Before lane changes, OUT and BACK.
        false_glances: 1 per window of straight driving with a glance to the adjacent
            lane, shape `(window,)` [-].
        drift: In windows of lane keeping.
        torque: |driver torque|, one a second, shape `(sample,)` [N·m].
        reversals: In lane keeping, shape `(1,)`; or empty [1/min].
    """

    changes: list[ChangeMeasures]
    looks: tuple[list[Look], list[Look]]
    false_glances: Values
    drift: Drift
    torque: Values
    reversals: Values


def observe(record: TrialRecord, changes: list[Row]) -> Observations:
    """Take from a manual trial what is compared with people.

    Args:
        record: The trial.
        changes: Its rows of `lane_change_rows`; `direction` and `crossing_time` are
            used.
    """
    found = [_measured(record, change) for change in changes]
    out, back = ([c for c in changes if _side(c) == side] for side in (OUT, BACK))
    return Observations(
        changes=[each for each in found if each is not None],
        looks=(_looks(record, out), _looks(record, back)),
        false_glances=false_glances(record),
        drift=drift(record_windows(record)),
        torque=record_torque_levels(record),
        reversals=record_reversal_rate(record),
    )


def gathered(
    observations: list[Observations], values: Callable[[Observations], Values]
) -> Values:
    """One quantity of all drivers, one after the other.

    Args:
        observations: A driver each.
        values: The quantity of one of them, shape `(value, ...)`.
    """
    return np.concatenate([values(each) for each in observations] or [np.empty(0)])


def shape_errors(changes: list[ChangeMeasures]) -> Values:
    """Distances to the quintic, shape `(change, point)` [-]."""
    if not changes:
        return np.empty((0, SHAPE_POINTS))
    return np.stack([change.shape_error for change in changes])


def _side(change: Row) -> int:
    """OUT is to the right in left-hand traffic."""
    return OUT if change["direction"] == RIGHT else BACK


def _measured(record: TrialRecord, change: Row) -> ChangeMeasures | None:
    """A lane change by its lateral speed."""
    columns, direction = record.columns, float(change["direction"])
    return change_measures(
        np.asarray(columns["time"]),
        direction * np.asarray(columns["lateral_position"]),
        direction * lateral_speed(columns),
        float(change["crossing_time"]),
    )


def _head_yaw(record: TrialRecord) -> Values:
    """Head yaw, left positive; NaN where the tracker lost the head [rad]."""
    yaw = np.array(record.columns["head_yaw"], np.float64) * HEAD_YAW_SCALE
    if "head_yaw_valid" in record.columns:
        yaw[~np.asarray(record.columns["head_yaw_valid"], bool)] = math.nan
    return yaw


def _looks(record: TrialRecord, changes: list[Row]) -> list[Look]:
    """Looks in the 6 s before a wheel touches, where the head was tracked."""
    time, yaw = np.asarray(record.columns["time"]), _head_yaw(record)
    found = []
    for change in changes:
        direction = int(change["direction"])
        touch = touching_time(record, change["crossing_time"], direction)
        window = (time > touch - WINDOW) & (time <= touch)
        towards = direction * yaw[window]
        found.append(look(time[window], towards, GLANCE_ANGLES[_side(change)]))
    return [each for each in found if math.isfinite(each.peak)]


def false_glances(record: TrialRecord) -> Values:
    """1 per 6 s of straight driving with a glance to the adjacent lane, else 0.

    Straight driving: outside event zones, no lane change intended.

    Returns:
        Shape `(window,)`.
    """
    columns = record.columns
    quiet = (columns["event"] == 0) & (columns["driver_intention"] == 0)
    time, yaw, lane = columns["time"], _head_yaw(record), np.asarray(columns["lane"])
    length = round(WINDOW * _RATE)
    found: list[Real] = []
    for first in range(0, len(time) - length + 1, length):
        rows = slice(first, first + length)
        if not np.asarray(quiet)[rows].all():
            continue
        side, direction = (OUT, -1.0) if lane[first] else (BACK, 1.0)
        seen = look(time[rows], direction * yaw[rows], GLANCE_ANGLES[side])
        found.append(seen.glanced)
    flags = np.array(found, np.float64)
    return flags[np.isfinite(flags)]
