"""Lane changes and positions with closed forms, as columns of a trial record."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, radians, sqrt, tan

import numpy as np
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.float64]]

WIDTH = 3.5
SPEED = 20.0


def changes(
    plan: Sequence[tuple[float, float, int]],
    length: float = 60.0,
    rate: float = 60.0,
    offset: float = 0.0,
) -> Columns:
    """Quintic lane changes of a car without side slip at constant speed.

    Args:
        plan: Start [s], duration [s] and direction of each.
        length: Of the record [s].
        rate: Samples per second [Hz].
        offset: Lateral position at the start [m].
    """
    time = np.arange(round(length * rate) + 1) / rate
    position, speed = np.full(time.size, offset), np.zeros(time.size)
    for start, duration, direction in plan:
        s = np.clip((time - start) / duration, 0.0, 1.0)
        position += direction * WIDTH * s**3 * (10 - 15 * s + 6 * s**2)
        speed += direction * WIDTH / duration * 30 * s**2 * (1 - s) ** 2
    return {
        "time": time,
        "lateral_position": position,
        "yaw_angle": np.arctan2(speed, SPEED),
        "longitudinal_velocity": np.full(time.size, SPEED),
        "longitudinal_position": SPEED * time,
    }


def duration_above_speed(duration: float, threshold: float) -> float:
    """Time for which a quintic change is faster sideways than a threshold [s].

    Its lateral speed is 30 d/T s²(1-s)², so s(1-s) = √(v T / 30 d) at the threshold.
    """
    product = sqrt(threshold * duration / (30 * WIDTH))
    return duration * sqrt(1 - 4 * product)


def duration_above_yaw(duration: float, threshold: float = radians(0.5)) -> float:
    """Time for which the yaw of a quintic change exceeds a threshold [s]."""
    return duration_above_speed(duration, SPEED * tan(threshold))


def peak_yaw(duration: float) -> float:
    """Largest yaw of a quintic change [rad]: lateral speed 1.875 d/T."""
    return atan(1.875 * WIDTH / duration / SPEED)
