"""What every wheel promises, in small."""

from __future__ import annotations

import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.devices.wheels.interface import (
    WheelDescription,
    WheelLost,
    axis_at,
    limited,
    pedal_position,
)


@given(st.floats(), st.floats(0.0, 20.0))
def test_a_torque_stays_within_its_limit(torque: float, torque_limit: float) -> None:
    assert abs(limited(torque, torque_limit)) <= torque_limit


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_what_is_no_finite_torque_is_none(torque: float) -> None:
    assert limited(torque, 5.0) == 0.0


def test_a_torque_within_the_limit_is_left_alone() -> None:
    assert limited(-1.25, 5.0) == -1.25
    assert limited(-7.0, 5.0) == -5.0


def test_a_pedal_goes_from_zero_to_one_whatever_its_sign() -> None:
    assert pedal_position(-1.0, 1.0) == 0.0
    assert pedal_position(1.0, 1.0) == 1.0
    assert pedal_position(1.0, -1.0) == 0.0
    assert pedal_position(-1.5, -1.0) == 1.0
    assert math.isnan(pedal_position(math.nan, 1.0))


def test_an_axis_that_is_not_there_is_nan() -> None:
    assert axis_at((0.5, -0.5), 1) == -0.5
    assert math.isnan(axis_at((0.5, -0.5), 2))
    assert math.isnan(axis_at((0.5, -0.5), -1))


def test_a_description_can_be_sent_to_another_process() -> None:
    description = WheelDescription("sdl", "03ab#0", "A wheel", "046d-c24f")
    assert pickle.loads(pickle.dumps(description)) == description


def test_a_lost_wheel_is_an_error_of_the_system() -> None:
    assert issubclass(WheelLost, OSError)
