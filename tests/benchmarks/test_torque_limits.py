"""The campaign of random torques sees what passes a limit, and nothing does."""

from __future__ import annotations

import math

import pytest

from benchmarks.torque_limits import (
    Limits,
    seen,
    through_a_drive,
    through_actuation,
    through_guard,
)


@pytest.mark.parametrize(
    ("torques", "keeps"),
    [
        ([0.5, 1.0, 0.5], True),
        ([0.5, 1.0, 1.1], False),
        ([0.5, -0.1, 0.0], False),
        ([0.6, 0.5, 0.4], False),
        ([0.5, math.nan, 0.5], False),
        ([0.5, math.inf], False),
    ],
)
def test_torque_that_is_too_large_too_fast_or_no_number_is_seen(
    torques: list[float], keeps: bool
) -> None:
    found = seen("here", iter(torques), 0.1, Limits(torque=1.0, rate=5.0))
    assert found.keeps is keeps


def test_random_torques_keep_all_limits() -> None:
    guard, controller = through_guard(20_000), through_actuation(5_000)
    drive = through_a_drive(3.0)
    assert guard.keeps
    assert controller.keeps
    assert drive.keeps
    assert (guard.number, controller.number) == (20_000, 5_000)
    assert (guard.limits.torque, controller.limits.torque) == (8.0, 5.0)
    assert drive.number > 2000
    assert drive.torque > 0.0
