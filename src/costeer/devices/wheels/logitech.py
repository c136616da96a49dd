"""Bytes that Logitech's wheels speak: the classic protocol of G25, G27, G29, DFGT, DFP.

A command has seven bytes. The first holds the slot of an effect in its upper half
(one bit per slot) and what to do with it in the lower. Facts from the protocol that
Logitech published and from the Linux driver hid-lg4ff; input reports as those drivers
read them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.devices.wheels.interface import LEFT_INDICATOR, RIGHT_INDICATOR

VENDOR = 0x046D
"""Logitech's number on USB."""

LENGTH = 7
"""Bytes of a command."""

PLAY, STOP, REFRESH = 0x1, 0x3, 0xC
"""What to do with a slot: download and play, stop, change what plays."""

SLOTS = range(4)
"""Effects that play side by side."""

NARROWEST_RANGE, WIDEST_RANGE = 40, 900
"""Lock to lock that these wheels can be set to [deg]."""

_CONSTANT = 0x00


class InputLayout(NamedTuple):
    """Where an input report holds what; a report has no number in front.

    Attributes:
        length: Bytes of a report.
        angle_byte: First byte of the steering angle, low byte first.
        angle_shift: Bits below the angle in that word.
        angle_bits: Bits of the angle.
        pedal_bytes: Bytes of clutch, accelerator and brake, 255 when released; -1 if
            there is none. In this order they are the axes 1, 2 and 3, as Linux and
            SDL number them.
        paddle_byte: Byte with the paddles.
        right_paddle: Bit of the right paddle in it.
        left_paddle: Bit of the left one.
    """

    length: int
    angle_byte: int
    angle_shift: int
    angle_bits: int
    pedal_bytes: tuple[int, int, int]
    paddle_byte: int
    right_paddle: int = 0x01
    left_paddle: int = 0x02


class InputReport(NamedTuple):
    """What an input report says.

    Attributes:
        axes: Steering, clutch, accelerator and brake in [-1, 1]; the steering grows to
            the right, a released pedal is at 1. NaN where the wheel has none.
        buttons: Indicator bits of `WheelReading`.
    """

    axes: tuple[float, float, float, float]
    buttons: int


class LogitechModel(NamedTuple):
    """A wheel that speaks the classic protocol.

    Attributes:
        name: For people.
        layout: Of its input reports in native mode.
        ranged: Whether it takes the common command for the range.
    """

    name: str
    layout: InputLayout
    ranged: bool = True


_G27_LAYOUT = InputLayout(11, 3, 2, 14, (7, 5, 6), 1)

MODELS = {
    0xC24F: LogitechModel("Logitech G29", InputLayout(12, 4, 0, 16, (8, 6, 7), 1)),
    0xC29B: LogitechModel("Logitech G27", _G27_LAYOUT),
    0xC299: LogitechModel("Logitech G25", _G27_LAYOUT),
    0xC29A: LogitechModel(
        "Logitech Driving Force GT", InputLayout(8, 4, 0, 14, (-1, 6, 7), 1)
    ),
    0xC298: LogitechModel(
        "Logitech Driving Force Pro",
        InputLayout(8, 0, 0, 14, (-1, 5, 6), 2, right_paddle=0x04, left_paddle=0x08),
        ranged=False,
    ),
}
"""Wheels by their number on USB. The G920 and G923 speak another protocol."""


def constant(slot: int, level: int, operation: int = REFRESH) -> bytes:
    """Constant force.

    Args:
        slot: Of the effect, 0 to 3.
        level: From -32768 to 32767; the device keeps its upper eight bits.
        operation: `PLAY` at first, `REFRESH` to change it.
    """
    content = [_CONSTANT] + [0] * 5
    content[1 + slot] = (_clipped(level, -0x8000, 0x7FFF) + 0x8000) >> 8
    return _command(slot, operation, content)


def stop(slot: int) -> bytes:
    """End the effect of a slot."""
    return _command(slot, STOP, [])


def autocenter_off() -> bytes:
    """Switch off the spring that the device puts on by itself."""
    return _padded([0xF5])


def fixed_loop_off() -> bytes:
    """Let the device give out a force as soon as it comes, not every 2 ms."""
    return _padded([0x0D])


def steering_range(full_range: float) -> bytes:
    """Set the angle from lock to lock, the nearest that the device can.

    Args:
        full_range: Lock to lock [rad].
    """
    wanted = round(math.degrees(full_range))
    degrees = _clipped(wanted, NARROWEST_RANGE, WIDEST_RANGE)
    return _padded([0xF8, 0x81, degrees & 0xFF, degrees >> 8])


def pro_steering_range(full_range: float) -> tuple[bytes, bytes]:
    """Set the range of a Driving Force Pro: 200 deg or 900 deg, whichever holds it.

    Args:
        full_range: Lock to lock [rad].
    """
    wide = round(math.degrees(full_range)) > 200
    return _padded([0xF8, 0x03 if wide else 0x02]), _padded([0x81, 0x0B])


def all_stop() -> tuple[bytes, ...]:
    """Commands after which a wheel pushes with nothing, whatever was sent before."""
    return (*(stop(slot) for slot in SLOTS), autocenter_off())


def decoded(layout: InputLayout, report: bytes) -> InputReport:
    """Read an input report.

    Args:
        layout: Of the model.
        report: As the device sent it.

    Raises:
        ValueError: If the report is shorter than the model's.
    """
    if len(report) < layout.length:
        raise ValueError(
            f"an input report of {len(report)} bytes is too short, the wheel's has "
            f"{layout.length}; unplug it and switch it to its PS3 or PC mode"
        )
    word = int.from_bytes(report[layout.angle_byte : layout.angle_byte + 2], "little")
    angle = (word >> layout.angle_shift) & ((1 << layout.angle_bits) - 1)
    half = 1 << (layout.angle_bits - 1)
    clutch, accelerator, brake = (_pedal(report, at) for at in layout.pedal_bytes)
    return InputReport(
        axes=((angle - half) / half, clutch, accelerator, brake),
        buttons=_indicators(layout, report[layout.paddle_byte]),
    )


def _pedal(report: bytes, at: int) -> float:
    return math.nan if at < 0 else report[at] / 127.5 - 1.0


def _indicators(layout: InputLayout, paddles: int) -> int:
    left = LEFT_INDICATOR if paddles & layout.left_paddle else 0
    return left + (RIGHT_INDICATOR if paddles & layout.right_paddle else 0)


def _command(slot: int, operation: int, content: list[int]) -> bytes:
    if slot not in SLOTS:
        raise ValueError(f"slot is {slot}, it must be one of 0 to {SLOTS[-1]}")
    return _padded([(0x10 << slot) | operation, *content])


def _padded(content: list[int]) -> bytes:
    return bytes(content).ljust(LENGTH, b"\0")


def _clipped(value: int, low: int, high: int) -> int:
    return min(max(value, low), high)
