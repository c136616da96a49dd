"""The looks of a calibration: hold the head still, and read where it points."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable

from costeer.devices.head.source import HeadSource

SETTLING = 0.5
"""Readings so soon after the start of a look are left out [s]."""

DURATION = 1.5
"""Length of a look [s]."""

LEAST_READINGS = 10
"""Valid readings that a look needs."""

LARGEST_SPREAD = math.radians(3.0)
"""Standard deviation within a look up to which the head was still [rad]."""


def steady_yaw(
    source: HeadSource,
    duration: float = DURATION,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Median of the tracker's yaw while the head is held still [rad].

    Args:
        source: The tracker.
        duration: Of the look, after the head has settled [s].
        clock: Monotonic [s].

    Raises:
        ValueError: If the head is hardly seen or moves.
        HeadLost: If the tracker is gone.
    """
    start = clock() + SETTLING
    found: dict[float, float] = {}
    while clock() < start + duration:
        reading = source.read()
        if reading.valid and reading.time >= start:
            found[reading.time] = reading.head_yaw
    if len(found) < LEAST_READINGS:
        raise ValueError(
            f"the head was seen {len(found)} times in {duration:g} s, not "
            f"{LEAST_READINGS} times; check light and place of the camera, or turn "
            "the head less"
        )
    if statistics.pstdev(found.values()) > LARGEST_SPREAD:
        raise ValueError("the head moved during the look; hold it still and try again")
    return statistics.median(found.values())
