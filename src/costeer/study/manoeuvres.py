"""Measures of one lane change: how long, how far beyond, how hard steered."""

from math import nan, radians

import numpy as np

from costeer.records.columns import LANE_CHANGING
from costeer.study.crossings import excursion, passing, within
from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    MeasureParameters,
    Signal,
    missing,
    runs,
)
from costeer.study.lanes import centre, lanes
from costeer.study.segments import LaneChange

_TOLERANCE = 1e-9  # s; sums of control steps are not exact

# Beside the threshold of the parameters, so that its influence can be reported.
SENSITIVITY_THRESHOLDS = {
    "duration_quarter_degree": radians(0.25),
    "duration_one_degree": radians(1.0),
}


def overshoot(
    columns: Columns, change: LaneChange, parameters: MeasureParameters = DEFAULTS
) -> float:
    """Distance from the new lane's centre at the first lateral extremum [m].

    The extremum is the first sample after the crossing at which the car no longer
    moves towards the new lane. NaN if it does so until the record ends, or goes on to
    a lane beyond.
    """
    time, position = columns["time"], columns["lateral_position"]
    after = int(np.searchsorted(time, change.crossing_time, side="right"))
    steps = np.diff(position[after:]) * change.direction
    turned = np.flatnonzero(steps <= 0.0)
    if turned.size == 0:
        return nan
    there = position[after + int(turned[0])]
    beyond = (int(lanes(there, parameters)) - change.lane) * change.direction
    return nan if beyond > 0 else float(abs(there - centre(parameters, change.lane)))


def steering_velocity_rms(columns: Columns, change: LaneChange) -> float:
    """Root mean square of the steering-wheel rate from start to end [rad/s]."""
    return rms(steering_rate(columns)[_rows(columns, change)])


def steering_rate(columns: Columns) -> Signal:
    """Rate of the steering wheel [rad/s]; from the angle where it is not recorded."""
    if not missing(columns, "steering_wheel_rate"):
        return np.asarray(columns["steering_wheel_rate"])
    return np.asarray(np.gradient(columns["steering_wheel_angle"], columns["time"]))


def peak_steering_angle(columns: Columns, change: LaneChange) -> float:
    """Largest steering-wheel angle to either side from start to end [rad]."""
    angle = columns["steering_wheel_angle"][_rows(columns, change)]
    return float(np.abs(angle).max()) if angle.size else nan


def is_assisted(columns: Columns, change: LaneChange) -> bool:
    """Whether the guidance followed a lane-change path between start and end."""
    if "mode" not in columns:
        return False
    return bool((columns["mode"][_rows(columns, change)] == LANE_CHANGING).any())


def speed_measures(
    columns: Columns,
    speed: Signal,
    change: LaneChange,
    parameters: MeasureParameters = DEFAULTS,
) -> dict[str, float]:
    """The lane change by lateral speed instead of yaw.

    Args:
        columns: Of the trial.
        speed: Its lateral speed [m/s], left positive, shape `(time,)`.
        change: Which lane change.
        parameters: Threshold.

    Returns:
        `duration_by_speed` [s] and `onset_to_crossing` [s], with the lateral speed
        above its threshold, and `peak_lateral_speed` [m/s]; NaN if the record does
        not contain the onset or the end.
    """
    towards = speed * change.direction
    span = excursion(
        columns["time"],
        towards,
        parameters.lateral_speed_threshold,
        change.crossing_time,
    )
    start, end = span or (nan, nan)
    return {
        "duration_by_speed": _finite(end - start),
        "onset_to_crossing": _finite(change.crossing_time - start),
        "peak_lateral_speed": float(towards[_rows(columns, change)].max()),
    }


def duration_sensitivity(columns: Columns, change: LaneChange) -> dict[str, float]:
    """Duration with other yaw thresholds [s]; NaN if the yaw stays below one."""
    yaw = columns["yaw_angle"] * change.direction
    spans = {
        name: excursion(columns["time"], yaw, threshold, change.crossing_time)
        for name, threshold in SENSITIVITY_THRESHOLDS.items()
    }
    return {
        name: nan if span is None else _finite(span[1] - span[0])
        for name, span in spans.items()
    }


def settling(
    columns: Columns, change: LaneChange, parameters: MeasureParameters = DEFAULTS
) -> dict[str, float]:
    """When the heading begins to stay along the lane, and how long that took.

    Args:
        columns: Of the trial.
        change: Which lane change.
        parameters: How straight, and for how long.

    Returns:
        `settled_time` [s] and `duration_until_settled` [s], from the published start;
        NaN if the record stops before, or the car has left the new lane by then.
    """
    time, yaw = columns["time"], np.abs(columns["yaw_angle"])
    level, instant = parameters.straight_yaw, nan
    after = int(np.searchsorted(time, change.crossing_time))
    for part in runs(yaw[after:] <= level):
        first, last = after + part.start, after + part.stop - 1
        entered = passing(time, yaw, first - 1, level) if first > after else time[first]
        if time[last] - entered >= parameters.straight_duration - _TOLERANCE:
            lane = int(lanes(columns["lateral_position"][first], parameters))
            instant = float(entered) if lane == change.lane else nan
            break
    return {
        "settled_time": instant,
        "duration_until_settled": instant - change.start_time,
    }


def rms(values: Signal) -> float:
    """Root mean square; NaN without values."""
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else nan


def _rows(columns: Columns, change: LaneChange) -> slice:
    return within(columns["time"], change.start_time, change.end_time)


def _finite(value: float) -> float:
    return value if np.isfinite(value) else nan
