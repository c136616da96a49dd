"""What gives a wheel its scale: turns from lock to lock, and a known torque.

Everything else that the self-test finds is a ratio; a weight is weighed in
wheels/weighing.py. The procedures are generators as in wheels/excitation.py, on a wheel
that is open without calibration.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import NamedTuple

from costeer.devices.wheels.excitation import (
    HANDS_OFF,
    Instruction,
    SelfTestStopped,
)
from costeer.devices.wheels.hid import IDENTITY_END
from costeer.devices.wheels.interface import WheelReading
from costeer.devices.wheels.senso_frames import FULL_TORQUE
from costeer.plant.parameters import GRAVITY

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
        middle: Between them, likewise [rad].
    """

    angle_sign: float
    span: float
    middle: float = 0.0


class Weight(NamedTuple):
    """A known torque.

    Attributes:
        mass: That hangs on the rim [kg].
        radius: Of the rim where the cord leaves it [m].
    """

    mass: float
    radius: float


def known_peak_torque(identity: str) -> float | None:
    """Torque of a device at full command [N·m]; None if it is not in the table."""
    if identity.startswith(SENSO_PREFIX):
        return FULL_TORQUE
    return PEAK_TORQUES.get(identity.removesuffix(IDENTITY_END))


def known_angle_sign(kind: str) -> float:
    """Side of an axis before anybody turned the wheel: +1 if it grows to the left.

    Axes grow to the right by evdev, by DirectInput and in Logitech's reports; a
    SENSO-Wheel counts to the left.

    Args:
        kind: Of the wheel's description.
    """
    return 1.0 if kind == "senso" else -1.0


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
    middle = (left + right) / 2.0
    yield from come_to_the_middle(middle, BACK)
    return Turns(1.0 if left > right else -1.0, abs(left - right), middle)


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
