"""Lane changes on US-101 and I-80 (set `ngsim_lc`): durations, speeds, shapes.

NGSIM trajectories, smoothed by github yurui0830/hmm_lanechangerecognition; one
vehicle per sequence, 10 Hz. No line is marked: the time of the largest lateral speed
stands for the crossing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from costeer.validation.people.folder import Columns, groups, read_table, table_path
from costeer.validation.people.shape import ChangeMeasures, change_measures

_COLUMNS = Columns(numbers=("t", "vlat", "y"), texts=("seq", "label"))
_SIDES = {"L": 1.0, "R": -1.0}


def lane_changes(folder: Path | None) -> list[ChangeMeasures]:
    """All lane changes whose onset and end were seen; none if the set is absent.

    Args:
        folder: With the sets.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "ngsim_lc")
    if path is None:
        return []
    table = read_table(path, _COLUMNS)
    found = []
    for rows in groups(table["seq"]):
        side = _SIDES.get(str(table["label"][rows[0]]))
        if side is None:
            continue
        speed = side * table["vlat"][rows]
        time = table["t"][rows]
        peak = float(time[np.argmax(speed)])
        found.append(change_measures(time, side * table["y"][rows], speed, peak))
    return [change for change in found if change is not None]
