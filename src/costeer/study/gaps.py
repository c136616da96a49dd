"""Where samples are missing: short gaps are bridged, the others left out."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.records.times import LONGEST_STEP
from costeer.study.definitions import LEFT_OUT, Columns, Flags, Signal, runs
from costeer.study.segments import SEGMENT_COLUMNS

_MEASURED = (
    *SEGMENT_COLUMNS[1:],
    "steering_wheel_angle",
    "steering_wheel_rate",
    "driver_torque",
    "longitudinal_position",
    "longitudinal_velocity",
)


# Any: the element type differs from column to column.
def bridged(columns: Columns) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Columns without short gaps, and a note on each that had some.

    A column that cuts the recording into lane changes and lane keeping is bridged
    throughout; the rows of its long gaps are then marked as left out.
    """
    found, notes = dict(columns), []
    left_out = np.zeros(len(columns["time"]), bool)
    for name in (name for name in _MEASURED if name in columns):
        values = np.asarray(columns[name], np.float64)
        undefined = np.isnan(values)
        if not undefined.any() or undefined.all():
            continue
        time = columns["time"]
        filled = np.interp(time, time[~undefined], values[~undefined])
        long = _long(time, undefined)
        cutting = name in SEGMENT_COLUMNS
        left_out |= long & cutting
        found[name] = np.where(long & (not cutting), np.nan, filled)
        notes.append(_told(name, undefined, long))
    if left_out.any():
        found[LEFT_OUT] = left_out
    return found, notes


def _long(time: Signal, undefined: Flags) -> Flags:
    """Undefined samples that lie too far between defined ones to be bridged."""
    long = np.zeros(undefined.size, bool)
    for gap in runs(undefined):
        inside = gap.start > 0 and gap.stop < undefined.size
        if not inside or time[gap.stop] - time[gap.start - 1] > LONGEST_STEP:
            long[gap] = True
    return long


def _told(name: str, undefined: Flags, long: Flags) -> str:
    row = int(np.flatnonzero(undefined)[0])
    words = (
        f"{name}: {undefined.sum()} of {undefined.size} samples are missing, first in "
        f"row {row}; gaps of up to {LONGEST_STEP:g} s are bridged"
    )
    return f"{words}, {long.sum()} samples in longer ones left out"
