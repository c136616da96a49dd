"""Vehicles on US-101, Lankershim and Peachtree with lanes (set `ngsim_commonroad`).

10 Hz, raw. Distances are those to the boundaries of the lane the centre is in; yaw is
that against the lane. A vehicle has its number as driver; numbers begin anew every 15
minutes, so two vehicles may share one, but none is split.

Cut out: rows outside every lane; from the first to the last of crossings that go to
and fro within 2 s (`chatter`: no lane change, and what the driver meant is not known);
the stretch ends where a distance jumps without a crossing, as where a road widens.

Which side has a lane: lanes count from the left, so all but lane 0 have one on the
left. US-101 has five lanes throughout; elsewhere, and to the right of the fifth (an
auxiliary lane between two ramps), a lane is there if a vehicle of the same scenario was
seen in it near that place. The scenarios' maps have different origins, so a place of
one says nothing about another.
"""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from costeer.training.datasets.stretches import Crossing, Stretch, both_runs, cut
from costeer.training.datasets.tables import Columns, Table, groups, table_of
from costeer.training.recordings import Recording

FILES = ("tracks.csv.gz", "events.csv")

_TRACKS = Columns(
    numbers=(
        *("vehicle", "t", "x", "y", "heading", "v", "a"),
        *("lane", "psi", "d_left", "d_right"),
    ),
    texts=("track", "site", "src"),
)
_EVENTS = Columns(numbers=("t_cross",), texts=("track", "side", "chatter"))
_SIDES = {"L": 1, "R": -1}
_THROUGH_LANES = {"US101": 5}


class LaneParameters(NamedTuple):
    """How lanes are told from vehicles.

    Attributes:
        reach: A vehicle this near in the next lane tells that it is there [m].
            Source: assumed; half of a gap in dense traffic.
        turned: A heading that differs by 1 rad counts as so far away [m]. Source:
            assumed; keeps crossing roads apart.
        jump: Largest change of a distance in 0.1 s without a crossing [m]. Source:
            assumed, 5 m/s to the side.
        chatter: Crossings flagged so belong together within this time [s]. Source:
            definition of the set, crossed back within 2 s.
    """

    reach: float = 30.0
    turned: float = 30.0
    jump: float = 0.5
    chatter: float = 2.0


PARAMETERS = LaneParameters()


def read(folder: Path) -> list[Recording]:
    """Recordings of the set.

    Args:
        folder: With `tracks.csv.gz` and `events.csv`.

    Raises:
        ValueError: If a table cannot be read.
    """
    table = table_of(folder, FILES[0], _TRACKS)
    events = table_of(folder, FILES[1], _EVENTS)
    lane_right = lanes_seen(table)
    return [
        run
        for rows in groups(table["track"])
        for stretch in _stretches(table, events, rows, lane_right[rows])
        for run in both_runs(stretch)
    ]


def lanes_seen(table: Table) -> NDArray[np.bool_]:
    """Whether there is a lane to the right, `(row,)`."""
    lane = table["lane"]
    found = np.zeros(len(lane), bool)
    for site, num_lanes in _THROUGH_LANES.items():
        here = table["site"] == site
        found |= here & (lane >= 0) & (lane < num_lanes - 1)
    for rows in groups(table["src"]):
        for number in np.unique(lane[rows][lane[rows] >= 0]):
            mine = rows[lane[rows] == number]
            next_lane = rows[lane[rows] == number + 1]
            found[mine] |= _near(table, mine, next_lane)
    return found


def _near(
    table: Table, mine: NDArray[np.intp], others: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Whether one of the others was near each of mine, at whatever time."""
    if not len(others):
        return np.zeros(len(mine), bool)
    distance, _ = cKDTree(_poses(table, others)).query(_poses(table, mine))
    return np.asarray(distance <= PARAMETERS.reach)


def _poses(table: Table, rows: NDArray[np.intp]) -> NDArray[np.float64]:
    """Place and direction as points, `(row, 4)` [m]."""
    heading, turned = table["heading"][rows], PARAMETERS.turned
    return np.stack(
        [
            table["x"][rows],
            table["y"][rows],
            turned * np.cos(heading),
            turned * np.sin(heading),
        ],
        axis=1,
    )


def _stretches(
    table: Table,
    events: Table,
    rows: NDArray[np.intp],
    lane_right: NDArray[np.bool_],
) -> list[Stretch]:
    """The usable parts of one track."""
    track, time = table["track"][rows[0]], table["t"][rows]
    mine = np.flatnonzero(events["track"] == track)
    mine = mine[np.argsort(events["t_cross"][mine])]
    meant = mine[events["chatter"][mine] != "True"]
    whole = Stretch(
        driver=f"{table['site'][rows[0]]}-{table['vehicle'][rows[0]]:.0f}",
        name=f"ngsim_commonroad:{track}",
        time=time,
        signals={
            "longitudinal_acceleration": table["a"][rows],
            "longitudinal_velocity": table["v"][rows],
            "yaw_angle": table["psi"][rows],
        },
        to_left=table["d_left"][rows],
        to_right=table["d_right"][rows],
        lane_left=table["lane"][rows] > 0,
        lane_right=lane_right,
        crossings=[
            Crossing(float(events["t_cross"][k]), _SIDES[str(events["side"][k])])
            for k in meant
        ],
        notes=("lane lines are 0.1 to 0.5 m off; crossings have 0.3 s of error",),
    )
    chatter = events["t_cross"][np.setdiff1d(mine, meant)]
    good = (table["lane"][rows] >= 0) & ~_between(time, np.sort(chatter))
    return cut(whole, good, _jumps(whole, events["t_cross"][mine]))


def _between(
    time: NDArray[np.float64], instants: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Rows from the first to the last of instants that follow each other closely."""
    found = np.zeros(len(time), bool)
    for first, last in itertools.pairwise(instants):
        if last - first <= PARAMETERS.chatter:
            found |= (time > first - 1e-6) & (time < last - 1e-6)
    return found


def _jumps(whole: Stretch, crossed: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Rows whose distances do not follow from those of the row before."""
    found = np.zeros(len(whole.time), bool)
    for distance in (whole.to_left, whole.to_right):
        step = np.diff(np.asarray(distance), prepend=np.nan)
        found |= np.abs(step) > PARAMETERS.jump
    after = np.searchsorted(whole.time, crossed - 1e-6)
    found[after[after < len(found)]] = False
    return found
