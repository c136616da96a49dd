"""Where a trial has lane changes, and where the driver just keeps the lane.

A lane change starts at the last yaw within the threshold before the centre of gravity
crosses the line and ends at the first after it. Instants between two samples are
interpolated, so they do not depend on the sampling rate.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from costeer.study.crossings import (
    Crossing,
    excursion,
    line_crossings,
)
from costeer.study.definitions import (
    DEFAULTS,
    LEAST_DURATION,
    LEFT_OUT,
    Columns,
    Flags,
    MeasureParameters,
    Signal,
    incomplete,
    runs,
    too_short,
)
from costeer.study.lanes import in_kept_lane

SEGMENT_COLUMNS = ("time", "lateral_position", "yaw_angle")


class LaneChange(NamedTuple):
    """A lane change that was completed.

    Attributes:
        number: Of the lane change in the trial, from 1.
        direction: -1 to the right, +1 to the left.
        start_time: Last yaw within the threshold before the crossing [s].
        crossing_time: The centre of gravity crosses the line [s].
        end_time: First yaw within the threshold after the crossing [s].
        lane: That it leads to, counted from the right.
    """

    number: int
    direction: int
    start_time: float
    crossing_time: float
    end_time: float
    lane: int


class DroppedChange(NamedTuple):
    """A crossing that makes no lane change.

    Attributes:
        crossing_time: When the line was crossed [s].
        direction: -1 to the right, +1 to the left.
        start_time: As of a lane change [s]; -inf if before the record.
        end_time: As of a lane change [s]; inf if after the record.
        reason: Why it is dropped.
    """

    crossing_time: float
    direction: int
    start_time: float
    end_time: float
    reason: str


class Segments(NamedTuple):
    """A trial, cut.

    Attributes:
        crossings: All crossings of the line.
        changes: The lane changes.
        dropped: Crossings that make no lane change, with reasons.
        lane_keeping: Rows of each stretch of lane keeping.
        num_events: Overtaking events the car was in.
        no_keeping: Why there is no lane keeping; empty if there is.
    """

    crossings: tuple[Crossing, ...]
    changes: tuple[LaneChange, ...]
    dropped: tuple[DroppedChange, ...]
    lane_keeping: tuple[slice, ...]
    num_events: int
    no_keeping: str = ""


def segment(
    columns: Columns, parameters: MeasureParameters = DEFAULTS
) -> Segments | str:
    """Cut a trial into lane changes and lane keeping.

    Args:
        columns: `time`, `lateral_position`, `yaw_angle` and, if there are events,
            `event`; shape `(time,)` each.
        parameters: Thresholds.

    Returns:
        The segments, or the reason why there are none.
    """
    reason = incomplete(columns, *SEGMENT_COLUMNS) or too_short(columns["time"])
    if reason:
        return reason
    crossings = line_crossings(columns, parameters)
    changes, dropped = _sorted_changes(columns, parameters, crossings)
    spans = [(change.start_time, change.end_time) for change in changes]
    spans += [(drop.start_time, drop.end_time) for drop in dropped]
    inside = in_kept_lane(columns, parameters)
    keeping = inside & ~_near(columns["time"], spans, parameters.lane_change_margin)
    keeping &= ~event_zone(columns)
    if LEFT_OUT in columns:
        keeping &= ~columns[LEFT_OUT]
    side = "left" if parameters.overtaking_side < 0.0 else "right"
    no_keeping = _no_keeping(columns["time"], inside, keeping, side)
    return Segments(
        crossings=crossings,
        changes=changes,
        dropped=dropped,
        lane_keeping=() if no_keeping else tuple(runs(keeping)),
        num_events=_num_events(columns),
        no_keeping=no_keeping,
    )


def _no_keeping(time: Signal, inside: Flags, keeping: Flags, side: str) -> str:
    """Why there is no lane keeping; empty if there is."""
    if not inside.any():
        return (
            f"the car is never in the {side} lane, where lane keeping is measured; to "
            "measure the lane driven in, set any_lane (on the command line: --any-lane)"
        )
    seconds = float(keeping.sum() * (time[-1] - time[0]) / (time.size - 1))
    if keeping.any() and seconds < LEAST_DURATION:
        return f"{seconds:.3g} s of lane keeping are too short to be measured"
    if not keeping.any():
        return "the record has no lane keeping outside lane changes and events"
    return ""


def _sorted_changes(
    columns: Columns,
    parameters: MeasureParameters,
    crossings: tuple[Crossing, ...],
) -> tuple[tuple[LaneChange, ...], tuple[DroppedChange, ...]]:
    changes: list[LaneChange] = []
    dropped: list[DroppedChange] = []
    hasty = _crossed_back(crossings, parameters.minimum_stay)
    for crossing, back in zip(crossings, hasty, strict=True):
        yaw = columns["yaw_angle"] * crossing.direction
        span = excursion(columns["time"], yaw, parameters.yaw_threshold, crossing.time)
        reason = _fault(span, parameters) or back
        start, end = span or (crossing.time, crossing.time)
        if reason:
            dropped.append(
                DroppedChange(
                    crossing_time=crossing.time,
                    direction=crossing.direction,
                    start_time=start,
                    end_time=end,
                    reason=reason,
                )
            )
        else:
            changes.append(
                LaneChange(
                    number=len(changes) + 1,
                    direction=crossing.direction,
                    start_time=start,
                    crossing_time=crossing.time,
                    end_time=end,
                    lane=crossing.lane,
                )
            )
    return tuple(changes), tuple(dropped)


def _fault(span: tuple[float, float] | None, parameters: MeasureParameters) -> str:
    """Why a crossing with this start and end makes no lane change; empty if it does."""
    degrees = np.degrees(parameters.yaw_threshold)
    if span is None:
        return f"drifted across the line with the yaw under {degrees:g} deg"
    if span[0] == -inf:
        return "started before the record"
    return "did not end within the record" if span[1] == inf else ""


def _crossed_back(crossings: tuple[Crossing, ...], minimum_stay: float) -> list[str]:
    """Per crossing: empty, or that one back follows or precedes it too closely."""
    times = np.array([crossing.time for crossing in crossings])
    sides = np.array([crossing.direction for crossing in crossings])
    hasty = (np.diff(times) < minimum_stay) & (np.diff(sides) != 0)
    forth = np.concatenate([hasty, [False]])
    back = np.concatenate([[False], hasty])
    reason = f"crossed back within {minimum_stay:g} s"
    return [reason if a or b else "" for a, b in zip(forth, back, strict=True)][
        : len(crossings)
    ]


def _near(time: Signal, spans: list[tuple[float, float]], margin: float) -> Flags:
    """Samples within a margin [s] of any span, ends included."""
    near = np.zeros(time.size, dtype=bool)
    for start, end in spans:
        first = np.searchsorted(time, start - margin, side="left")
        last = np.searchsorted(time, end + margin, side="right")
        near[first:last] = True
    return near


def event_zone(columns: Columns) -> Flags:
    """Samples inside an overtaking event; none if events are not recorded."""
    if "event" not in columns:
        return np.zeros(len(columns["time"]), dtype=bool)
    return np.asarray(columns["event"] != 0, dtype=bool)


def _num_events(columns: Columns) -> int:
    if "event" not in columns:
        return 0
    return int(np.count_nonzero(np.unique(columns["event"])))
