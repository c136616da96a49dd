"""What one steering wheel does with a command: signs, range, torque curve, mechanics.

Whoever opens a wheel turns N·m into the number that the device takes, and back, with
the two functions of this file; nothing else knows a device's units.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

from costeer.sensing.torque_observer import TorqueObserverParameters

UNIT_CURVE = ((0.0, 0.0), (1.0, 1.0))
"""Torque curve of a wheel that is not calibrated: the "torque" is the command."""

NOMINAL_RANGE = math.radians(900.0)
"""Lock to lock of most consumer wheels [rad]."""

_WIDEST_RANGE = 40.0 * math.pi
_LARGEST_TORQUE = 100.0
_LONGEST_LATENCY = 1.0


class WheelCalibration(NamedTuple):
    """A device as the self-test found it.

    Attributes:
        identity: Stable key of the device, as "046d-c24f".
        angle_sign: +1 if the device's axis grows to the left, else -1.
        full_range: Lock to lock, angle between the two ends of the axis [rad].
        torque_sign: +1 if a positive command pushes to the left, else -1.
        torque_curve: Pairs of a command in [0, 1] and the torque that it gives [N·m];
            starts at (0, 0), both grow. Between two pairs it is a straight line.
        inertia: Of the device by itself, without hands [kg·m²].
        damping: The same [N·m·s/rad].
        friction: Its Coulomb friction [N·m].
        latency: From a command to the first movement that is read [s].
        accelerator_axis: Number of the axis; -1 if there is none.
        brake_axis: Number of the axis; -1 if there is none.
        accelerator_sign: +1 if the axis grows when the pedal is pressed, else -1.
        brake_sign: The same of the brake.
    """

    identity: str
    angle_sign: float = 1.0
    full_range: float = NOMINAL_RANGE
    torque_sign: float = 1.0
    torque_curve: tuple[tuple[float, float], ...] = UNIT_CURVE
    inertia: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    latency: float = 0.0
    accelerator_axis: int = -1
    brake_axis: int = -1
    accelerator_sign: float = 1.0
    brake_sign: float = 1.0


def uncalibrated(
    identity: str, full_range: float = NOMINAL_RANGE, angle_sign: float = 1.0
) -> WheelCalibration:
    """What to open a device with before it is calibrated: its torque is the command.

    Args:
        identity: Stable key of the device.
        full_range: Lock to lock as its maker says [rad].
        angle_sign: As its maker says.
    """
    return WheelCalibration(
        identity=identity, full_range=full_range, angle_sign=angle_sign
    )


def largest_torque(calibration: WheelCalibration) -> float:
    """Torque at the end of the curve [N·m]."""
    return calibration.torque_curve[-1][1]


def device_command(calibration: WheelCalibration, torque: float) -> float:
    """Command in [-1, 1] that gives a torque: the curve turned round, with its sign.

    More than the device can give asks for all it can; NaN asks for nothing.

    Args:
        calibration: Of the device.
        torque: Positive to the left [N·m].
    """
    if math.isnan(torque):
        return 0.0
    size = abs(torque)
    command = calibration.torque_curve[-1][0]
    for (low, less), (high, more) in pairwise(calibration.torque_curve):
        if size < more:
            command = low + (high - low) * (size - less) / (more - less)
            break
    return math.copysign(command, torque * calibration.torque_sign)


def device_torque(calibration: WheelCalibration, command: float) -> float:
    """Torque of a command in [-1, 1], positive to the left [N·m].

    It undoes `device_command`; a command beyond the curve gives the curve's end.
    """
    size = abs(command)
    torque = largest_torque(calibration)
    for (low, less), (high, more) in pairwise(calibration.torque_curve):
        if size < high:
            torque = less + (more - less) * (size - low) / (high - low)
            break
    return math.copysign(torque, command * calibration.torque_sign)


def checked(calibration: WheelCalibration) -> WheelCalibration:
    """Return the calibration if it is one.

    Raises:
        ValueError: If a value is not possible; it names the value and the way out.
    """
    if not calibration.identity:
        raise ValueError("a calibration without an identity belongs to no wheel")
    _check_curve(calibration)
    for name in ("angle_sign", "torque_sign", "accelerator_sign", "brake_sign"):
        if getattr(calibration, name) not in (1.0, -1.0):
            _refuse(calibration, name, "+1 or -1")
    if not 0.0 < calibration.full_range <= _WIDEST_RANGE:
        _refuse(calibration, "full_range", f"in (0, {_WIDEST_RANGE:.0f}] rad")
    for name, high in (
        ("inertia", 10.0),
        ("damping", 100.0),
        ("friction", _LARGEST_TORQUE),
        ("latency", _LONGEST_LATENCY),
    ):
        if not 0.0 <= getattr(calibration, name) <= high:
            _refuse(calibration, name, f"in [0, {high:g}]")
    for name in ("accelerator_axis", "brake_axis"):
        if not -1 <= getattr(calibration, name) <= 63:
            _refuse(calibration, name, "an axis from 0 to 63, or -1 for none")
    return calibration


def _check_curve(calibration: WheelCalibration) -> None:
    curve = calibration.torque_curve
    grows = all(a < c and b < d for (a, b), (c, d) in pairwise(curve))
    starts = len(curve) >= 2 and curve[0] == (0.0, 0.0)
    if not (starts and grows):
        _refuse(calibration, "torque_curve", "pairs that grow from (0, 0)")
    if curve[-1][0] > 1.0 or curve[-1][1] > _LARGEST_TORQUE:
        ends = f"within a command of 1 and {_LARGEST_TORQUE:g} N·m"
        _refuse(calibration, "torque_curve", ends)


def _refuse(calibration: WheelCalibration, name: str, wanted: str) -> None:
    raise ValueError(
        f"{name} of wheel {calibration.identity} is {getattr(calibration, name)!r}, "
        f"it must be {wanted}; run: costeer wheel calibrate"
    )


def observer_parameters(calibration: WheelCalibration) -> TorqueObserverParameters:
    """Observer of the driver's torque on this device, by its own mechanics."""
    return TorqueObserverParameters(
        inertia=calibration.inertia,
        damping=calibration.damping,
        friction=calibration.friction,
        latency=calibration.latency,
    )
