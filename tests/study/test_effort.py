"""Opposing torque, conflict, jerk and wheel rate of signals in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from costeer.study.effort import (
    CONFLICT_TIME,
    CONFLICT_TORQUE,
    conflict_share,
    lateral_jerk_rms,
    opposing_torque_rms,
    wheel_rate_rms,
)

TIME = np.arange(600) / 60.0  # 10 s


def columns(**given: Any) -> dict[str, Any]:
    zeros = np.zeros(TIME.size)
    usual = {
        "time": TIME,
        "driver_torque": zeros,
        "applied_torque": zeros,
        "mode": np.full(TIME.size, "lane_keeping"),
    }
    return usual | given


def test_torque_along_with_the_driver_is_no_opposing_torque() -> None:
    ours = columns(driver_torque=np.ones(600), applied_torque=np.full(600, 2.0))
    assert opposing_torque_rms(ours).value == 0.0
    assert conflict_share(ours).value == 0.0


def test_opposing_torque_is_that_of_the_guidance() -> None:
    # Against the driver in a quarter of the time: 2 N·m times the root of a quarter.
    guidance = np.where(TIME < 2.5, -2.0, 2.0)
    ours = columns(driver_torque=np.full(600, 0.1), applied_torque=guidance)
    assert opposing_torque_rms(ours).value == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("seconds", "torque", "share"),
    [
        (3.0, 1.0, 0.3),
        (3.0, 0.9 * CONFLICT_TORQUE, 0.0),
        (CONFLICT_TIME - 2.0 / 60.0, 1.0, 0.0),
        (CONFLICT_TIME, 1.0, 0.02),
    ],
)
def test_a_conflict_is_strong_and_lasts(
    seconds: float, torque: float, share: float
) -> None:
    end = 2.0 + seconds - 1e-9
    pushing = (TIME >= 2.0) & (end > TIME)
    ours = columns(
        driver_torque=np.where(pushing, torque, 0.0),
        applied_torque=np.where(pushing, -3.0, 3.0),
    )
    assert conflict_share(ours).value == pytest.approx(share)


def test_without_guidance_nothing_opposes() -> None:
    ours = columns(mode=np.full(TIME.size, "manual"))
    for measure in (opposing_torque_rms, conflict_share):
        assert measure(ours).reason == "there is no guidance"


def test_jerk_of_a_sine_is_its_rate() -> None:
    # RMS of a w cos(w t) over whole periods is a w / sqrt(2); central differences
    # lower it by (w dt)² / 6, one-sided ends change two samples of 600.
    frequency, size = 2.0 * np.pi * 0.5, 1.5
    ours = {"time": TIME, "lateral_acceleration": size * np.sin(frequency * TIME)}
    exact = size * frequency / np.sqrt(2.0)
    assert lateral_jerk_rms(ours).value == pytest.approx(exact, rel=2e-3)
    assert lateral_jerk_rms({"time": TIME}).reason


def test_wheel_rate_is_that_of_the_whole_course() -> None:
    rate = np.where(TIME < 5.0, 0.2, -0.2)
    ours = {"steering_wheel_rate": rate, "steering_wheel_angle": TIME, "time": TIME}
    assert wheel_rate_rms(ours).value == pytest.approx(0.2)
