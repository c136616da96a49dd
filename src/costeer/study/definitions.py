"""What the measures share: their thresholds, their result type, what they need."""

from collections.abc import Mapping
from math import nan, radians
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import MANUAL

Signal = NDArray[np.float64]
Flags = NDArray[np.bool_]
# Any: the element type differs from column to column.
Columns = Mapping[str, NDArray[Any]]


class MeasureParameters(NamedTuple):
    """Thresholds of the measures of driving; the road and the car's width.

    Attributes:
        lane_width: d, of every lane [m]. Source: the paper's simulator, Sec. III-A; a
            record's own road goes before it.
        num_lanes: Lanes of this direction [-]. Source: as above.
        overtaking_side: -1 right, +1 left [-]. Source: as above.
        car_width: Over the wheels [m]. Source: assumed, a passenger car's body.
        yaw_threshold: A lane change starts and ends here [rad]. Source: assumed,
            0.5 deg, above the yaw of lane keeping and below that of a slow change.
        lateral_speed_threshold: The same by lateral speed [m/s]. Source: assumed,
            0.1 m/s, usual in studies of recorded traffic.
        lane_change_margin: Lane keeping keeps this far from a lane change [s].
            Source: assumed, the time a car takes to settle.
        minimum_stay: Who crosses back sooner has not changed lanes [s]. Source:
            assumed, the prediction horizon of Eq. (2).
        reversal_angle: Gap of a steering reversal [rad]. Source: the paper, 3 deg.
        reversal_cutoff: Low-pass before counting [Hz], 0 for none. Source: Markkula
            and Engström (2006).
        prediction_horizon: A trigger is true so long before a crossing [s]. Source:
            the paper, Sec. II-B.
        early_horizon: From the horizon to here a trigger is early [s]. Source:
            assumed, glances begin about so long before a crossing.
        trigger_merge: Triggers closer than this are one [s]. Source: assumed, no
            driver decides twice in a second.
        recovery_gain: K_h from which an inconsistency is over [-]. Source: assumed.
        replan_gain: K_h below which the system re-plans [-]. Source: assumed; a
            record's own value goes before it.
        frozen_gain_rate: Slower than this a fade stands still [1/s]. Source:
            assumed, a fortieth of the fastest change that Eq. (10) makes.
        episode_duration: What follows a false trigger within it is its cost [s].
            Source: assumed, the longest path of Table IV and 2 s for its end.
        settled_offset: Largest distance from the lane's centre of a settled car [m].
            Source: assumed, as for the lock of the trigger.
        settled_duration: A car is settled if it stays so long straight, within
            `yaw_threshold`, and near the centre [s]. Source: assumed, as above.
        straight_yaw: From where it stays within this the heading is settled [rad].
            Source: assumed, 0.3 deg, what a car's yaw swings by in lane keeping.
        straight_duration: For so long it must stay [s]. Source: assumed, longer than
            the swing of a car that comes to rest in its lane.
        any_lane: 1 if lane keeping counts in every lane, about its centre; 0 if, on two
            lanes, in that one alone which is not for overtaking [-]. Source: the paper,
            whose drivers keep left.
        following_headway: Up to this time headway a car follows the one ahead [s].
            Source: Vogel (2002), who found cars to drive freely above it.
    """

    lane_width: float = 3.5
    num_lanes: float = 2.0
    overtaking_side: float = -1.0
    car_width: float = 1.8
    yaw_threshold: float = radians(0.5)
    lateral_speed_threshold: float = 0.1
    lane_change_margin: float = 3.0
    minimum_stay: float = 3.0
    reversal_angle: float = radians(3.0)
    reversal_cutoff: float = 0.6
    prediction_horizon: float = 3.0
    early_horizon: float = 5.0
    trigger_merge: float = 1.0
    recovery_gain: float = 0.95
    replan_gain: float = 0.05
    frozen_gain_rate: float = 0.05
    episode_duration: float = 10.0
    settled_offset: float = 0.3
    settled_duration: float = 0.5
    straight_yaw: float = radians(0.3)
    straight_duration: float = 2.0
    any_lane: float = 0.0
    following_headway: float = 6.0


DEFAULTS = MeasureParameters()


class Measure(NamedTuple):
    """A measured value, or why there is none.

    Attributes:
        value: The value; NaN if it could not be computed.
        unit: Its unit, "-" if it has none.
        reason: Why it could not be computed; empty if it could.
    """

    value: float
    unit: str
    reason: str = ""


LEFT_OUT = "left_out"
"""A column of flags: rows in which what cuts a recording into segments is missing."""

LEAST_DURATION = 1.0
"""Less driving than this gives no measure [s]. Source: assumed, below any manoeuvre."""


def too_short(time: Signal) -> str:
    """Why a recording is too short to be measured; empty if it is not."""
    duration = float(time[-1] - time[0]) if time.size else 0.0
    if duration >= LEAST_DURATION - 1e-6:
        return ""
    return (
        f"{duration:.3g} s with {time.size} rows are too short; record at least "
        f"{LEAST_DURATION:g} s"
    )


def unknown(unit: str, reason: str) -> Measure:
    """A measure that could not be computed."""
    return Measure(value=nan, unit=unit, reason=reason)


def missing(columns: Columns, *names: str) -> str:
    """Which of these columns are absent or undefined throughout; empty if none."""
    absent = [name for name in names if name not in columns]
    if absent:
        return f"needs {_listed(absent)}, not recorded"
    undefined = [name for name in names if not is_defined(columns[name]).any()]
    return f"needs {_listed(undefined)}, undefined throughout" if undefined else ""


def incomplete(columns: Columns, *names: str) -> str:
    """Which of these columns are missing or have gaps; empty if none."""
    gaps = [k for k in names if k in columns and not is_defined(columns[k]).all()]
    reason = missing(columns, *names)
    if reason or not gaps:
        return reason
    return f"needs {_listed(gaps)} without gaps"


def under_assistance(columns: Columns) -> bool:
    """Whether there was a guidance with some strength in any sample."""
    return "mode" in columns and bool((columns["mode"] != MANUAL).any())


def is_defined(values: NDArray[Any]) -> Flags:
    """Which samples are neither masked nor NaN, shape `(time,)`."""
    defined = ~np.ma.getmaskarray(values)
    if values.dtype.kind == "f":
        defined &= ~np.isnan(np.ma.getdata(values))
    return np.asarray(defined, dtype=bool)


def _listed(names: list[str]) -> str:
    return f"the column{'s' if len(names) > 1 else ''} {', '.join(names)}"


def runs(flags: Flags) -> list[slice]:
    """The stretches in which a flag holds, as slices of rows, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
