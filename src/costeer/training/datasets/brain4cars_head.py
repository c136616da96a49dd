"""Head yaw before lane changes and on straight roads (set `brain4cars_head`).

Windows of 6 s at 25 Hz that end when a wheel touches the marking, or anywhere on a
straight stretch. Head yaw and speed are all there is. Yaw in the set is negative to
the driver's left and counts from where the camera looks, so it is turned round and
counts from the median of its window (a look ahead within 6 s), over 90 degrees. A
window holds 3 s of history and 3 s to judge, so nearly every judged sample before a
lane change is a positive: the set tells glances before a lane change from glances on a
straight road, and says nothing about how rare lane changes are.

The touch of a wheel stands for the crossing of the centre, which comes about a second
later: leads are too short by that. Turns are left out, and so are windows without speed
or without a single sight of the head. A run exists where the lanes of the road say
so, or where the car changed to.

The driver is the recording day, because the set does not name its ten drivers.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from costeer.training.datasets.stretches import Crossing, Stretch, both_runs, cut
from costeer.training.datasets.tables import Columns, Table, groups, table_of
from costeer.training.recordings import Recording

FILES = ("frames.csv.gz", "samples.csv")

_FRAMES = Columns(numbers=("t", "yaw", "speed"), texts=("label", "sample"))
_SAMPLES = Columns(numbers=("lane_no", "lanes_total"), texts=("label", "sample", "day"))
_SIDES = {"lchange": 1, "rchange": -1, "end_action": 0}
_KMH = 3.6
_FULL_TURN = math.pi / 2.0  # head yaw of 1


def read(folder: Path) -> list[Recording]:
    """Recordings of the set.

    Args:
        folder: With `frames.csv.gz` and `samples.csv`.

    Raises:
        ValueError: If a table cannot be read, or a window is in one of them only.
    """
    frames = table_of(folder, FILES[0], _FRAMES)
    samples = table_of(folder, FILES[1], _SAMPLES)
    every = [
        rows
        for rows in groups(np.char.add(frames["label"], frames["sample"]))
        if str(frames["label"][rows[0]]) in _SIDES
    ]
    seen = [rows for rows in every if np.isfinite(frames["yaw"][rows]).any()]
    chosen = [rows for rows in seen if np.isfinite(frames["speed"][rows]).any()]
    notes = (
        "the touch of a wheel stands for the crossing: leads are about 1 s too short",
        f"{len(every) - len(seen)} windows left out in which the head was never "
        f"tracked, {len(seen) - len(chosen)} without speed",
        "straight windows count as known to go on so for 3 s",
    )
    places = {key: row for row, key in enumerate(_keys(samples))}
    found = []
    for rows in chosen:
        whole = _stretch(frames, samples, rows, places, notes)
        driven = np.isfinite(whole.signals["longitudinal_velocity"])
        for stretch in cut(whole, driven):
            found += both_runs(stretch)
    return found


def head_yaw(yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """Head yaw of a window in [-1, 1], left positive, `(row,)` [-].

    Args:
        yaw: Left negative, from where the camera looks; NaN where not tracked [rad].
    """
    return np.clip((np.nanmedian(yaw) - yaw) / _FULL_TURN, -1.0, 1.0)


def _keys(table: Table) -> list[tuple[str, str]]:
    return list(zip(map(str, table["label"]), map(str, table["sample"]), strict=True))


def _stretch(
    frames: Table,
    samples: Table,
    rows: NDArray[np.intp],
    places: dict[tuple[str, str], int],
    notes: tuple[str, ...],
) -> Stretch:
    label, sample = str(frames["label"][rows[0]]), str(frames["sample"][rows[0]])
    if (label, sample) not in places:
        raise ValueError(
            f"samples.csv has no row of {label} {sample}, frames.csv has; fetch both "
            "files anew"
        )
    row, side, time = places[label, sample], _SIDES[label], frames["t"][rows]
    lane, num_lanes = samples["lane_no"][row], samples["lanes_total"][row]
    return Stretch(
        driver=f"day {samples['day'][row]}",
        name=f"brain4cars_head:{label}:{sample}",
        time=time,
        signals={
            "head_yaw": head_yaw(frames["yaw"][rows]),
            "longitudinal_velocity": frames["speed"][rows] / _KMH,
        },
        lane_left=np.full(len(rows), lane < num_lanes or side == 1),
        lane_right=np.full(len(rows), lane > 1.0 or side == -1),
        crossings=[Crossing(float(time[-1]), side)] if side else [],
        keeps_lane=side == 0,
        notes=notes,
    )
