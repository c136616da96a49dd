"""Tolerance of lane position: the wander of the aim and the driver's own path."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.base.bezier import path_point
from costeer.drivers import tracking
from costeer.drivers.tracking import TrackingParameters
from costeer.plant.alignment import STRAIGHT, alignment
from costeer.plant.parameters import RoadParameters
from tests.drivers.samples import DT, RIGHT, SPEED, driving

PARAMETERS = TrackingParameters()


def wander_response(seconds: float) -> NDArray[np.float64]:
    """Wander after a single draw of 1; the process is linear in its draws."""
    state, answers = tracking.initial_state(0.0), []
    for k in range(round(seconds / DT)):
        state = tracking.wander(PARAMETERS, state, 1.0 if k == 0 else 0.0, DT)
        answers.append(state.wander)
    return np.array(answers)


def test_wander_settles_to_its_standard_deviation() -> None:
    # The variance of a linear process is the sum of its squared impulse response.
    # Steps of 1/60 s against a frequency of 0.35 rad/s: first order, ω dt = 0.6 %.
    deviation = float(np.sqrt((wander_response(120.0) ** 2).sum()))
    assert deviation == pytest.approx(PARAMETERS.wander_deviation, rel=0.01)


def spectrum(frequency: float) -> float:
    """Amplitude of the wander at a frequency [rad/s], over that at rest."""
    response = wander_response(120.0)
    turns = np.exp(-1j * frequency * DT * np.arange(response.size))
    return float(abs(response @ turns) / abs(response.sum()))


def test_wander_has_the_bandwidth_of_a_second_order_system() -> None:
    natural, damping = PARAMETERS.wander_frequency, PARAMETERS.wander_damping
    # |H| = 1 / sqrt((1 - r²)² + (2 ζ r)²); steps of the simulation cost under 1 %.
    for ratio in (0.3, 1.0, 3.0, 10.0):
        expected = ((1.0 - ratio**2) ** 2 + (2.0 * damping * ratio) ** 2) ** -0.5
        assert spectrum(ratio * natural) == pytest.approx(expected, rel=0.02)


def test_wander_falls_with_the_square_of_the_frequency() -> None:
    # What tells second order from first: ten times the frequency, a hundredth.
    high = 10.0 * PARAMETERS.wander_frequency
    assert spectrum(10.0 * high) / spectrum(high) == pytest.approx(0.01, rel=0.1)


def test_own_path_ends_at_the_lane_with_the_drivers_bias() -> None:
    biased = TrackingParameters(lane_bias=-0.1)
    path = tracking.planned(biased, RoadParameters(), driving(100.0, 0.2), RIGHT, 6.0)
    start = path_point(path, 100.0)
    end = path_point(path, 100.0 + 6.0 * SPEED)
    assert start.lateral_position == pytest.approx(0.2)
    assert end.lateral_position == pytest.approx(-3.6)
    assert end.slope == pytest.approx(0.0, abs=1e-12)


def test_aim_adds_the_wander_at_the_near_point_only() -> None:
    state = tracking.initial_state(-3.5)._replace(wander=0.15)
    wanted = tracking.aim(state, STRAIGHT, 50.0, 8.0, 7.0)
    assert wanted.near_position == pytest.approx(-3.35)
    assert wanted.far_slope == 0.0 == wanted.far_curvature == wanted.far_turn


@pytest.mark.parametrize("radius", [500.0, -500.0])
def test_on_a_circle_the_aim_is_the_circle_beside_the_roads(radius: float) -> None:
    circle = alignment((0.0,), (1.0 / radius,))
    wanted = tracking.aim(tracking.initial_state(-3.5), circle, 50.0, 12.0, 30.0)
    # A circle leaves its tangent by s² / 2 R, to s^4 / 24 R³.
    assert wanted.near_position + 3.5 == pytest.approx(12.0**2 / 2.0 / radius, abs=2e-3)
    assert wanted.far_curvature == pytest.approx(1.0 / (radius + 3.5))
    assert wanted.far_turn == pytest.approx(30.0 / radius)
    assert wanted.far_slope == 0.0


def test_a_path_from_a_car_that_follows_the_bend_is_straight_along_it() -> None:
    # The yaw rate of the lane itself, v / (R - y), is no curvature of the path.
    radius, lateral = 500.0, -3.5
    bend = 1.0 / (radius - lateral)
    car = driving(100.0, lateral)._replace(
        road_curvature=1.0 / radius, yaw_rate=SPEED * bend
    )
    path = tracking.path_to(car, lateral, 4.0)
    for place in (100.0, 130.0, 160.0):
        point = path_point(path, place)
        assert point.lateral_position == pytest.approx(lateral, abs=1e-12)
        assert point.curvature == pytest.approx(0.0, abs=1e-15)
