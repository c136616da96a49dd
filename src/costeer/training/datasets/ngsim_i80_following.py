"""Vehicles on I-80 that keep their lane for half a minute (set `ngsim_i80_following`).

10 Hz, raw, no lane change in any: true negatives. Lateral place is that from the left
edge of the road, lane 1 is the leftmost, and only lanes 1 to 3 of the six occur; so
there is always a lane to the right, and one to the left of lanes 2 and 3. Lanes are 12
ft wide. Vehicles drive 0.37 m to the left of the centres that follow if the edge is at
zero, in all three lanes alike, so the lines are taken to lie so much further left.

Yaw is that of the path: lateral over longitudinal velocity, the former the slope of
the place over the last 0.5 s (`resample.slope`), so that of 0.25 s ago.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.training.datasets.stretches import Stretch, both_runs, cut
from costeer.training.datasets.tables import Columns, Table, groups, table_of
from costeer.training.recordings import Recording
from costeer.training.resample import slope

FILES = ("pairs.csv.gz",)

_COLUMNS = Columns(
    numbers=(
        *("vehicle_id", "time", "frame_id", "lane_id"),
        *("local_x", "v_vel", "v_acc"),
    ),
    texts=("pair_id",),
)


class RoadParameters(NamedTuple):
    """Lanes of I-80 in the coordinates of the set.

    Attributes:
        lane_width: [m]. Source: NGSIM I-80, lanes of 12 ft.
        edge: Left line of lane 1 [m]. Source: this set; the medians of the lateral
            place in lanes 1 to 3 are 0.40, 0.34 and 0.38 m left of the centres of
            lanes that begin at zero.
        num_lanes: In all, the ramp apart [-]. Source: NGSIM I-80.
        yaw_span: Over which the lateral velocity is taken [s]. Source: assumed, as
            short as the noise of the tracking allows.
        least_velocity: Yaw is that at this velocity when slower [m/s]. Source:
            assumed; the path of a standing vehicle has no direction.
    """

    lane_width: float = 3.66
    edge: float = -0.37
    num_lanes: int = 6
    yaw_span: float = 0.5
    least_velocity: float = 1.0


PARAMETERS = RoadParameters()


def read(folder: Path) -> list[Recording]:
    """Recordings of the set.

    Args:
        folder: With `pairs.csv.gz`.

    Raises:
        ValueError: If the table cannot be read.
    """
    table = table_of(folder, FILES[0], _COLUMNS)
    found = []
    for rows in groups(table["pair_id"]):
        whole = _stretch(table, rows)
        good = np.isfinite(whole.signals["yaw_angle"])
        for stretch in cut(whole, good, _gaps(table, rows)):
            found += both_runs(stretch)
    return found


def path_yaw(
    time: NDArray[np.float64], place: NDArray[np.float64], velocity: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Direction of the path against the road, left positive, `(row,)` [rad].

    Args:
        time: Evenly spaced [s].
        place: From the left, so right positive [m].
        velocity: Along the road [m/s].
    """
    sideways = -slope(time, place, PARAMETERS.yaw_span)
    return np.arctan2(sideways, np.maximum(velocity, PARAMETERS.least_velocity))


def _stretch(table: Table, rows: NDArray[np.intp]) -> Stretch:
    time, lane = table["time"][rows], table["lane_id"][rows]
    place, velocity = table["local_x"][rows], table["v_vel"][rows]
    from_left = place - PARAMETERS.edge - (lane - 1.0) * PARAMETERS.lane_width
    return Stretch(
        driver=f"i80-{table['vehicle_id'][rows[0]]:.0f}",
        name=f"ngsim_i80_following:{table['pair_id'][rows[0]]}",
        time=time,
        signals={
            "longitudinal_acceleration": table["v_acc"][rows],
            "longitudinal_velocity": velocity,
            "yaw_angle": _yaw(table, rows),
        },
        to_left=from_left,
        to_right=PARAMETERS.lane_width - from_left,
        lane_left=lane > 1.0,
        lane_right=lane < PARAMETERS.num_lanes,
        notes=(
            f"yaw is the direction of the path over the last {PARAMETERS.yaw_span:g} s",
        ),
    )


def _yaw(table: Table, rows: NDArray[np.intp]) -> NDArray[np.float64]:
    """Yaw, from the beginning again after each gap in the frames."""
    fresh = np.flatnonzero(_gaps(table, rows))
    parts = [
        path_yaw(table["time"][each], table["local_x"][each], table["v_vel"][each])
        if len(each) > 1
        else np.full(len(each), np.nan)
        for each in np.split(rows, fresh)
    ]
    return np.concatenate(parts)


def _gaps(table: Table, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Rows that do not follow on the frame before; their times do not show it."""
    frames = table["frame_id"][rows]
    return np.asarray(np.diff(frames, prepend=frames[0] - 1.0) != 1.0)
