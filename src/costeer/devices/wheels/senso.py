"""SENSO-Wheel over CAN: a laboratory's wheel that measures torque.

It answers each question, and switches itself off when nobody asks. All answers are
read: those left in the queue would be lag.
"""

from __future__ import annotations

import contextlib
import math
import struct
import time
from types import ModuleType
from typing import TYPE_CHECKING

from costeer.base.extras import install_command
from costeer.devices.wheels.calibration import (
    WheelCalibration,
    device_command,
    largest_torque,
)
from costeer.devices.wheels.interface import (
    EFFECT_LIFE,
    WheelDescription,
    WheelLost,
    WheelReading,
    limited,
)
from costeer.devices.wheels.senso_frames import (
    FULL_TORQUE,
    PEDALS,
    PEDALS_ANSWER,
    STATE,
    STATE_ANSWER,
    TORQUE,
    TORQUE_ANSWER,
    Motion,
    SensoState,
    motion,
    pedals,
    state_frame,
    torque_frame,
)

if TYPE_CHECKING:
    import can

BITRATE = 1_000_000
"""Of the bus [bit/s]."""

_ASK_AGAIN = 0.01  # a reader who does not write asks this often [s]
_SILENCE = 0.1
_RETRY = 0.02
_PATIENCE = 2.0
_PEDALS_EVERY, _STATE_EVERY = 4, 16  # of the questions for the torque


def senso_description(address: str) -> WheelDescription:
    """Describe a SENSO-Wheel on a CAN bus; a bus is not searched.

    Args:
        address: Interface and channel of python-can, as "pcan:PCAN_USBBUS1".

    Raises:
        ValueError: If the address is not of this form.
    """
    interface, colon, channel = address.partition(":")
    if not (interface and colon and channel):
        raise ValueError(
            f"CAN address is {address!r}, it must be an interface and a channel of "
            "python-can, as pcan:PCAN_USBBUS1 or socketcan:can0"
        )
    identity = "senso-" + address.replace(":", "-").lower()
    return WheelDescription("senso", address, f"SENSO-Wheel on {address}", identity)


def can_library() -> ModuleType:
    """Import python-can.

    Raises:
        ModuleNotFoundError: If it is not installed; says how to.
    """
    try:
        import can
    except ImportError as error:
        raise ModuleNotFoundError(
            f"python-can is not installed; install it with: {install_command('can')}",
            name="can",
        ) from error
    return can


def open_bus(description: WheelDescription) -> can.BusABC:
    """Open the bus of a description.

    Raises:
        ModuleNotFoundError: If python-can is not installed; says how to.
        WheelLost: If the bus does not open.
    """
    can_library()
    import can

    interface, _, channel = description.address.partition(":")
    try:
        return can.Bus(interface=interface, channel=channel, bitrate=BITRATE)
    # Interfaces raise what their vendors' libraries raise, import errors included.
    except (can.CanError, OSError, ImportError, ValueError, NameError) as error:
        raise WheelLost(
            f"{description.name} has no bus: {error}; see that the adapter is plugged "
            "in and its driver is installed"
        ) from error


def stop_senso(description: WheelDescription, bus: can.BusABC | None = None) -> None:
    """Set the torque to zero and switch the wheel off, from another process.

    Args:
        description: As `senso_description` gave it.
        bus: To the wheel; opened by the address if None.

    Raises:
        WheelLost: If the bus does not open or take a frame.
    """
    line = open_bus(description) if bus is None else bus
    try:
        _send(line, TORQUE, torque_frame(0.0))
        for mode in (SensoState.READY, SensoState.OFF):
            _send(line, STATE, state_frame(mode, math.pi))
    finally:
        line.shutdown()


def _send(bus: can.BusABC, identifier: int, content: bytes) -> None:
    import can

    message = can.Message(arbitration_id=identifier, data=content, is_extended_id=False)
    try:
        bus.send(message, timeout=_RETRY)
    except (can.CanError, OSError) as error:
        raise WheelLost(f"the CAN bus takes no frame: {error}") from error


