"""What a table must be told or lack: sides, missing signals, other rates, odd columns.

A table has the names of the trial record. Beside `time` and `longitudinal_velocity`
only the crossings must be known, from `crossing` or from `lane`. A signal that is not
there is missing, and the network does without it.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    ADJACENT_LEFT,
    ADJACENT_RIGHT,
    FEATURES,
    SAMPLE_RATE,
    WINDOW_LENGTH,
    adjacent_side,
    curvature_series,
)
from costeer.records.adaptation import EXTRA_NAMES
from costeer.records.cars import CAR_COLUMN
from costeer.records.columns import COLUMN_NAMES
from costeer.training.labels import crossings
from costeer.training.resample import EVEN, delayed, grid, held, sample_at

Columns = Mapping[str, NDArray[Any]]  # Any: floats, lanes or labels

_DISTANCE = "distance_to_adjacent_lane"
_LARGEST_STEP = 0.5  # of the distance between two rows [m]; a crossing jumps farther
_LINE = -1.75  # lateral position of the line between the two lanes [m], spec section 6
_HELD = ("lane", "adjacent_side", "head_yaw_valid", "sequence", "participant")


class Course(NamedTuple):
    """One run of the network along a stretch.

    Attributes:
        side: Of the adjacent lane, -1 or +1, `(time,)`.
        words: What the name of the recording says of it.
    """

    side: NDArray[np.int8]
    words: str


def absent_signals(columns: Columns) -> tuple[str, ...]:
    """Signals of Eq. (1) that have no column, or no value in it."""
    return tuple(
        name
        for name in FEATURES
        if name not in columns
        or not np.isfinite(np.asarray(columns[name], np.float64)).any()
    )


def with_distance(columns: Columns) -> dict[str, NDArray[Any]]:
    """Columns, with the distance from the lateral position where only that is there.

    The trial record's lateral position is that on its two-lane road.
    """
    found = dict(columns)
    known = {"lane", "lateral_position"} <= columns.keys()
    if _DISTANCE in columns or not known or not on_two_lanes(columns):
        return found
    lateral = np.asarray(columns["lateral_position"], np.float64)
    found[_DISTANCE] = np.abs(lateral - _LINE)
    return found


def with_signals(columns: Columns) -> dict[str, NDArray[Any]]:
    """Columns with all six signals, NaN where missing or the head was not tracked."""
    nothing = np.full(len(columns["time"]), np.nan)
    series = {name: np.array(columns.get(name, nothing), float) for name in FEATURES}
    if "head_yaw_valid" in columns:
        lost = ~np.asarray(columns["head_yaw_valid"], bool)
        series["head_yaw"][lost] = np.nan
    return {**columns, **series}


def with_side(
    columns: Columns, metadata: Mapping[str, object]
) -> dict[str, NDArray[Any]]:
    """Columns of a trial record, with the adjacent side if its road has more lanes.

    The distance was measured to the lane on the overtaking side, from the outermost
    lane of that side to the other.

    Args:
        columns: Of the record.
        metadata: Its description, with the road that was driven on.
    """
    configuration = metadata.get("configuration")
    road = configuration.get("road") if isinstance(configuration, Mapping) else None
    told = road if isinstance(road, Mapping) else {}
    count, side = told.get("num_lanes", 2), told.get("overtaking_side", ADJACENT_RIGHT)
    known = isinstance(count, int | float) and side in (ADJACENT_LEFT, ADJACENT_RIGHT)
    if not known or count <= 2 or "lane" not in columns:
        return dict(columns)
    lane = np.asarray(columns["lane"], np.int64) + int(side)
    there = (lane >= 0) & (lane < count)
    return {**columns, "adjacent_side": np.where(there, side, -side).astype(np.int8)}


def on_two_lanes(columns: Columns) -> bool:
    """Whether the lanes are those of a two-lane road."""
    return "lane" in columns and set(np.unique(columns["lane"])) <= {0, 1}


def crossings_of(name: str, columns: Columns) -> NDArray[np.int8]:
    """Side of each crossing at the first sample in the new lane, else 0.

    Raises:
        ValueError: If the table does not tell when lanes are crossed, or a lane cannot
            be.
    """
    if "lane" in columns and not ("crossing" in columns and _has_gaps(columns)):
        from_lanes = crossings(lanes(name, columns))
        if "crossing" not in columns:
            return from_lanes
    if "crossing" in columns:
        return whole(
            name, columns, "crossing", (-1, 0, 1), "-1 (right), 0 or +1 (left)"
        )
    raise ValueError(
        f"{name} has no column crossing and no column lane; one of them must tell when "
        "the car crosses: -1 (right) or +1 (left) at the first row in the new lane, "
        "else 0"
    )


def _has_gaps(columns: Columns) -> bool:
    """Whether the lane is not known in some rows."""
    values = np.ma.filled(columns["lane"].astype(np.float64), np.nan)
    return bool(np.isnan(values).any())


def lanes(name: str, columns: Columns) -> NDArray[np.int64]:
    """Lanes, counted from the right.

    Raises:
        ValueError: Naming the first that is no whole number from 0 on.
    """
    values = np.ma.filled(columns["lane"].astype(np.float64), np.nan)
    wrong = np.flatnonzero(~((values >= 0.0) & (values == np.round(values))))
    if wrong.size:
        raise ValueError(
            f"{name}: lane is {values[wrong[0]]:g} in row {wrong[0]}; give whole "
            "numbers, counted from the right: 0, 1, ..."
        )
    return values.astype(np.int64)


def courses(name: str, columns: Columns) -> list[Course]:
    """The runs of the network: one on two lanes, else one for each side that is known.

    Raises:
        ValueError: If it cannot be told to which side the distance is measured.
    """
    if "adjacent_side" in columns:
        sides = "-1 (right) or +1 (left)"
        return [Course(whole(name, columns, "adjacent_side", (-1, 1), sides), "")]
    if on_two_lanes(columns):
        return [Course(adjacent_side(lanes(name, columns).astype(np.int8)), "")]
    every = np.ones(len(columns["time"]), np.int8)
    if _DISTANCE in absent_signals(columns):
        return [
            Course(ADJACENT_RIGHT * every, " to the right"),
            Course(ADJACENT_LEFT * every, " to the left"),
        ]
    return [Course(measured_side(name, columns) * every, "")]


def measured_side(name: str, columns: Columns) -> int:
    """Side to which the distance is measured, told from how it changes with the yaw.

    A car that points to the left comes closer to a line on its left.

    Raises:
        ValueError: If that cannot be told.
    """
    if "yaw_angle" in absent_signals(columns):
        raise ValueError(
            f"{name}: it cannot be told to which side {_DISTANCE} is measured; give "
            "the column lane (0 right, 1 left) or adjacent_side (-1 right, +1 left)"
        )
    moved = np.diff(np.asarray(columns[_DISTANCE], np.float64))
    leftward = np.sin(np.asarray(columns["yaw_angle"], np.float64))[1:]
    good = np.isfinite(moved) & np.isfinite(leftward) & (np.abs(moved) < _LARGEST_STEP)
    together = float(np.sum(moved[good] * leftward[good]))
    return ADJACENT_LEFT if together < 0.0 else ADJACENT_RIGHT


def whole(
    name: str, columns: Columns, column: str, allowed: tuple[int, ...], words: str
) -> NDArray[np.int8]:
    """A column of few values, each of them allowed.

    Raises:
        ValueError: Naming the first value that is not.
    """
    values = np.ma.filled(columns[column].astype(np.float64), np.nan)
    wrong = np.flatnonzero(~np.isin(values, allowed))
    if wrong.size:
        raise ValueError(
            f"{name}: {column} is {values[wrong[0]]:g} in row {wrong[0]}; give {words}"
        )
    return values.astype(np.int8)


def remarks(name: str, columns: Columns) -> list[str]:
    """What a reader should know of a whole table: odd columns, sides, gaps."""
    return [
        f"{name}: {words}"
        for words in (
            _unknown(columns),
            _sides(columns),
            _lane_gaps(columns),
            *_gaps(columns),
        )
        if words
    ]


def _unknown(columns: Columns) -> str:
    known = (*COLUMN_NAMES, *EXTRA_NAMES)
    odd = [
        column
        for column in columns
        if column not in known and not CAR_COLUMN.fullmatch(column)
    ]
    if not odd:
        return ""
    near = {
        column: difflib.get_close_matches(column, FEATURES, 1, 0.75) for column in odd
    }
    meant = [f"did you mean {m[0]} by {c}?" for c, m in near.items() if m]
    text = f"no name of a trial record and not used: {', '.join(odd)}"
    return "; ".join([text, *meant])


def _lane_gaps(columns: Columns) -> str:
    if "lane" in columns and "crossing" in columns and _has_gaps(columns):
        return "lane is empty in some rows and not used"
    return ""


def _sides(columns: Columns) -> str:
    if "adjacent_side" in columns or on_two_lanes(columns):
        return ""
    if _DISTANCE in absent_signals(columns):
        return "no lanes of a two-lane road: judged once for each side"
    return (
        f"no lanes of a two-lane road: the side of {_DISTANCE} is told from the yaw "
        "angle; give adjacent_side (-1 right, +1 left) to be sure"
    )


def _gaps(columns: Columns) -> list[str]:
    """Values that are not there, in columns that are."""
    absent = absent_signals(columns)
    found = []
    for name in FEATURES:
        if name in absent:
            continue
        bad = int(np.sum(~np.isfinite(np.asarray(columns[name], np.float64))))
        if bad and name == "head_yaw":
            found.append(f"head_yaw is empty in {bad} rows: taken as a lost head")
        elif bad:
            found.append(
                f"{name} is not a finite number in {bad} rows: no verdict from a "
                f"window of {WINDOW_LENGTH} rows that holds one"
            )
    return found


def bend_told(columns: Columns) -> list[str]:
    """A note on a table that tells of bends, and not of its car."""
    if not curvature_series(columns).any():
        return []
    return [
        "steering_wheel_angle and yaw_angle are taken less what road_curvature asks of "
        "costeer's default car"
    ]


def uneven_told(name: str, columns: Columns) -> list[str]:
    """A note on rows that are not evenly spaced, if they are not."""
    steps = np.diff(np.asarray(columns["time"], np.float64))
    if not steps.size or np.abs(steps / steps.mean() - 1.0).max() <= EVEN:
        return []
    return [
        f"{name}: unevenly sampled, steps up to {steps.max():.3g} s: signals come as "
        "late as the longest"
    ]


def resampled(name: str, columns: Columns) -> dict[str, NDArray[Any]]:
    """A stretch of even rows at 60 Hz, without a look ahead.

    Signals come one source period late; lanes and flags are the latest known; a
    crossing stands at the first sample at or after its row.

    Args:
        name: Of the stretch, for messages.
        columns: At the rate of the source, `(row,)` each.

    Returns:
        Shape `(time,)` each; columns of other kinds are left out.

    Raises:
        ValueError: If time does not increase, or a step is too long to be bridged.
    """
    time = np.asarray(columns["time"], np.float64)
    if len(time) < 3:
        raise ValueError(f"{name} has {len(time)} rows; at least 3 can be resampled")
    samples = grid(name, time)
    num = len(samples.latest)
    crossing = crossings_of(name, columns)
    found: dict[str, NDArray[Any]] = {
        "time": samples.start + np.arange(num) / SAMPLE_RATE,
        "crossing": np.zeros(num, np.int8),
    }
    for row in np.flatnonzero(crossing):
        place = sample_at(samples, float(time[row]))
        if 0 <= place < num:
            found["crossing"][place] = crossing[row]
    for column, values in columns.items():
        if column in _HELD:
            found[column] = held(samples, values)
        elif column in FEATURES:
            jumps = (crossing != 0) & (column == _DISTANCE)
            found[column] = delayed(samples, np.asarray(values, np.float64), jumps)
        elif column == "road_curvature":  # the lane's: its place is not resampled
            bends = curvature_series(columns)
            found[column] = delayed(samples, bends, np.zeros(len(time), bool))
    return found
