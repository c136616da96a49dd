"""How well the lane is kept: position, time to the line, departures."""

from __future__ import annotations

from math import isinf

import numpy as np
from jaxtyping import Float

from costeer.study.crossings import excursion, within
from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    Measure,
    MeasureParameters,
    Signal,
    runs,
    unknown,
)
from costeer.study.lanes import centre, from_centre, home_lane, keeps_home, lanes
from costeer.study.rounding import rounded_rate, rounding
from costeer.study.segments import DroppedChange, LaneChange, Segments

_STILL = 1e-6
"""Slower to the side is no motion [m/s]. Source: assumed, above what rounding makes."""


def gathered(values: Signal, stretches: tuple[slice, ...]) -> Signal:
    """The samples of several stretches, one after the other, shape `(time,)`."""
    return np.concatenate([values[rows] for rows in stretches] or [values[:0]])


def in_lane(columns: Columns, parameters: MeasureParameters = DEFAULTS) -> Signal:
    """Position from the centre of the lane that is kept [m], shape `(time,)`."""
    position = np.asarray(columns["lateral_position"])
    if keeps_home(parameters):
        return np.asarray(position - centre(parameters, home_lane(parameters)))
    return from_centre(position, parameters)


def sdlp(
    columns: Columns, segments: Segments, parameters: MeasureParameters = DEFAULTS
) -> Measure:
    """Standard deviation of the lane position [m], Eq. (12), Sec. III-F.

    All lane keeping of the trial together, about its one mean, with n - 1.
    """
    position = gathered(in_lane(columns, parameters), segments.lane_keeping)
    if position.size < 2:
        return unknown("m", segments.no_keeping)
    return Measure(value=float(np.std(position, ddof=1)), unit="m")


def lateral_speed(columns: Columns) -> Signal:
    """Rate of the lateral position [m/s], left positive, shape `(time,)`.

    Of a position that is rounded, it is taken from where the last digit changes.
    """
    time, position = columns["time"], columns["lateral_position"]
    step = rounding(position)
    if step > 0.0:
        return rounded_rate(time, position, step)
    return np.asarray(np.gradient(position, time))


def time_to_line_crossing(
    position: Float[Signal, " time"],
    speed: Float[Signal, " time"],
    parameters: MeasureParameters = DEFAULTS,
) -> Float[Signal, " time"]:
    """Time until a wheel reaches the line if the lateral speed stays [s].

    The gap between the side of the car it moves to and the line of its lane on that
    side, over the lateral speed; 0 with the wheel over the line, infinite
    without lateral speed.

    Args:
        position: From the centre of the lane [m], left positive, shape `(time,)`.
        speed: Lateral speed [m/s], left positive, shape `(time,)`.
        parameters: Width of the lane and the car.

    Returns:
        Shape `(time,)`.
    """
    room = (parameters.lane_width - parameters.car_width) / 2.0
    gap = room - np.sign(speed) * position
    moving = np.where(np.abs(speed) < _STILL, 0.0, np.abs(speed))
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.maximum(gap, 0.0) / moving
    return np.asarray(np.where(gap <= 0.0, 0.0, times))


def times_to_line_crossing(
    columns: Columns,
    speed: Signal,
    segments: Segments,
    parameters: MeasureParameters = DEFAULTS,
) -> tuple[Measure, Measure]:
    """Least and median time to line crossing in lane keeping [s]."""
    position = gathered(in_lane(columns, parameters), segments.lane_keeping)
    moving = gathered(speed, segments.lane_keeping)
    kept = time_to_line_crossing(position, moving, parameters)
    if kept.size == 0:
        reason = unknown("s", segments.no_keeping)
        return reason, reason
    least, median = float(kept.min()), float(np.median(kept))
    return _finite(least, ""), _finite(median, " in half of the samples or more")


def _finite(seconds: float, when: str) -> Measure:
    """A time, or that it never comes."""
    if isinf(seconds):
        why = f"the car does not move sideways{when}: no line is reached"
        return unknown("s", why)
    return Measure(value=seconds, unit="s")


def lane_departures(
    columns: Columns,
    speed: Signal,
    segments: Segments,
    parameters: MeasureParameters = DEFAULTS,
) -> tuple[slice, ...]:
    """Stretches with a wheel over any line outside a lane change.

    A lane change lasts here from the first to the last of its yaw and its lateral
    speed, so that a slow approach to the new lane's centre is no departure; one that
    the start or the end of the record cuts is a lane change here too. Crossing the
    line and back is a departure; with a wheel over a line between lanes when the
    record ends, nobody knows whether it would have been one, and it is none.
    """
    over = _off_centre(columns, parameters) > (
        (parameters.lane_width - parameters.car_width) / 2.0
    )
    made: list[LaneChange | DroppedChange] = list(segments.changes)
    made += [each for each in segments.dropped if _is_cut(each)]
    for change in made:
        start, end = change.start_time, change.end_time
        span = excursion(
            columns["time"],
            speed * change.direction,
            parameters.lateral_speed_threshold,
            change.crossing_time,
        )
        if span is not None:
            start, end = min(start, span[0]), max(end, span[1])
        over[within(columns["time"], start, end)] = False
    found = list(runs(over))
    if found and found[-1].stop == over.size and _towards_a_lane(columns, parameters):
        found.pop()
    return tuple(found)


def _towards_a_lane(columns: Columns, parameters: MeasureParameters) -> bool:
    """Whether there is a lane on the side to which the car is when the record ends."""
    last = columns["lateral_position"][-1:]
    lane, side = lanes(last, parameters), np.sign(from_centre(last, parameters))
    return bool(((lane + side >= 0) & (lane + side < parameters.num_lanes)).all())


def _is_cut(dropped: DroppedChange) -> bool:
    """Whether the start or the end of the record cuts a lane change."""
    return isinf(dropped.start_time) or isinf(dropped.end_time)


def _off_centre(columns: Columns, parameters: MeasureParameters) -> Signal:
    """Distance from the centre of the nearest lane [m], shape `(time,)`."""
    return np.abs(from_centre(columns["lateral_position"], parameters))
