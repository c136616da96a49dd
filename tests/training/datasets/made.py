"""Made-up drives in the very formats of the real sets.

A drive keeps the middle of a lane of 3.6 m at 20 m/s, changes to the next lane in 5 s
along the quintic of least jerk, and keeps that one. So the crossing is at 8.5 s.
"""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Series = NDArray[np.float64]

WIDTH = 3.6
VELOCITY = 20.0
START = 6.0
DURATION = 5.0
CROSSING = START + DURATION / 2.0
LENGTH = 16.0
SIDES = {1: "L", -1: "R", 0: "K"}


class Drive(NamedTuple):
    """A drive at 10 Hz, `(row,)` each."""

    time: Series
    place: Series  # from the middle of the first lane, left positive
    sideways: Series
    yaw: Series
    inside: Series  # from the middle of the lane the car is in
    crossed: NDArray[np.bool_]


def drive(side: int, length: float = LENGTH) -> Drive:
    time = np.arange(0.0, length, 0.1).round(1)
    share = np.clip((time - START) / DURATION, 0.0, 1.0)
    place = side * WIDTH * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    sideways = side * WIDTH * 30.0 * share**2 * (1.0 - share) ** 2 / DURATION
    crossed = (time >= CROSSING) & (side != 0)
    return Drive(
        time=time,
        place=place,
        sideways=sideways,
        yaw=np.arctan2(sideways, VELOCITY),
        inside=place - side * WIDTH * crossed,
        crossed=crossed,
    )


def write(path: Path, columns: dict[str, Any]) -> None:
    """Add rows to a table; scalars are repeated, NaN is an empty cell."""
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays = np.broadcast_arrays(*(np.atleast_1d(v) for v in columns.values()))
    rows = [",".join(map(str, row)) for row in zip(*arrays, strict=True)]
    lines = stored_lines(path) or [",".join(columns)]
    text = "\n".join([*lines, *rows]).replace("nan", "") + "\n"
    if path.suffix == ".gz":
        path.write_bytes(gzip.compress(text.encode(), mtime=0))
    else:
        path.write_text(text)


def stored_lines(path: Path) -> list[str]:
    if not path.is_file():
        return []
    raw = path.read_bytes()
    text = gzip.decompress(raw) if path.suffix == ".gz" else raw
    return text.decode().splitlines()


def write_ngsim_lc(folder: Path, side: int, seq: str = "", **other: Any) -> None:
    made = drive(side)
    columns = {
        "seq": seq or f"101-{SIDES[side]}-001",
        "site": 101,
        "label": SIDES[side],
        "t": made.time,
        "v": VELOCITY,
        "vlat": made.sideways,
        "a": 0.5,
        "alat": 0.0,
        "psi": made.yaw,
        "yaw_rate": 0.0,
        "y": made.place,
    }
    write(folder / "ngsim_lc" / "sequences.csv.gz", columns | other)


def write_ngsim_commonroad(
    folder: Path,
    side: int,
    lane: int | NDArray[np.int64] = 2,
    track: str = "US101-7-0",
    site: str = "US101",
    **other: Any,
) -> None:
    """One track and, if it changes lanes, its event."""
    made = drive(side)
    columns = {
        "track": track,
        "site": site,
        "vehicle": int(track.split("-")[1]),
        "t": made.time,
        "x": VELOCITY * made.time,
        "y": made.place - WIDTH * lane,
        "heading": made.yaw,
        "v": VELOCITY,
        "a": 0.5,
        "lane": np.where(made.crossed, lane - side, lane),
        "lat": made.inside,
        "psi": made.yaw,
        "d_left": WIDTH / 2.0 - made.inside,
        "d_right": WIDTH / 2.0 + made.inside,
        "lc": "",
        "length": 4.5,
        "width": 1.8,
        "src": f"USA_{site}-1_1_T-1",
    }
    write(folder / "ngsim_commonroad" / "tracks.csv.gz", columns | other)
    write_events(folder, track, [(CROSSING, side)] if side else [], "False")


def write_events(
    folder: Path, track: str, crossings: list[tuple[float, int]], chatter: str
) -> None:
    columns = {
        "track": track,
        "t_cross": np.array([time for time, _ in crossings], float),
        "side": np.array([SIDES[side] for _, side in crossings], str),
        "chatter": chatter,
    }
    write(folder / "ngsim_commonroad" / "events.csv", columns)


def write_r3_driving(
    folder: Path,
    side: int,
    scenario: str = "scenario_001",
    late: float = 0.3,
    clean: str = "True",
    **other: Any,
) -> None:
    """One scenario; the lines name the old lane for a while after the crossing."""
    made = drive(side)
    old = made.crossed & (made.time < CROSSING + 0.05 + late)
    named = made.inside + side * WIDTH * old
    columns = {
        "scenario": scenario,
        "t": made.time,
        "v": VELOCITY,
        "ax": 0.5,
        # A camera sees millimetres of noise: lines that stand still are not seen.
        "left0": named - WIDTH / 2.0 + wobble(made.time, side),
        "right0": named + WIDTH / 2.0 + wobble(made.time, side),
        "left1": named - 3.0 * WIDTH / 2.0,
        "right1": named + 3.0 * WIDTH / 2.0,
        "left0_slope": made.yaw,
        "right0_slope": made.yaw,
    }
    write(folder / "r3_driving" / "expert.csv.gz", columns | other)
    event = {"scenario": scenario, "t_cross": CROSSING + 0.05, "side": SIDES[side]}
    times = np.array([event["t_cross"]] if side else [], float)
    entry = event | {"t_cross": times, "clean": clean}
    write(folder / "r3_driving" / "crossings.csv", entry)


def wobble(time: Series, side: int) -> Series:
    return np.asarray((side or 1) * 0.001 * (np.round(time * 10.0) % 2))


def write_brain4cars_head(
    folder: Path,
    side: int,
    sample: str = "20141025_1_0_150",
    lane: int = 2,
    **other: Any,
) -> None:
    """One window with a glance to the side at 2 s before its end, camera askew."""
    label = {1: "lchange", -1: "rchange", 0: "end_action"}[side]
    time = (np.arange(151) - 150) * 0.04
    glance = (time > -2.0) & (time < -1.0)
    columns = {
        "label": label,
        "sample": sample,
        "t": time.round(2),
        "yaw": 0.3 - side * 0.6 * glance,
        "speed": 72.0,
    }
    write(folder / "brain4cars_head" / "frames.csv.gz", columns | other)
    row = {"label": label, "sample": sample, "day": sample[:8]}
    row |= {"frames": 151, "lane_no": lane, "lanes_total": 3, "intersection": 0}
    write(folder / "brain4cars_head" / "samples.csv", row)


def write_ngsim_i80_following(
    folder: Path, lane: int = 2, pair: str = "47-39", **other: Any
) -> None:
    """A vehicle that drifts to the left at 0.2 m/s, from the middle of its lane."""
    time = np.arange(0.0, 6.0, 0.1).round(1)
    columns = {
        "pair_id": pair,
        "vehicle_id": int(pair.split("-")[0]),
        "time": time,
        "frame_id": np.round(510.0 + time * 10.0),
        "lane_id": lane,
        "local_x": 3.66 * (lane - 0.5) - 0.37 - 0.2 * time,
        "v_vel": VELOCITY,
        "v_acc": 0.5,
    }
    write(folder / "ngsim_i80_following" / "pairs.csv.gz", columns | other)
