"""Frames of the SENSO-Wheel: 1 Mbit/s, each question has an answer.

0x200 sets state and limits (answer 0x210), 0x201 the torque (0x211: angle, rate and
torque), 0x20C asks for the pedals (0x21C). Numbers are little-endian, in mN·m, steps of
0.009 deg and turns a minute. Facts as the simulator JOAN uses them.
"""

from __future__ import annotations

import math
import struct
from enum import IntEnum
from typing import NamedTuple

from costeer.devices.wheels.interface import limited

FULL_TORQUE = 8.0
"""Torque of a command of 1 [N·m]. Assumed: what two hands hold; the motor has 20."""

STATE, TORQUE, PEDALS = 0x200, 0x201, 0x20C
STATE_ANSWER, TORQUE_ANSWER, PEDALS_ANSWER = 0x210, 0x211, 0x21C

_INCREMENT = math.radians(0.009)
_RATE_UNIT = 2.0 * math.pi / 60.0  # of a turn a minute [rad/s]
_TORQUE_UNIT = 1e-3
_TORQUE_LIMIT_PERCENT = 100  # of the nominal torque, within and beyond the end stops
# Raw values of a pedal that is released and one that is pressed, as in JOAN.
_ACCELERATOR_RAW = (1100.0, 3560.0)
_BRAKE_RAW = (1.0, 501.0)


class SensoState(IntEnum):
    """What the wheel does, and the mode that asks for it."""

    OFF = 0x10
    UNCHANGED = 0x11
    READY = 0x12
    ON = 0x14
    ERROR = 0x18
    CLEAR = 0x1F


class Motion(NamedTuple):
    """Answer to a torque: the device's signs.

    Attributes:
        angle: Of the rim [rad].
        rate: Its time derivative [rad/s].
        torque: That the device measures [N·m].
    """

    angle: float
    rate: float
    torque: float


def state_frame(mode: SensoState, full_range: float) -> bytes:
    """Ask for a state and set the end stops.

    Args:
        mode: State to go to; `UNCHANGED` only asks.
        full_range: Lock to lock [rad].
    """
    end_stop = round(math.degrees(full_range / 2.0))
    percent = _TORQUE_LIMIT_PERCENT
    return struct.pack("<BBhhBB", mode, 0, end_stop, 0, percent, percent)


def torque_frame(torque: float) -> bytes:
    """Set the motor's torque; friction, damping and stiffness of the device are zero.

    Args:
        torque: In the device's sign [N·m]; cut to `FULL_TORQUE`.
    """
    size = round(limited(torque, FULL_TORQUE) / _TORQUE_UNIT)
    return struct.pack("<4h", size, 0, 0, 0)


def motion(content: bytes) -> Motion:
    """Read the answer to a torque."""
    increments, rate, torque = struct.unpack("<ihh", content)
    return Motion(increments * _INCREMENT, rate * _RATE_UNIT, torque * _TORQUE_UNIT)


def pedals(content: bytes) -> tuple[float, float]:
    """Read accelerator and brake, each from 0 to 1."""
    accelerator, brake = struct.unpack_from("<HH", content, 2)
    return _pressed(accelerator, _ACCELERATOR_RAW), _pressed(brake, _BRAKE_RAW)


def _pressed(raw: float, ends: tuple[float, float]) -> float:
    low, high = ends
    return min(max((raw - low) / (high - low), 0.0), 1.0)
