"""What gives a wheel its scale: turns from lock to lock, and a known torque.

Everything else that the self-test finds is a ratio. The procedures are generators as
in wheels/excitation.py, on a wheel that is open without calibration.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import NamedTuple

from costeer.plant.parameters import GRAVITY
from costeer.runtime.wheels.calibration import WheelCalibration, device_command
from costeer.runtime.wheels.excitation import (
    HANDS_OFF,
    Instruction,
    SelfTestStopped,
)
from costeer.runtime.wheels.hid import IDENTITY_END
from costeer.runtime.wheels.interface import WheelReading
from costeer.runtime.wheels.mechanics import Mechanics
from costeer.runtime.wheels.senso_frames import FULL_TORQUE

PEAK_TORQUES = {
    "046d-c24f": 2.2,
    "046d-c260": 2.2,
    "046d-c262": 2.2,
    "046d-c29b": 2.2,
    "046d-c299": 2.2,
    "046d-c29a": 1.5,
    "046d-c298": 1.5,
}
"""Torque at full command by identity [N·m]: G29, G29 in PlayStation mode, G920, G27,
G25, Driving Force GT and Pro. Source: G29 as measured by others, about 2.2; assumed for
the others, which have the same or a weaker motor. Hang a weight on the rim to know."""

SENSO_PREFIX = "senso-"
"""Begins the identity of a SENSO-Wheel, which takes its torque in N·m."""

LEFT = "Turn the wheel to the left until it stops, and hold it there."
RIGHT = "Now turn it to the right until it stops, and hold it there."
BACK = "Turn it back to the middle and let go."
HANG = "Hang the weight on the rim so that it pulls; hold the wheel, let go slowly."
WAIT = "Hands off; the wheel carries the weight."

_STOPPED = 0.7
_STEADY = math.radians(1.5)
_TURNED = math.radians(60.0)
_MIDDLE = math.radians(30.0)
_PATIENCE = 60.0


class Turns(NamedTuple):
    """The wheel from lock to lock.

    Attributes:
        angle_sign: +1 if the angle grew to the left, else -1.
        span: Between the two ends, as the open wheel tells it [rad].
    """

    angle_sign: float
    span: float


class Weight(NamedTuple):
    """A known torque.

    Attributes:
        mass: That hangs on the rim [kg].
        radius: Of the rim where the cord leaves it [m].
    """

    mass: float
    radius: float


class WeighingParameters(NamedTuple):
    """How the motor carries a weight.

    Attributes:
        bandwidth: Of the motor that holds the wheel [rad/s]. Source: assumed, stable
            with 30 ms of latency and a weight as heavy as the rim.
        hold_time: In which the motor takes over from the hands [s]. Source: assumed.
        settle_time: Then it settles [s]. Source: assumed, several times the integral.
        swing: Of the wheel while it is weighed, so that friction has both signs [rad].
            Source: assumed, 5 deg; a cord around the rim keeps its lever.
        period: Of the swing [s]. Source: assumed, slow.
        num_periods: Over which the torque is averaged [-]. Source: assumed.
        largest_error: The test stops here [rad]. Source: assumed.
    """

    bandwidth: float = 9.0
    hold_time: float = 6.0
    settle_time: float = 4.0
    swing: float = 0.09
    period: float = 4.0
    num_periods: float = 2.0
    largest_error: float = 1.2


def known_peak_torque(identity: str) -> float | None:
    """Torque of a device at full command [N·m]; None if it is not in the table."""
    if identity.startswith(SENSO_PREFIX):
        return FULL_TORQUE
    return PEAK_TORQUES.get(identity.removesuffix(IDENTITY_END))


def torque_of(weight: Weight) -> float:
    """Torque of a weight that hangs on a cord over the rim [N·m].

    Raises:
        ValueError: If mass or radius cannot be.
    """
    for value, name, high in (
        (weight.mass, "mass [kg]", 20.0),
        (weight.radius, "radius [m]", 0.5),
    ):
        if not 0.0 < value <= high:
            raise ValueError(f"a {name} of {value:g} cannot be; give 0 to {high:g}")
    return weight.mass * GRAVITY * weight.radius


def turn_both_ways() -> Generator[Instruction, WheelReading, Turns]:
    """Let the user turn the wheel to both ends and back.

    Raises:
        SelfTestStopped: If nobody does.
    """
    start = (yield Instruction(0.0, LEFT)).steering_wheel_angle
    left = yield from _end(LEFT, start, 0.0)
    right = yield from _end(RIGHT, left, start - left)
    yield from come_to_the_middle((left + right) / 2.0, BACK)
    return Turns(1.0 if left > right else -1.0, abs(left - right))


def come_to_the_middle(
    middle: float, text: str = HANDS_OFF
) -> Generator[Instruction, WheelReading, None]:
    """Wait until the wheel stands near the middle of its range.

    Args:
        middle: Of the range [rad].
        text: For the user, until it is known where the wheel stands.

    Raises:
        SelfTestStopped: If nobody turns it there.
    """
    reading = yield Instruction(0.0, text)
    began = since = reading.time
    angle = reading.steering_wheel_angle
    while reading.time - since < _STOPPED:
        near = abs(reading.steering_wheel_angle - middle) < _MIDDLE
        if not near or abs(reading.steering_wheel_angle - angle) > _STEADY:
            angle, since = reading.steering_wheel_angle, reading.time
        if reading.time - began > _PATIENCE:
            raise SelfTestStopped(
                "the wheel does not stand in its middle; turn it there, then run it "
                "again"
            )
        reading = yield Instruction(0.0, HANDS_OFF if near else BACK)


def _end(
    text: str, start: float, towards: float
) -> Generator[Instruction, WheelReading, float]:
    """Angle of an end: far from `start`, on the side of `towards`, and steady."""
    reading = yield Instruction(0.0, text)
    began = since = reading.time
    angle = reading.steering_wheel_angle
    while True:
        reading = yield Instruction(0.0, text)
        now = reading.steering_wheel_angle
        if abs(now - angle) > _STEADY:
            angle, since = now, reading.time
        turned = now - start
        right_way = towards == 0.0 or turned * towards > 0.0
        far = right_way and abs(turned) > _TURNED
        if far and reading.time - since > _STOPPED:
            return now
        if reading.time - began > _PATIENCE:
            raise SelfTestStopped(
                "the wheel was not turned to its end; run it again, or leave the turns "
                "out with --no-turns"
            )


def weigh(
    mechanics: Mechanics, parameters: WeighingParameters, dt: float
) -> Generator[Instruction, WheelReading, float]:
    """Let the motor carry a weight; return its torque over the largest one [-].

    Args:
        mechanics: Of the wheel, as the pushes showed it.
        parameters: How it is carried.
        dt: Between readings [s].

    Raises:
        SelfTestStopped: If the weight is too heavy or not there.
    """
    reading = yield Instruction(0.0, HANG)
    centre, started = reading.steering_wheel_angle, reading.time
    motor = _Carrier(mechanics, parameters, centre)
    settled = parameters.hold_time + parameters.settle_time
    end = settled + parameters.num_periods * parameters.period
    total, count = 0.0, 0
    while (elapsed := reading.time - started) < end:
        command, torque = motor.carry(reading, elapsed, dt)
        if elapsed >= settled:
            total, count = total + torque, count + 1
        text = HANG if elapsed < parameters.hold_time else WAIT
        reading = yield Instruction(command, text)
    yield Instruction(0.0, "Take the weight off.")
    return _plausible(total / max(count, 1))


def _plausible(share: float) -> float:
    if abs(share) > 0.9:
        raise SelfTestStopped(
            "the weight is too heavy for the motor; take a lighter one"
        )
    if abs(share) < 0.05:
        raise SelfTestStopped(
            f"the weight takes {abs(share):.1%} of the motor's torque, too little to "
            "be measured; take a heavier one, or see that it pulls at the rim"
        )
    return abs(share)


class _Carrier:
    """Holds the wheel at an angle, whatever pulls: proportional, integral, damping."""

    def __init__(
        self, mechanics: Mechanics, parameters: WeighingParameters, centre: float
    ) -> None:
        self._motor = WheelCalibration(
            identity="weighing",
            torque_curve=mechanics.curve,
            torque_sign=mechanics.direction,
        )
        self._parameters = parameters
        self._inertia = 2.0 * mechanics.inertia
        self._centre = self._smooth = centre
        self._integral = 0.0

    def carry(
        self, reading: WheelReading, elapsed: float, dt: float
    ) -> tuple[float, float]:
        """Command and torque now; more and more of it while the hands still hold."""
        parameters = self._parameters
        target = self._centre + self._swing(elapsed)
        angle = reading.steering_wheel_angle
        error = target - angle
        if abs(error) > parameters.largest_error:
            raise SelfTestStopped(
                "the weight turns the wheel away; hang a lighter one, hold the wheel "
                "and let go slowly"
            )
        bandwidth = parameters.bandwidth
        self._smooth += (angle - self._smooth) * min(dt / 0.01, 1.0)
        rate = (angle - self._smooth) / 0.01
        stiffness = self._inertia * bandwidth**2
        grown = min(elapsed / parameters.hold_time, 1.0)
        self._integral += grown * stiffness * error * dt * bandwidth / 4.0
        self._integral = min(max(self._integral, -1.0), 1.0)
        damping = 2.0 * self._inertia * bandwidth
        torque = stiffness * error + self._integral - damping * rate
        torque = grown * min(max(torque, -1.0), 1.0)
        return device_command(self._motor, torque), torque

    def _swing(self, elapsed: float) -> float:
        parameters = self._parameters
        since = elapsed - parameters.hold_time - parameters.settle_time / 2.0
        if since < 0.0:
            return 0.0
        phase = math.tau * since / parameters.period
        return parameters.swing * math.sin(phase)
