"""A look counts if the head is seen and held still."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from costeer.devices.head.looks import SETTLING, steady_yaw
from costeer.devices.head.source import HeadReading


class Head:
    """A tracker whose clock goes on by a thirtieth of a second at each reading."""

    def __init__(self, seen: Callable[[float], HeadReading]) -> None:
        self.now = 0.0
        self._seen = seen

    def read(self) -> HeadReading:
        """What is seen now."""
        self.now += 1.0 / 30.0
        return self._seen(self.now)

    def close(self) -> None:
        """Nothing to release."""

    def clock(self) -> float:
        """Time of the tracker [s]."""
        return self.now


def yaw_of(seen: Callable[[float], HeadReading]) -> float:
    head = Head(seen)
    return steady_yaw(head, 0.5, head.clock)


def test_the_median_counts_and_not_what_was_before() -> None:
    def settles(now: float) -> HeadReading:
        wrong = now < SETTLING or 0.8 < now < 0.9  # 18 of 30 readings
        return HeadReading(now, 0.1 if wrong else 0.2, True)

    assert yaw_of(settles) == 0.2


def test_a_head_that_is_hardly_seen_is_refused() -> None:
    with pytest.raises(ValueError, match="seen 0 times"):
        yaw_of(lambda now: HeadReading(now, 0.2, False))


def test_one_reading_many_times_is_one_reading() -> None:
    with pytest.raises(ValueError, match="seen 1 times"):
        yaw_of(lambda _: HeadReading(SETTLING, 0.2, True))


def test_a_head_that_moves_is_refused() -> None:
    with pytest.raises(ValueError, match="hold it still"):
        yaw_of(lambda now: HeadReading(now, 0.2 * math.sin(8.0 * now), True))
