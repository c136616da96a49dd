"""A weight is carried until it is off, and weighed only while it is free."""

from __future__ import annotations

import math

import pytest

from costeer.devices.wheels.calibration import uncalibrated
from costeer.devices.wheels.excitation import SelfTestStopped
from costeer.devices.wheels.mechanics import Mechanics
from costeer.devices.wheels.selftest import run_procedure
from costeer.devices.wheels.simulated import SimulatedWheel, SimulatedWheelParameters
from costeer.devices.wheels.weighing import (
    HANG,
    TAKE_OFF,
    WAIT,
    WeighingParameters,
    weigh,
)
from tests.devices.wheels.user import TAKES, User

DEVICE = SimulatedWheelParameters(angle_sign=1.0, torque_sign=1.0)
PEAK = 2.2
PULL = 0.7
DT = 1.0 / 960.0
MECHANICS = Mechanics(
    direction=1.0,
    curve=((0.0, 0.0), (1.0, 1.0)),
    tried=1.0,
    inertia=DEVICE.inertia / PEAK,
    damping=DEVICE.damping / PEAK,
    friction=DEVICE.friction / PEAK,
    latency=0.005,
    explained=1.0,
)


class Watching(User):
    """Somebody who sees what the wheel does, and how long each text is asked for."""

    def __init__(self, pull: float = PULL) -> None:
        super().__init__(DEVICE, pull)
        self.lasted = dict.fromkeys((HANG, WAIT, TAKE_OFF), 0.0)
        self.furthest = 0.0  # while it is to be taken off and hangs [rad]
        self.first_rate = math.nan

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands and of a weight, if it hangs [N·m]."""
        torque = super().__call__(time, angle, rate)
        text = self.heard[-1]
        if text in self.lasted:
            self.lasted[text] = time - self._since
        if text == HANG and math.isnan(self.first_rate):
            self.first_rate = rate
        if text == TAKE_OFF and torque != 0.0:
            self.furthest = max(self.furthest, abs(angle))
        return torque


def weighed(user: Watching, rate: float = 0.0) -> float:
    """Torque of the user's weight as it was found [N·m]."""
    wheel = SimulatedWheel(DEVICE, uncalibrated("w", DEVICE.full_range), user)
    wheel.rate = rate
    procedure = weigh(MECHANICS, WeighingParameters(), DT)
    return PEAK * run_procedure(wheel, procedure, lambda: None, user.listen)


def test_the_motor_carries_the_weight_until_it_is_off() -> None:
    user = Watching()
    # As of test_selftest.py, friction sticks at the ends of the swing.
    assert weighed(user) == pytest.approx(PULL, rel=0.03)
    # A second of small torque and the fade follow; what is quick lags half a second.
    assert TAKES + 2.0 <= user.lasted[TAKE_OFF] < TAKES + 4.0
    # Where it stood, but for what is left of the swing of 0.09 rad.
    assert user.furthest < 0.15


class Leaving(Watching):
    """Somebody who never takes the weight off."""

    def _weight(self, text: str, elapsed: float) -> float:
        return PULL if text in self.lasted else 0.0


@pytest.mark.slow
def test_a_weight_that_stays_is_let_go_in_the_end() -> None:
    user = Leaving()
    assert weighed(user) == pytest.approx(PULL, rel=0.03)
    assert 20.0 < user.lasted[TAKE_OFF] < 21.5


class Late(Watching):
    """Somebody who looks for the cord for 15 s."""

    def _weight(self, text: str, elapsed: float) -> float:
        return (
            0.0 if text == HANG and elapsed < 15.0 else super()._weight(text, elapsed)
        )

    def _hold(self, text: str, elapsed: float) -> float:
        return super()._hold(text, elapsed - 15.0)


@pytest.mark.slow
def test_a_weight_that_comes_late_is_waited_for() -> None:
    user = Late()
    assert weighed(user) == pytest.approx(PULL, rel=0.03)
    assert 15.0 + 6.0 < user.lasted[HANG] < 25.0


class Propping(Watching):
    """Somebody who carries some of the weight during the first swing."""

    def _weight(self, text: str, elapsed: float) -> float:
        share = 0.8 if text == WAIT and elapsed < 8.0 else 1.0
        return share * super()._weight(text, elapsed)


@pytest.mark.slow
def test_a_weight_that_was_not_free_all_the_time_is_refused() -> None:
    user = Propping()
    with pytest.raises(SelfTestStopped, match="not free all the time; hang it, let go"):
        weighed(user)
    # It is taken off first.
    assert user.lasted[TAKE_OFF] > TAKES


@pytest.mark.slow
def test_a_wheel_that_still_turns_is_waited_for() -> None:
    user = Watching()
    assert weighed(user, rate=2.0) == pytest.approx(PULL, rel=0.03)
    assert user.first_rate == 0.0


def test_without_a_weight_nobody_is_asked_to_take_it_off() -> None:
    user = Watching(pull=0.0)
    with pytest.raises(SelfTestStopped, match="too little to be measured"):
        weighed(user)
    assert TAKE_OFF not in user.heard
    assert user.lasted[HANG] > 29.0
