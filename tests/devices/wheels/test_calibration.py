"""A torque becomes a device's command and back; nonsense is refused by name."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.devices.wheels.calibration import (
    WheelCalibration,
    checked,
    device_command,
    device_torque,
    largest_torque,
    observer_parameters,
    uncalibrated,
)

CURVED = WheelCalibration(
    identity="046d-c24f",
    torque_sign=-1.0,
    torque_curve=((0.0, 0.0), (0.1, 0.02), (0.5, 1.2), (0.9, 2.2)),
)
TORQUES = st.floats(-5.0, 5.0)


@given(TORQUES)
def test_the_command_gives_the_torque_within_the_curve(torque: float) -> None:
    asked = max(-2.2, min(2.2, torque))
    given_back = device_torque(CURVED, device_command(CURVED, torque))
    # Rounding of two interpolations, steepest 0.02 N·m over a command of 0.1.
    assert given_back == pytest.approx(asked, abs=1e-12)


@given(TORQUES)
def test_a_mirrored_torque_is_a_mirrored_command(torque: float) -> None:
    assert device_command(CURVED, -torque) == -device_command(CURVED, torque)


def test_a_negative_sign_pushes_left_with_a_negative_command() -> None:
    assert device_command(CURVED, 1.2) == pytest.approx(-0.5)  # a point of the curve
    assert device_torque(CURVED, 0.5) == pytest.approx(-1.2)


def test_the_command_grows_with_the_torque() -> None:
    usual = CURVED._replace(torque_sign=1.0)
    commands = [device_command(usual, 0.01 * n) for n in range(221)]
    assert all(more > less for less, more in pairwise(commands))


@pytest.mark.parametrize("torque", [2.3, 1e9, math.inf])
def test_more_than_the_device_can_asks_for_all_it_can(torque: float) -> None:
    assert device_command(CURVED, torque) == -0.9
    assert device_command(CURVED, -torque) == 0.9
    assert abs(device_torque(CURVED, 1.0)) == largest_torque(CURVED) == 2.2


def test_a_torque_that_is_no_number_asks_for_nothing() -> None:
    assert device_command(CURVED, math.nan) == 0.0


def test_uncalibrated_the_torque_is_the_command() -> None:
    raw = checked(uncalibrated("a-wheel"))
    assert device_command(raw, -0.37) == pytest.approx(-0.37)
    assert largest_torque(raw) == 1.0


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("angle_sign", 0.0),
        ("torque_sign", math.nan),
        ("accelerator_sign", 2.0),
        ("full_range", 0.0),
        ("full_range", math.inf),
        ("inertia", -0.1),
        ("damping", math.nan),
        ("friction", math.inf),
        ("latency", 2.0),
        ("brake_axis", -2),
        ("torque_curve", ()),
        ("torque_curve", ((0.0, 0.0),)),
        ("torque_curve", ((0.0, 0.1), (1.0, 2.0))),
        ("torque_curve", ((0.0, 0.0), (0.5, 1.0), (1.0, 1.0))),
        ("torque_curve", ((0.0, 0.0), (1.0, math.nan))),
        ("torque_curve", ((0.0, 0.0), (1.5, 2.0))),
        ("torque_curve", ((0.0, 0.0), (1.0, 1e6))),
    ],
)
def test_a_value_that_cannot_be_is_named(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=f"{name} of wheel 046d-c24f is") as refused:
        checked(CURVED._replace(**{name: value}))
    assert "costeer wheel calibrate" in str(refused.value)


def test_a_calibration_of_no_wheel_is_refused() -> None:
    with pytest.raises(ValueError, match="identity"):
        checked(CURVED._replace(identity=""))


def test_a_good_calibration_passes_as_it_is() -> None:
    assert checked(CURVED) is CURVED


def test_the_observer_knows_the_device_by_its_calibration() -> None:
    found = CURVED._replace(inertia=0.03, damping=0.04, friction=0.1, latency=0.006)
    observer = observer_parameters(found)
    assert observer[:5] == (0.03, 0.04, 0.0, 0.1, 0.006)  # no stiffness of its own
