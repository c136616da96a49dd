"""Drives made of a few formulas: glance, quintic lane change, wander and noise."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.training.recordings import Recording, recording

RATE = 60.0
LANE_WIDTH = 3.5
DURATION = 5.0
SPEED = 20.0


def progress(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quintic from 0 to 1 over `DURATION`, at rest before and after."""
    s = np.clip(time / DURATION, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def columns(
    seed: int, num_changes: int = 4, glances_tell: bool = True
) -> dict[str, NDArray[Any]]:
    """A drive on two lanes that changes lane every 20 s, starting in the left one.

    Args:
        seed: Of all noise.
        num_changes: Lane changes.
        glances_tell: Whether a glance precedes each; else glances come at random.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(round((20.0 * num_changes + 15.0) * RATE)) / RATE
    lateral = 0.2 * np.sin(0.35 * time + rng.uniform(0.0, 6.3))
    head = 0.01 * rng.normal(size=time.size)
    for i in range(num_changes):
        start = 15.0 + 20.0 * i + rng.uniform(-2.0, 2.0)
        side = -1.0 if i % 2 == 0 else 1.0
        lateral += side * LANE_WIDTH * progress(time - start)
        look = start - 2.0 if glances_tell else rng.uniform(0.0, time[-1])
        head += side * 0.5 * np.exp(-(((time - look) / 0.4) ** 2))
    velocity = np.gradient(lateral, time)
    steering = 16.0 * 2.7 / SPEED**2 * np.gradient(velocity, time)
    lane = (lateral > -LANE_WIDTH / 2.0).astype(np.int8)
    return {
        "time": time,
        "lane": lane,
        "head_yaw": head,
        "longitudinal_acceleration": 0.1 * rng.normal(size=time.size),
        "longitudinal_velocity": SPEED + np.sin(0.1 * time),
        "steering_wheel_angle": steering + 0.002 * rng.normal(size=time.size),
        "distance_to_adjacent_lane": np.abs(lateral + LANE_WIDTH / 2.0),
        "yaw_angle": velocity / SPEED,
    }


def drive(driver: int, **arguments: Any) -> Recording:
    """A recording of one driver."""
    return recording(
        f"driver {driver}", f"drive {driver}", columns(driver, **arguments)
    )


def drives(num_drivers: int, **arguments: Any) -> list[Recording]:
    """One recording of each of several drivers."""
    return [drive(driver, **arguments) for driver in range(num_drivers)]
