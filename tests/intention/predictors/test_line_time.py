"""Time to lane crossing against what geometry says."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.predictors.line_time import (
    LONGEST,
    SHORTEST,
    crossing_probabilities,
    lag,
    time_to_lane_crossing,
)
from tests.intention.predictors.made import MEAN, line_time


def drift(yaw: float, distance: float, speed: float = 20.0) -> np.ndarray:
    """A car that goes straight on towards the line, 200 samples."""
    time = np.arange(200) / 60.0
    seen = np.tile(MEAN, (200, 1))
    seen[:, 2], seen[:, 5] = speed, yaw
    seen[:, 4] = distance + speed * np.sin(yaw) * time
    return seen


@pytest.mark.parametrize("time_constant", [0.0, 0.1, 0.5])
def test_a_constant_drift_has_its_exact_time(time_constant: float) -> None:
    seen = drift(yaw=-0.01, distance=2.0)
    time = time_to_lane_crossing(seen, time_constant)[179:]
    exact = 2.0 / (20.0 * np.sin(0.01)) - np.arange(179, 200) / 60.0
    np.testing.assert_allclose(time, exact, rtol=1e-12)


def test_a_car_that_does_not_approach_has_the_longest_time() -> None:
    for yaw in (0.0, 0.01):
        time = time_to_lane_crossing(drift(yaw, 1.75), 0.0)[179:]
        np.testing.assert_allclose(time, LONGEST, rtol=1e-6)


def test_a_car_on_the_line_has_the_shortest_time() -> None:
    assert time_to_lane_crossing(drift(-0.01, 0.0), 0.0)[179] == SHORTEST


def test_a_lag_answers_a_step_as_the_first_order_does() -> None:
    # Sampled at 60 Hz and cut after 3 s: e^-15 is missing, half a sample is early.
    answer = np.cumsum(lag(0.2))
    time = (np.arange(180) + 0.5) / 60.0
    np.testing.assert_allclose(answer, 1.0 - np.exp(-time / 0.2), atol=0.05)
    assert answer[-1] == pytest.approx(1.0)
    np.testing.assert_allclose(lag(0.0), np.eye(180)[0], atol=1e-12)


def test_the_nearer_crossing_is_the_likelier_one() -> None:
    said = crossing_probabilities(line_time(), drift(-0.01, 2.0))[179:]
    assert (np.diff(said) > 0.0).all()
