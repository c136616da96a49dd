"""A weight on the rim: the motor carries it, and so its torque is known.

The weight hangs on a cord, and the motor that carries it must not let go while it
hangs: it takes over slowly, and ends when the weight is off. The procedure is a
generator as in wheels/excitation.py, on a wheel that is open without calibration.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import suppress
from typing import NamedTuple

from costeer.devices.wheels.calibration import WheelCalibration, device_command
from costeer.devices.wheels.excitation import (
    Instruction,
    SelfTestStopped,
    Steps,
    stay_still,
)
from costeer.devices.wheels.interface import WheelReading
from costeer.devices.wheels.mechanics import Mechanics

HANG = "Hang the weight on the rim so that it pulls; hold the wheel, let go slowly."
WAIT = "Hands off; the wheel carries the weight."
TAKE_OFF = "Take the weight off."

LEAST_SHARE = 0.05
"""Share of the largest torque below which no weight hangs on the rim."""

LARGEST_SHARE = 0.9
"""Share of the largest torque above which the motor has too little left."""

_ALIKE = 0.05
_RATE_LAG = 0.01
_LOAD_LAG = 0.5


class WeighingParameters(NamedTuple):
    """How the motor carries a weight.

    Attributes:
        still_time: For which the wheel stands before the weight is hung [s]. Source:
            assumed.
        bandwidth: Of the motor that holds the wheel [rad/s]. Source: assumed, stable
            with 30 ms of latency and a weight as heavy as the rim.
        hold_time: In which the motor takes over from the hands; then for how long it
            must have felt a load [s]. Source: assumed.
        patience: After this it is weighed whether or not a load was felt, since the
            friction may carry it [s]. Source: assumed.
        settle_time: Then it settles [s]. Source: assumed, several times the integral.
        swing: Of the wheel while it is weighed, so that friction has both signs [rad].
            Source: assumed, 5 deg; a cord around the rim keeps its lever.
        period: Of the swing [s]; the torque is averaged over two. Source: assumed,
            slow.
        largest_error: The test stops here [rad]. Source: assumed.
        unloaded_time: Torque must be small for this long before the motor lets go [s].
            Source: assumed.
        unload_patience: After this it lets go all the same [s]. Source: assumed.
        fade: In which it lets go [s]. Source: assumed.
    """

    still_time: float = 1.0
    bandwidth: float = 9.0
    hold_time: float = 6.0
    patience: float = 30.0
    settle_time: float = 4.0
    swing: float = 0.09
    period: float = 4.0
    largest_error: float = 1.2
    unloaded_time: float = 1.0
    unload_patience: float = 20.0
    fade: float = 1.0


def weigh(
    mechanics: Mechanics, parameters: WeighingParameters, dt: float
) -> Generator[Instruction, WheelReading, float]:
    """Let the motor carry a weight; return its torque over the largest one [-].

    Args:
        mechanics: Of the wheel, as the pushes showed it.
        parameters: How it is carried.
        dt: Between readings [s].

    Raises:
        SelfTestStopped: If the weight is too heavy, not there, or was not free.
    """
    yield from stay_still(parameters.still_time)
    reading = yield Instruction(0.0, HANG)
    motor = _Carrier(mechanics, parameters, dt, reading)
    yield from _wait_for_load(motor, parameters)
    first, second = yield from _two_means(motor, parameters)
    share = abs(first + second) / 2.0
    if share >= LEAST_SHARE:
        yield from _unload(motor, parameters, share / 2.0)
    return _plausible(first, second)


def _wait_for_load(motor: _Carrier, parameters: WeighingParameters) -> Steps:
    """Carry more and more, until a load has been there for some time."""
    began = since = motor.time
    while motor.time - since < parameters.hold_time:
        elapsed = motor.time - began
        if elapsed > parameters.patience:
            return
        yield from motor.carry(HANG, strength=min(elapsed / parameters.hold_time, 1.0))
        if abs(motor.load) < LEAST_SHARE:
            since = motor.time


def _two_means(
    motor: _Carrier, parameters: WeighingParameters
) -> Generator[Instruction, WheelReading, tuple[float, float]]:
    """Mean torque over each of two swings, once the motor has settled."""
    began, settled = motor.time, parameters.settle_time
    totals, counts = [0.0, 0.0], [0, 0]
    while (elapsed := motor.time - began) < settled + 2.0 * parameters.period:
        phase = math.tau * max(elapsed - settled / 2.0, 0.0) / parameters.period
        yield from motor.carry(WAIT, parameters.swing * math.sin(phase))
        if elapsed >= settled:
            which = int(elapsed - settled >= parameters.period)
            totals[which] += motor.torque
            counts[which] += 1
    return totals[0] / max(counts[0], 1), totals[1] / max(counts[1], 1)


def _unload(motor: _Carrier, parameters: WeighingParameters, small: float) -> Steps:
    """Carry on until the weight is off; then let go.

    What was to be measured is measured: hands that turn the wheel far end it too.
    """
    began = since = motor.time
    with suppress(SelfTestStopped):
        while motor.time - since < parameters.unloaded_time:
            if motor.time - began > parameters.unload_patience:
                break
            yield from motor.carry(TAKE_OFF)
            if abs(motor.load) > small:
                since = motor.time
        began = motor.time
        while (elapsed := motor.time - began) < parameters.fade:
            yield from motor.carry(TAKE_OFF, strength=1.0 - elapsed / parameters.fade)


def _plausible(first: float, second: float) -> float:
    """Mean of two shares, if it can be that of a weight."""
    share = abs(first + second) / 2.0
    if share > LARGEST_SHARE:
        raise SelfTestStopped(
            "the weight is too heavy for the motor; take a lighter one"
        )
    if share < LEAST_SHARE:
        raise SelfTestStopped(
            f"the weight takes {share:.1%} of the motor's torque, too little to be "
            "measured; take a heavier one, or see that it pulls at the rim"
        )
    if abs(first - second) > _ALIKE * share:
        raise SelfTestStopped(
            "the weight was not free all the time; hang it, let go, run it again"
        )
    return share


class _Carrier:
    """Holds the wheel at an angle, whatever pulls: proportional, integral, damping.

    Attributes:
        time: Of the last reading [s].
        torque: Of the last command, over the largest one [-].
        load: The torque without what is quick [-].
    """

    def __init__(
        self,
        mechanics: Mechanics,
        parameters: WeighingParameters,
        dt: float,
        reading: WheelReading,
    ) -> None:
        self._motor = WheelCalibration(
            identity="weighing",
            torque_curve=mechanics.curve,
            torque_sign=mechanics.direction,
        )
        self._parameters = parameters
        self._dt = dt
        self._inertia = 2.0 * mechanics.inertia
        self._centre = self._smooth = self._angle = reading.steering_wheel_angle
        self._integral = 0.0
        self.time = reading.time
        self.torque = self.load = 0.0

    def carry(self, text: str, offset: float = 0.0, strength: float = 1.0) -> Steps:
        """Hold the wheel this far from where it stood, until the next reading.

        Args:
            text: For the user.
            offset: From where it stood [rad].
            strength: Share of the torque that is given [-].

        Raises:
            SelfTestStopped: If the wheel is turned away.
        """
        self.torque = strength * self._balance(self._centre + offset, strength)
        self.load += (self.torque - self.load) * min(self._dt / _LOAD_LAG, 1.0)
        command = device_command(self._motor, self.torque)
        reading = yield Instruction(command, text)
        self.time, self._angle = reading.time, reading.steering_wheel_angle

    def _balance(self, target: float, strength: float) -> float:
        """Torque towards an angle, within the largest one."""
        error = target - self._angle
        if abs(error) > self._parameters.largest_error:
            raise SelfTestStopped(
                "the weight turns the wheel away; hang a lighter one, hold the wheel "
                "and let go slowly"
            )
        bandwidth, dt = self._parameters.bandwidth, self._dt
        self._smooth += (self._angle - self._smooth) * min(dt / _RATE_LAG, 1.0)
        rate = (self._angle - self._smooth) / _RATE_LAG
        stiffness = self._inertia * bandwidth**2
        self._integral += strength * stiffness * error * dt * bandwidth / 4.0
        self._integral = min(max(self._integral, -1.0), 1.0)
        damping = 2.0 * self._inertia * bandwidth
        torque = stiffness * error + self._integral - damping * rate
        return min(max(torque, -1.0), 1.0)
