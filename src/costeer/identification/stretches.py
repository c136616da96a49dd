"""Where a recording shows lane changes, and where the driver just keeps the lane.

`study.segments` cuts a trial for measures in the cruising lane outside of overtaking.
A driver keeps the other lane in the same way, so a fit takes every stretch away from
lane changes. Its margins are wider, because the plan of a slow lane change begins
before any threshold of yaw is passed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.identification.signals import Drive, Signal

YAW_THRESHOLD = 0.00873
"""A lane change starts and ends at this yaw towards the new lane, 0.5 deg [rad]."""
MARGIN_BEFORE = 4.5
"""Lane keeping ends so long before such a start [s]: the slowest of 1,000 drivers
plans 3.6 s ahead of it."""
MARGIN_AFTER = 3.5
"""Lane keeping begins so long after such an end [s]."""
UNFINISHED = 7.0
"""Left out at the end of a recording [s]: a lane change may have begun there that has
not come to the line."""
SHORTEST = 9.0
"""Shorter stretches tell nothing once the filter has settled [s]."""
MINIMUM_STAY = 3.0
"""Who crosses back sooner has not changed lanes [s]."""

Flags = NDArray[np.bool_]


class Change(NamedTuple):
    """The car goes from a lane to the next; rows of the recording.

    Attributes:
        direction: -1 to the right, +1 to the left.
        start: Last row within the yaw threshold before the crossing; -1 if none.
        crossing: First row in the new lane.
        end: First row within the threshold after it; the number of rows if none.
    """

    direction: int
    start: int
    crossing: int
    end: int


def changes(drive: Drive) -> list[Change]:
    """All crossings of a line between lanes, also those that went back."""
    rows = np.flatnonzero(np.diff(drive.lane))
    return [_change(drive, int(row)) for row in rows]


def _change(drive: Drive, row: int) -> Change:
    direction = 1 if drive.lane[row + 1] > drive.lane[row] else -1
    straight = np.flatnonzero(drive.yaw_angle * direction <= YAW_THRESHOLD)
    before, after = straight[straight <= row], straight[straight > row]
    return Change(
        direction=direction,
        start=int(before[-1]) if before.size else -1,
        crossing=row + 1,
        end=int(after[0]) if after.size else len(drive.lane),
    )


def completed(drive: Drive, found: list[Change]) -> list[Change]:
    """Changes that are seen from start to end and were not taken back at once."""
    stay = MINIMUM_STAY / drive.dt
    crossings = np.array([-np.inf, *(c.crossing for c in found), np.inf])
    gaps = np.diff(crossings)
    return [
        change
        for change, before, after in zip(found, gaps[:-1], gaps[1:], strict=True)
        if min(before, after) >= stay
        and 0 <= change.start < change.crossing - 1
        and change.end < len(drive.lane)
    ]


def apart_from(drive: Drive, found: list[Change], before: float, after: float) -> Flags:
    """Rows that keep so far from every change [s] and from the recording's end."""
    apart = np.ones(len(drive.lane), dtype=bool)
    ahead, behind = round(before / drive.dt), round(after / drive.dt)
    for change in found:
        apart[max(change.start - ahead, 0) : change.end + behind] = False
    apart[max(len(apart) - round(UNFINISHED / drive.dt), 0) :] = False
    return apart


def stretches(flags: Flags, shortest: int = 1) -> list[slice]:
    """Rows of each stretch in which a flag holds, if it is at least so long."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    pairs = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    return [slice(a, b) for a, b in pairs if b - a >= shortest]


def lane_keeping(drive: Drive, found: list[Change]) -> list[slice]:
    """Stretches in which the driver keeps a lane, long enough for the filter."""
    apart = apart_from(drive, found, MARGIN_BEFORE, MARGIN_AFTER)
    return stretches(apart, round(SHORTEST / drive.dt))


def total_time(drive: Drive, rows: list[slice]) -> float:
    """How long stretches are together [s]."""
    return float(sum(each.stop - each.start for each in rows) * drive.dt)


def step_response(progress: Signal) -> Signal:
    """The quintic from 0 to 1 that `drivers.tracking` plans, held at both ends."""
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s * s))
