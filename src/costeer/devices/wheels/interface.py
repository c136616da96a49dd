"""What every steering wheel can do, whatever it is made of: read, write, close."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol, runtime_checkable

from costeer.devices.wheels.calibration import WheelCalibration

LEFT_INDICATOR = 1
"""Bit of `WheelReading.buttons`: the left paddle is pulled."""

RIGHT_INDICATOR = 2
"""Bit of `WheelReading.buttons`: the right paddle is pulled."""

EFFECT_LIFE = 0.2
"""A torque that is not written anew for this long dies by itself [s]."""


class WheelReading(NamedTuple):
    """What a wheel tells at one moment; left is positive.

    Attributes:
        time: Of the reading, by `time.perf_counter`: the finest clock that all
            processes share and that never goes back [s].
        steering_wheel_angle: θ_sw [rad].
        steering_wheel_rate: Its time derivative [rad/s]; NaN if the device is silent.
        driver_torque: Of the hands [N·m]; NaN if the device does not measure it.
        accelerator: Pressed from 0 to 1 [-]; NaN without pedals.
        brake: The same of the brake.
        buttons: Sum of `LEFT_INDICATOR` and `RIGHT_INDICATOR`.
    """

    time: float
    steering_wheel_angle: float
    steering_wheel_rate: float
    driver_torque: float
    accelerator: float
    brake: float
    buttons: int


class WheelDescription(NamedTuple):
    """Which device; it can be sent to another process.

    Attributes:
        kind: Name of its `WheelKind`.
        address: Where the backend finds it: SDL's GUID and number, path of the HID
            device, CAN interface and channel, or the options of a simulated wheel.
        name: For people.
        identity: Stable key of the calibration file, as "046d-c24f".
    """

    kind: str
    address: str
    name: str
    identity: str


class WheelLost(OSError):
    """The wheel does not answer any more: unplugged, in error or silent."""


@runtime_checkable
class Wheel(Protocol):
    """A steering wheel that is open.

    Attributes:
        torque_limit: Largest torque that it can give [N·m].
        measures_torque: Whether `driver_torque` of a reading is a measurement.
        write_rate: How often `write` should be called at most [Hz].
    """

    torque_limit: float
    measures_torque: bool
    write_rate: float

    def read(self) -> WheelReading:
        """Return the newest reading at once.

        Raises:
            WheelLost: If the device does not answer any more.
        """
        ...

    def write(self, torque: float) -> None:
        """Push the rim with a torque [N·m], positive to the left.

        What is no finite number pushes with nothing. The torque dies within
        `EFFECT_LIFE` if it is not written anew, where the device can.

        Raises:
            WheelLost: If the device does not take it.
        """
        ...

    def close(self) -> None:
        """Set the torque to zero and let the device go; a second call does nothing."""
        ...


def limited(torque: float, torque_limit: float) -> float:
    """A torque within the limit [N·m]; zero if it is not finite."""
    if not math.isfinite(torque):
        return 0.0
    return min(max(torque, -torque_limit), torque_limit)


def pedal_position(value: float, sign: float) -> float:
    """How far a pedal is pressed [-], from its axis in [-1, 1].

    Args:
        value: Of the axis.
        sign: +1 if the axis grows when the pedal is pressed, else -1.
    """
    return min(max((1.0 + sign * value) / 2.0, 0.0), 1.0)


def axis_at(axes: tuple[float, ...], number: int) -> float:
    """Value of an axis in [-1, 1]; NaN if the device has no axis of this number."""
    return axes[number] if 0 <= number < len(axes) else math.nan


class WheelKind(NamedTuple):
    """How wheels of one kind are found, opened and stopped; a plug-in brings its own.

    Attributes:
        name: As in `WheelDescription.kind`.
        open: Opens a device in the process and the thread that reads and writes.
        stop: Takes the torque off from another process; whoever used it may be dead.
        prepare: Gets ready to stop, as far as that takes a while.
        search: Wheels that are plugged in; none is searched for if None.
    """

    name: str
    open: Callable[[WheelDescription, WheelCalibration], Wheel]
    stop: Callable[[WheelDescription], None]
    prepare: Callable[[], object] = int
    search: Callable[[], list[WheelDescription]] | None = None
