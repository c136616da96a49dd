"""When inconsistencies come: before, in or after a lane change, Sec. IV-E."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from costeer.methods.conditions import MANUAL
from costeer.records.record import read_record
from costeer.study.inconsistencies import find_inconsistencies
from costeer.study.material import StudyMaterial
from costeer.study.people import Who

FARTHEST = 10.0
"""An inconsistency belongs to the nearest crossing within this time [s]. Source:
assumed, the longest lane change of Table IV and 2 s."""

_READ = ("consistent", "haptic_gain", "mode")


class Dispute(NamedTuple):
    """An inconsistency and where in a lane change it began.

    Attributes:
        participant: Whose.
        condition: In which.
        start_time: Of the trial [s].
        from_crossing: After the nearest crossing of a lane change [s], negative before
            it; NaN if there is none within `FARTHEST`.
        share: Of the lane change that had passed, 0 at its start and 1 at its end; NaN
            outside of one.
    """

    participant: Who
    condition: str
    start_time: float
    from_crossing: float
    share: float


def disputes(material: StudyMaterial) -> list[Dispute]:
    """All inconsistencies of assisted trials, in the order of the trials."""
    changes = material.lane_changes
    by_trial = (
        dict(list(changes.groupby(["participant", "condition"])))
        if len(changes)
        else {}
    )
    found = []
    for (who, name), path in material.records.items():
        if name == MANUAL:
            continue
        begun = find_inconsistencies(read_record(path, _READ).columns)
        own = by_trial.get((who, name))
        for each in () if isinstance(begun, str) else begun:
            where = in_lane_change(each.start_time, own)
            found.append(Dispute(who, name, each.start_time, *where))
    return found


def in_lane_change(start: float, changes: pd.DataFrame | None) -> tuple[float, float]:
    """Time from the nearest crossing [s], and share of the lane change it is in."""
    if changes is None:
        return math.nan, math.nan
    after = start - changes["crossing_time"].to_numpy(np.float64)
    nearest = int(np.argmin(np.abs(after)))
    if abs(after[nearest]) > FARTHEST:
        return math.nan, math.nan
    chosen = changes.iloc[nearest]
    begin, end = float(chosen["start_time"]), float(chosen["end_time"])
    inside = begin <= start <= end and end > begin
    share = (start - begin) / (end - begin) if inside else math.nan
    return float(after[nearest]), share
