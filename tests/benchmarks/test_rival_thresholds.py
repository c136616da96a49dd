"""What the benchmark reckons from a record is what the methods see."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.rival_thresholds import LONGEST, crossing_times, intents
from costeer.loop.parameters import DT


def columns(num: int, **values: float) -> dict[str, np.ndarray]:
    return {name: np.full(num, value) for name, value in values.items()}


def test_the_time_to_the_line_is_distance_over_velocity_towards_it() -> None:
    given = columns(
        3,
        yaw_angle=0.02,
        longitudinal_velocity=25.0,
        lateral_velocity=0.1,
        distance_to_adjacent_lane=1.2,
    )
    velocity = 25.0 * math.sin(0.02) + 0.1 * math.cos(0.02)
    times = crossing_times(given, np.array([1.0, -1.0, 1.0]))
    assert times == pytest.approx([-1.2 / velocity, -LONGEST, -1.2 / velocity])


def test_a_steady_torque_comes_to_its_leaky_integral() -> None:
    given = columns(
        600, driver_torque=-0.5, steering_wheel_angle=0.0, steering_wheel_rate=0.0
    )
    side = np.full(600, -1.0)
    for k in (59, 299, 599):
        expected = 0.5 * 2.0 * (1.0 - math.exp(-(k + 1) * DT / 2.0))
        assert intents(given, side)[k] == pytest.approx(expected, rel=5e-3)


def test_relaxed_arms_on_a_wheel_that_turns_ask_for_nothing() -> None:
    # Arms of 1.0 N·m·s/rad on a wheel at 0.2 rad/s: -0.2 N·m, no will.
    time = DT * np.arange(600)
    given = columns(600, driver_torque=-0.2, steering_wheel_rate=0.2)
    given["steering_wheel_angle"] = 0.2 * time
    late = intents(given, np.ones(600))[-1]
    assert abs(late) < 0.01
