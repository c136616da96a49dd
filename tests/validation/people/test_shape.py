"""Lane changes by lateral speed, and their shape beside the quintic."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.validation.people.shape import (
    change_measures,
    mean_shape_rms,
    quintic,
    rms,
    whole_quintic,
)

THRESHOLD = 0.1


def quintic_change(
    duration: float, displacement: float, rate: float = 100.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, position and speed of a quintic that starts at 3 s."""
    time = np.arange(0.0, duration + 6.0, 1.0 / rate)
    share = np.clip((time - 3.0) / duration, 0.0, 1.0)
    speed = 30.0 * share**2 * (1.0 - share) ** 2 * displacement / duration
    return time, displacement * quintic(share), speed


@given(duration=st.floats(3.0, 12.0), displacement=st.floats(2.5, 4.5))
def test_a_quintic_of_known_duration_gives_that_duration(
    duration: float, displacement: float
) -> None:
    time, position, speed = quintic_change(duration, displacement)
    found = change_measures(time, position, speed, 3.0 + duration / 2.0)
    assert found is not None
    _, whole, width = whole_quintic(found.duration, found.displacement, THRESHOLD)
    # Interpolation between samples 10 ms apart.
    assert whole == pytest.approx(duration, abs=2e-3)
    assert width == pytest.approx(displacement, abs=2e-3)
    assert rms(found.shape_error) < 1e-4


def test_duration_counts_from_threshold_to_threshold() -> None:
    time, position, speed = quintic_change(6.0, 3.5)
    found = change_measures(time, position, speed, 6.0)
    assert found is not None
    # 30 u² (1 - u)² 3.5 / 6 = 0.1: u (1 - u) = sqrt(0.1 * 6 / 105)
    cut = 0.5 - np.sqrt(0.25 - np.sqrt(0.1 * 6.0 / 105.0))
    assert found.duration == pytest.approx(6.0 * (1.0 - 2.0 * cut), abs=1e-3)
    assert found.onset_to_peak == pytest.approx(found.duration / 2.0, abs=1e-2)
    assert found.peak_speed == pytest.approx(1.875 * 3.5 / 6.0, rel=1e-4)


def test_a_lane_change_of_steady_speed_is_no_quintic() -> None:
    time = np.arange(0.0, 12.0, 0.01)
    position = 0.6 * np.clip(time - 3.0, 0.0, 5.0)
    found = change_measures(time, position, np.gradient(position, time), 5.0)
    assert found is not None
    assert found.displacement == pytest.approx(3.0, abs=1e-2)
    assert rms(found.shape_error) > 0.05


def test_a_late_lane_change_errs_to_one_side() -> None:
    # Time runs as u², so the car is behind the quintic all along.
    share = np.clip((np.arange(0.0, 12.0, 0.01) - 3.0) / 6.0, 0.0, 1.0)
    time, position = np.arange(0.0, 12.0, 0.01), 3.5 * quintic(share**2)
    found = change_measures(time, position, np.gradient(position, time), 7.0)
    assert found is not None
    assert found.shape_error[1:-1].max() < 0.0


def test_shapes_that_err_to_both_sides_are_right_on_the_mean() -> None:
    errors = np.array([[0.1, -0.1], [-0.1, 0.1]])
    assert mean_shape_rms(errors) == 0.0
    assert rms(errors) == pytest.approx(0.1)
    assert np.isnan(mean_shape_rms(np.empty((0, 2))))


def test_a_lane_change_whose_start_or_end_is_not_seen_is_left_out() -> None:
    time, position, speed = quintic_change(6.0, 3.5)
    for seen in (time > 4.0, time < 8.0):
        assert change_measures(time[seen], position[seen], speed[seen], 6.0) is None


def test_half_a_lane_is_no_lane_change() -> None:
    time, position, speed = quintic_change(6.0, 1.9)
    assert change_measures(time, position, speed, 6.0) is None
    assert change_measures(time, position, speed, 1.0) is None
