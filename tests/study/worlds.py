"""Records of other roads than the paper's, with other cars; closed forms are known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import TrialRecord

RATE = 60.0
SPEED = 20.0
LANE = 3.5

Columns = dict[str, NDArray[Any]]


def straight(seconds: float = 60.0, lateral: float = 0.0) -> Columns:
    """A car that drives straight on at 20 m/s."""
    time = np.arange(round(seconds * RATE) + 1) / RATE
    return {
        "time": time,
        "longitudinal_position": SPEED * time,
        "longitudinal_velocity": np.full(time.size, SPEED),
        "lateral_position": np.full(time.size, lateral),
        "yaw_angle": np.zeros(time.size),
        "steering_wheel_angle": np.zeros(time.size),
        "contact": np.zeros(time.size, np.int8),
        "road_curvature": np.zeros(time.size),
    }


def changing(plan: list[tuple[float, int]], lateral: float = 0.0) -> Columns:
    """A car that changes lanes in 6 s along quintics: start [s] and direction."""
    columns = straight(lateral=lateral)
    time, sideways = columns["time"], np.zeros(columns["time"].size)
    for start, direction in plan:
        s = np.clip((time - start) / 6.0, 0.0, 1.0)
        columns["lateral_position"] = columns["lateral_position"] + direction * LANE * (
            s**3 * (10 - 15 * s + 6 * s**2)
        )
        sideways += direction * LANE / 6.0 * 30 * s**2 * (1 - s) ** 2
    return columns | {"yaw_angle": np.arctan2(sideways, SPEED)}


def car(number: int, gap: Any, lateral: Any, velocity: float) -> Columns:
    """Another car, as far from the driven one's middle as `gap` says [m]."""
    own = straight()["longitudinal_position"]
    every = np.ones(own.size)
    return {
        f"car_{number:02d}_position": own + gap,
        f"car_{number:02d}_lateral": lateral * every,
        f"car_{number:02d}_velocity": velocity * every,
    }


def record(columns: Columns, **road: float) -> TrialRecord:
    """A record on a road of so many lanes."""
    known = {"lane_width": LANE, "num_lanes": 3.0, "overtaking_side": -1.0} | road
    return TrialRecord({"configuration": {"road": known}}, columns)


def mirrored(columns: Mapping[str, NDArray[Any]], num_lanes: int) -> Columns:
    """The same drive with left and right swapped, on any number of lanes."""
    across, width = {"yaw_angle", "steering_wheel_angle"}, (num_lanes - 1) * LANE
    found = {}
    for name, values in columns.items():
        if name in across:
            values = -values
        if name == "lateral_position" or name.endswith("_lateral"):
            values = -width - values
        if name == "road_curvature":  # of the lane that is the left one then
            values = -values / (1.0 + values * width)
        found[name] = values
    return found
