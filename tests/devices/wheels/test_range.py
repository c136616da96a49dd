"""The range of a wheel is said, and turns that do not fit it are refused."""

from __future__ import annotations

import math

import pytest

from costeer.devices.wheels.calibration import uncalibrated
from costeer.devices.wheels.excitation import ExcitationParameters, SelfTestStopped
from costeer.devices.wheels.references import LEFT, RIGHT
from costeer.devices.wheels.selftest import (
    Reference,
    SelfTestResult,
    calibrate,
    run_procedure,
)
from costeer.devices.wheels.simulated import SimulatedWheel, SimulatedWheelParameters
from tests.devices.wheels.user import User

DEVICE = SimulatedWheelParameters()
DT = 1.0 / 960.0


def turned(user: User, range_deg: float | None) -> SelfTestResult:
    """What comes of a calibration with these turns, on an axis of 900 deg."""
    opened = uncalibrated("w", angle_sign=-1.0)
    wheel = SimulatedWheel(DEVICE, opened, user)
    reference = Reference(
        peak_torque=2.2,
        lock_to_lock=None if range_deg is None else math.radians(range_deg),
    )
    pushes = ExcitationParameters(duration=6.0)
    procedure = calibrate(opened, reference, DT, pushes)
    return run_procedure(wheel, procedure, lambda: None, user.listen)


class Lazy(User):
    """Somebody who turns the wheel by 200 deg to either side."""

    def __init__(self) -> None:
        super().__init__(DEVICE)
        self._wanted |= {LEFT: math.radians(200.0), RIGHT: math.radians(-200.0)}
        self.until = 0.0

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]; keeps the time."""
        self.until = time
        return super().__call__(time, angle, rate)


def test_a_range_that_nobody_gave_is_told() -> None:
    result = turned(User(DEVICE), None)
    assert result.calibration.full_range == math.radians(900.0)
    assert "taken as 900 deg" in result.notes[0]
    assert "--range DEG" in result.notes[0]
    assert len(result.notes) == 1


def test_a_range_that_was_given_is_not_commented_on() -> None:
    result = turned(User(DEVICE), 540.0)
    # A turn counts as ended within 1.5 deg of its end, twice.
    assert result.calibration.full_range == pytest.approx(
        math.radians(540.0), rel=0.006
    )
    assert result.notes == ()


def test_turns_over_a_part_of_the_axis_are_told() -> None:
    user = Lazy()
    assert turned(user, None).notes[1] == "the wheel turned over 44% of its axis only"


@pytest.mark.parametrize("range_deg", [540.0, 900.0, 1080.0])
def test_turns_that_were_not_lock_to_lock_are_refused(range_deg: float) -> None:
    user = Lazy()
    with pytest.raises(SelfTestStopped, match="not turned to both ends; run it again"):
        turned(user, range_deg)
    assert user.until < 10.0  # before it is pushed; with the pushes it takes 13 s