class SensoWheel:
    """A SENSO-Wheel that is switched on."""

    measures_torque = True
    write_rate = 480.0

    def __init__(
        self,
        bus: can.BusABC,
        calibration: WheelCalibration,
        patience: float = _PATIENCE,
        silence: float = _SILENCE,
    ) -> None:
        """Set the limits, switch the wheel on, with no torque.

        Args:
            bus: To the wheel; closed with it.
            calibration: Of this device.
            patience: How long it may take to each of its states [s].
            silence: It is lost when it has not answered for this long [s].

        Raises:
            WheelLost: If it does not answer or stays in an error.
        """
        self.torque_limit = min(largest_torque(calibration), FULL_TORQUE)
        self.state = SensoState.OFF.value
        self._bus = bus
        self._calibration = calibration
        self._patience = patience
        self._silence = silence
        self._motion: Motion | None = None
        self._pedals = (math.nan, math.nan)
        self._command = 0.0
        self._written_at = self._asked_at = -math.inf
        self._heard_at = time.perf_counter()
        self._questions = 0
        self._open = True
        try:
            self._switch_on()
        except WheelLost:
            self.close()
            raise

    def read(self) -> WheelReading:
        """See `Wheel.read`."""
        self._check_open()
        now = time.perf_counter()
        if now - self._asked_at > _ASK_AGAIN:
            self._ask(now)
        self._drain()
        self._check(now)
        angle, rate, torque = self._motion or Motion(math.nan, math.nan, math.nan)
        known = self._calibration
        return WheelReading(
            time=self._heard_at,
            steering_wheel_angle=known.angle_sign * angle,
            steering_wheel_rate=known.angle_sign * rate,
            driver_torque=known.torque_sign * torque,
            accelerator=self._pedals[0],
            brake=self._pedals[1],
            buttons=0,
        )

    def axes(self) -> tuple[float, ...]:
        """Steering in [-1, 1] of the range, as the device counts it.

        Raises:
            WheelLost: If the device is gone.
        """
        half_range = self._calibration.angle_sign * self._calibration.full_range / 2.0
        return (self.read().steering_wheel_angle / half_range,)

    def write(self, torque: float) -> None:
        """See `Wheel.write`."""
        self._check_open()
        torque = limited(torque, self.torque_limit)
        self._command = device_command(self._calibration, torque)
        self._written_at = time.perf_counter()
        self._ask(self._written_at)

    def close(self) -> None:
        """See `Wheel.close`."""
        if not self._open:
            return
        self._open = False
        with contextlib.suppress(WheelLost):  # it switches itself off then
            _send(self._bus, TORQUE, torque_frame(0.0))
            for mode in (SensoState.READY, SensoState.OFF):
                self._send_state(mode)
        self._bus.shutdown()

    def _check_open(self) -> None:
        if not self._open:
            raise WheelLost("the SENSO-Wheel is closed")

    def _check(self, now: float) -> None:
        if now - self._heard_at > self._silence:
            raise WheelLost("the SENSO-Wheel does not answer; see its power and cable")
        if self.state != SensoState.ON:
            raise WheelLost(f"the SENSO-Wheel went to state 0x{self.state:02x}")

    def _ask(self, now: float) -> None:
        """Send the torque, which asks for the motion; pedals and state now and then."""
        if now - self._written_at > EFFECT_LIFE:
            self._command = 0.0
        self._asked_at = now
        _send(self._bus, TORQUE, torque_frame(self._command * FULL_TORQUE))
        if self._questions % _PEDALS_EVERY == 0:
            _send(self._bus, PEDALS, b"\x01")
        if self._questions % _STATE_EVERY == 0:
            self._send_state(SensoState.UNCHANGED)
        self._questions += 1

    def _send_state(self, mode: SensoState) -> None:
        _send(self._bus, STATE, state_frame(mode, self._calibration.full_range))

    def _drain(self, patience: float = 0.0) -> None:
        """Read every answer that waits, at first for up to `patience` [s]."""
        import can

        try:
            while (message := self._bus.recv(patience)) is not None:
                patience = 0.0
                self._take(message.arbitration_id, bytes(message.data))
        except (can.CanError, OSError) as error:
            raise WheelLost(f"the CAN bus is gone: {error}") from error
        except struct.error as error:
            raise WheelLost(f"the SENSO-Wheel sent a cut frame: {error}") from error

    def _take(self, identifier: int, content: bytes) -> None:
        if identifier == TORQUE_ANSWER:
            self._motion = motion(content)
            self._heard_at = time.perf_counter()
        elif identifier == PEDALS_ANSWER:
            self._pedals = pedals(content)
        elif identifier == STATE_ANSWER and content:
            self.state = content[0]

    def _switch_on(self) -> None:
        self._reach(SensoState.UNCHANGED)
        if self.state not in (SensoState.OFF, SensoState.READY, SensoState.ON):
            self._reach(SensoState.CLEAR)
        _send(self._bus, TORQUE, torque_frame(0.0))
        for mode in (SensoState.OFF, SensoState.READY, SensoState.ON):
            self._reach(mode)
        last = time.perf_counter() + self._patience
        while self._motion is None and time.perf_counter() < last:
            _send(self._bus, TORQUE, torque_frame(0.0))
            self._drain(_RETRY)
        if self._motion is None:
            raise WheelLost("the SENSO-Wheel does not tell its angle; see its power")

    def _reach(self, mode: SensoState) -> None:
        """Ask until the wheel is where it shall be."""
        wanted = {SensoState.CLEAR: SensoState.OFF}.get(mode, mode)
        self.state = 0
        last = time.perf_counter() + self._patience
        while time.perf_counter() < last:
            self._send_state(mode)
            self._drain(_RETRY)
            if self.state == wanted or (mode == SensoState.UNCHANGED and self.state):
                return
        raise WheelLost(
            f"the SENSO-Wheel does not go to state 0x{wanted:02x}, it is in "
            f"0x{self.state:02x}; see its power, its cable and its emergency stop"
        )
