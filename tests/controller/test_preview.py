"""Errors are car minus target; a car on its path has none."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.bezier import quintic
from costeer.controller.preview import PreviewParameters, preview
from costeer.controller.signals import LANE_CHANGING, LANE_KEEPING, Target
from costeer.plant.parameters import (
    CARS,
    DEFAULT_CAR,
    steady_front_slip_angle,
    steady_sideslip_angle,
    steady_steering_wheel_angle,
)
from tests.controller.samples import SPEED, sample

PARAMETERS = PreviewParameters()
AHEAD = PreviewParameters(look_ahead=True)
PATH = quintic(0.0, 120.0, 0.0, 0.0, 0.0, -3.5)
CENTRE = Target(LANE_KEEPING, 1.0, 0.0, 0.0, 0.0, 0.0, PATH)


def bend(curvature: float, rate: float = 0.0) -> Target:
    """A target that turns."""
    return Target(LANE_CHANGING, 0.0, -1.0, 0.02, curvature, rate, PATH)


@pytest.mark.parametrize("name", sorted(CARS))
@given(curvature=st.floats(-5e-3, 5e-3))
def test_a_car_in_steady_cornering_on_its_target_has_no_error(
    name: str, curvature: float
) -> None:
    car = CARS[name]
    measurement = sample(
        lateral_position=-1.0,
        yaw_angle=0.02 - steady_sideslip_angle(car, SPEED, curvature),
        yaw_rate=SPEED * curvature,
        steering_wheel_angle=steady_steering_wheel_angle(car, SPEED, curvature),
        front_slip_angle=steady_front_slip_angle(car, SPEED, curvature),
    )
    errors = preview(PARAMETERS, car, bend(curvature), measurement)
    # Rounding of angles, times 30 m of preview.
    assert errors[:5] == pytest.approx((0.0,) * 5, abs=1e-14)


def test_errors_are_positive_to_the_left() -> None:
    measurement = sample(
        lateral_position=0.4,
        yaw_angle=0.01,
        yaw_rate=0.05,
        steering_wheel_angle=0.2,
        front_slip_angle=0.003,
    )
    errors = preview(PARAMETERS, DEFAULT_CAR, CENTRE, measurement)
    assert errors.lateral_error == pytest.approx(0.4 + 1.5 * 20.0 * 0.01)
    assert errors[1:5] == (0.01, 0.05, 0.2, 0.003)


@given(st.floats(-0.02, 0.02), st.floats(-0.05, 0.05))
def test_the_planned_wheel_follows_the_plan_and_not_the_car(
    curvature: float, rate: float
) -> None:
    plans = [
        preview(PARAMETERS, DEFAULT_CAR, bend(curvature, rate), measurement)[5:]
        for measurement in (sample(), sample(steering_wheel_angle=0.3, yaw_rate=0.1))
    ]
    assert plans[0] == plans[1]
    assert plans[0][1] == pytest.approx(
        steady_steering_wheel_angle(DEFAULT_CAR, SPEED, rate)
    )


def test_both_readings_of_the_preview_agree_on_a_straight_target() -> None:
    measurement = sample(lateral_position=-0.3, yaw_angle=0.02)
    at_car, ahead = (
        preview(reading, DEFAULT_CAR, CENTRE, measurement).lateral_error
        for reading in (PARAMETERS, AHEAD)
    )
    assert at_car == pytest.approx(ahead, abs=1e-15)  # rounding of a sum


def test_looking_ahead_takes_the_path_at_the_preview_point() -> None:
    target = bend(1e-3)
    measurement = sample(longitudinal_position=30.0, yaw_angle=-0.01)
    errors = preview(AHEAD, DEFAULT_CAR, target, measurement)
    # The preview point is at 60 m, half-way: the path is at half its width there.
    assert errors.lateral_error == pytest.approx(0.0 - 30.0 * 0.01 + 1.75)


def test_mirrored_car_and_target_have_mirrored_errors() -> None:
    measurement = sample(lateral_position=0.2, yaw_angle=0.03, yaw_rate=-0.04)
    turned = sample(lateral_position=-0.2, yaw_angle=-0.03, yaw_rate=0.04)
    target = bend(2e-3, 1e-3)
    opposite = Target(LANE_CHANGING, 0.0, 1.0, -0.02, -2e-3, -1e-3, PATH)
    left = preview(PARAMETERS, DEFAULT_CAR, target, measurement)
    right = preview(PARAMETERS, DEFAULT_CAR, opposite, turned)
    assert tuple(right) == tuple(-value for value in left)


def test_a_lost_sample_has_no_error_that_looks_like_one() -> None:
    errors = preview(PARAMETERS, DEFAULT_CAR, CENTRE, sample(yaw_angle=math.nan))
    assert math.isnan(errors.lateral_error)
