"""An instrumented car with the lane lines it sees, Korea (set `r3_driving`).

10 Hz, one expert driver, 5 minutes a scenario; the scenario counts as driver. Distances
are those to the two lines of the own lane, yaw is the mean of their directions. The
steering angle is not in the set and is not made up.

Stretches are drives on lanes: faster than 5 m/s, along lines a lane apart that are
really seen (lost lines are told as ±1.875 m and straight, or stand still), without
jumps of the lines or the speed. Lane changes are those of `crossings.csv` that are
`clean`, with the line at the car and followed by a jump of both lines by a lane; the
other entries are turns at junctions and confused lines, and are cut out with the
seconds around them. The lines jump up to 0.4 s after the crossing; in between they are
named anew here, in a new lane as wide as the old one.

A lane is there if the next line outwards lies a lane further in the median over 10 s
(the line itself comes and goes), and on both sides of a lane change.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from costeer.training.datasets.stretches import (
    Crossing,
    Stretch,
    both_runs,
    cut,
    pieces,
)
from costeer.training.datasets.tables import Columns, Table, groups, table_of
from costeer.training.recordings import Recording

FILES = ("expert.csv.gz", "crossings.csv")

_LINES = ("left0", "right0", "left0_slope", "right0_slope")
_FRAMES = Columns(
    numbers=("t", "v", "ax", *_LINES, "left1", "right1"), texts=("scenario",)
)
_CROSSINGS = Columns(numbers=("t_cross",), texts=("scenario", "side", "clean"))
_SIDES = {"L": 1, "R": -1}
_CROSSED = {1: "left0", -1: "right0"}
_LOST = 1.875  # m, written for both lines when there are none

Flags = NDArray[np.bool_]


class LineParameters(NamedTuple):
    """When the lines can be trusted.

    Attributes:
        least_velocity: Slower is parking and queueing [m/s]. Source: definition of a
            clean crossing in the set.
        narrowest: Lane [m]. Source: assumed; Korean lanes are 3 to 3.6 m.
        widest: Lane [m]. Source: assumed.
        most_yaw: Against the lines; above it the car turns [rad]. Source: assumed,
            the largest in a lane change here is about 0.1.
        jump: Largest change of a line in 0.1 s [m]. Source: assumed, 5 m/s.
        speed_jump: Largest change of speed in 0.1 s [m/s]. Source: assumed, 15 m/s²
            is beyond any tyre.
        frozen: Lines that stand still for longer are not seen [s]. Source: assumed;
            they are given in steps of 4 mm.
        at_line: Largest distance of the line from the centre just before a lane
            change [m]. Source: assumed.
        late: Largest time from a crossing to the jump of the lines [s]. Source: this
            set, where 0.4 s occur.
        lane_jump: Least change of both lines at a lane change [m]. Source: assumed,
            half a lane.
        around_confusion: Cut out before and after a crossing that is none [s].
            Source: assumed, the prediction horizon.
        around_crossing: Both lanes are there before and after a lane change [s].
            Source: assumed.
        lane_span: Over which the next lane is looked for [s]. Source: assumed.
    """

    least_velocity: float = 5.0
    narrowest: float = 2.5
    widest: float = 4.5
    most_yaw: float = 0.2
    jump: float = 0.5
    speed_jump: float = 1.5
    frozen: float = 0.5
    at_line: float = 0.5
    late: float = 0.6
    lane_jump: float = 1.5
    around_confusion: float = 3.0
    around_crossing: float = 5.0
    lane_span: float = 10.0


PARAMETERS = LineParameters()


class Change(NamedTuple):
    """One lane change.

    Attributes:
        crossing: Of the centre.
        late: Rows after it that still name the lines of the old lane.
    """

    crossing: Crossing
    late: slice


def read(folder: Path) -> list[Recording]:
    """Recordings of the set.

    Args:
        folder: With `expert.csv.gz` and `crossings.csv`.

    Raises:
        ValueError: If a table cannot be read.
    """
    table = table_of(folder, FILES[0], _FRAMES)
    entries = table_of(folder, FILES[1], _CROSSINGS)
    found = []
    for rows in groups(table["scenario"]):
        drive = {name: values[rows] for name, values in table.items()}
        mine = entries["scenario"] == drive["scenario"][0]
        listed = {name: values[mine] for name, values in entries.items()}
        for stretch in _stretches(drive, listed):
            found += both_runs(stretch)
    return found


def lane_changes(drive: Table, listed: Table) -> list[Change]:
    """Entries that are lane changes: clean, at the line, and both lines jump.

    Args:
        drive: Rows of one scenario.
        listed: Its entries of `crossings.csv`.
    """
    found = []
    for instant, name, clean in zip(
        listed["t_cross"], listed["side"], listed["clean"], strict=True
    ):
        side = _SIDES[str(name)]
        first = int(np.searchsorted(drive["t"], instant))
        jump = _jump_row(drive, first, side)
        near = np.abs(drive[_CROSSED[side]][first - 1]) < PARAMETERS.at_line
        if clean == "True" and near and jump is not None:
            found.append(Change(Crossing(float(instant), side), slice(first, jump)))
    return found


def _jump_row(drive: Table, first: int, side: int) -> int | None:
    """Row at which both lines jump by a lane to the other side, soon after the first.

    None if they do not.
    """
    steps = np.stack(
        [np.diff(drive[line], prepend=np.nan) for line in ("left0", "right0")]
    )
    period = float(np.median(np.diff(drive["t"])))
    rows = slice(first, first + round(PARAMETERS.late / period) + 1)
    jumped = (-side * steps[:, rows] >= PARAMETERS.lane_jump).all(axis=0)
    return first + int(np.argmax(jumped)) if jumped.any() else None


def renamed(drive: Table, changes: list[Change]) -> Table:
    """The drive with the lines of the new lane from each crossing on."""
    left, right = drive["left0"].copy(), drive["right0"].copy()
    for change in changes:
        rows, width = change.late, (right - left)[change.late]
        if change.crossing.side == 1:
            left[rows], right[rows] = left[rows] - width, left[rows].copy()
        else:
            left[rows], right[rows] = right[rows].copy(), right[rows] + width
    return drive | {"left0": left, "right0": right}


def _stretches(drive: Table, listed: Table) -> list[Stretch]:
    """The usable parts of one scenario."""
    changes = lane_changes(drive, listed)
    crossings = [change.crossing for change in changes]
    drive, time = renamed(drive, changes), drive["t"]
    meant = np.array([crossing.time for crossing in crossings])
    confused = np.setdiff1d(listed["t_cross"], meant)
    near = _around(time, confused, PARAMETERS.around_confusion)
    whole = Stretch(
        driver=str(drive["scenario"][0]),
        name=f"r3_driving:{drive['scenario'][0]}",
        time=time,
        signals={
            "longitudinal_acceleration": drive["ax"],
            "longitudinal_velocity": drive["v"],
            "yaw_angle": _yaw(drive),
        },
        to_left=-drive["left0"],
        to_right=drive["right0"],
        lane_left=lanes(drive, crossings, 1),
        lane_right=lanes(drive, crossings, -1),
        crossings=crossings,
    )
    return cut(whole, usable(drive) & ~near, _jumps(drive, meant))


def _yaw(drive: Table) -> NDArray[np.float64]:
    return np.asarray((drive["left0_slope"] + drive["right0_slope"]) / 2.0)


def usable(drive: Table) -> Flags:
    """Rows that drive along a lane whose lines are seen, `(row,)`."""
    width = drive["right0"] - drive["left0"]
    lost = (drive["left0"] == -_LOST) & (drive["right0"] == _LOST)
    speeding = np.abs(np.diff(drive["v"])) > PARAMETERS.speed_jump
    glitch = np.append(speeding, False) | np.insert(speeding, 0, False)
    return np.asarray(
        (drive["v"] > PARAMETERS.least_velocity)
        & (width > PARAMETERS.narrowest)
        & (width < PARAMETERS.widest)
        & (np.abs(_yaw(drive)) < PARAMETERS.most_yaw)
        & ~(lost | glitch | _frozen(drive))
    )


def _frozen(drive: Table) -> Flags:
    """Rows in which all that is known of the lines stands still for long."""
    lines = np.stack([drive[name] for name in _LINES])
    same = (np.diff(lines, axis=1) == 0.0).all(axis=0)
    found = np.zeros(len(drive["t"]), bool)
    for rows in pieces(same):
        duration = drive["t"][rows.stop] - drive["t"][rows.start]
        found[rows.start : rows.stop + 1] = duration > PARAMETERS.frozen
    return found


def _jumps(drive: Table, changes: NDArray[np.float64]) -> Flags:
    """Rows at which a line jumps without a lane change."""
    found = np.zeros(len(drive["t"]), bool)
    for line in ("left0", "right0"):
        step = np.diff(drive[line], prepend=np.nan)
        found |= np.abs(step) > PARAMETERS.jump
    found[np.searchsorted(drive["t"], changes)] = False
    return found


def lanes(drive: Table, crossings: list[Crossing], side: int) -> Flags:
    """Whether there is a lane on a side, `(row,)`.

    Args:
        drive: Rows of one scenario.
        crossings: Its lane changes.
        side: -1 right, +1 left.
    """
    outer, inner = ("left1", "left0") if side == 1 else ("right1", "right0")
    time = drive["t"]
    rows = round(PARAMETERS.lane_span / float(np.median(np.diff(time)))) + 1
    width = median_filter(np.abs(drive[outer] - drive[inner]), rows, mode="nearest")
    found = (width > PARAMETERS.narrowest) & (width < PARAMETERS.widest)
    for crossing in crossings:
        since = (time - crossing.time) * (-1.0 if crossing.side == side else 1.0)
        found |= (since > 0.0) & (since <= PARAMETERS.around_crossing)
    return np.asarray(found)


def _around(
    time: NDArray[np.float64], instants: NDArray[np.float64], reach: float
) -> Flags:
    found = np.zeros(len(time), bool)
    for instant in instants:
        found |= np.abs(time - instant) <= reach
    return found
