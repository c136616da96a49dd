"""Logitech wheels without a driver, through hidapi: macOS, and where SDL2 fails.

A raw wheel keeps its last force for ever: wheels/sender.py takes it off when nobody
refreshes it, and if the whole process dies, another must call `stop_hid`.
"""

from __future__ import annotations

import contextlib
import math
import time
from typing import Any

from costeer.base.extras import install_command, pip_command
from costeer.devices.wheels import logitech
from costeer.devices.wheels.calibration import (
    WheelCalibration,
    device_command,
    largest_torque,
)
from costeer.devices.wheels.interface import (
    WheelDescription,
    WheelLost,
    WheelReading,
    axis_at,
    limited,
    pedal_position,
)
from costeer.devices.wheels.sender import HidTransport, Sender

IDENTITY_END = "-hid"
"""Ends an identity: the signs of a wheel here are not those that SDL2 gives it."""

_FULL_LEVEL = 32767
_PATIENCE = 1.0  # how long a wheel may take to say where it stands [s]
_LONGEST_REPORT = 64
_REFUSED = (
    "close other programs that use it, and see that your user may open it "
    "(Linux: a udev rule for hidraw)"
)


class DeviceTransport:
    """A device of hidapi."""

    def __init__(self, path: str) -> None:
        """Open the device.

        Args:
            path: As hidapi gave it.

        Raises:
            ModuleNotFoundError: If hidapi is not installed; says how to.
            WheelLost: If it does not open.
        """
        self._device = hid_library().device()
        try:
            self._device.open_path(path.encode())
        except OSError as error:
            raise WheelLost(
                f"the wheel at {path} does not open: {error}; {_REFUSED}"
            ) from error
        self._device.set_nonblocking(1)

    def write(self, command: bytes) -> None:
        """See `HidTransport.write`."""
        # The zero in front says that the report has no number.
        if self._device.write(b"\0" + command) < 0:
            raise OSError(self._device.error())

    def read(self) -> bytes:
        """See `HidTransport.read`."""
        return bytes(self._device.read(_LONGEST_REPORT))

    def close(self) -> None:
        """See `HidTransport.close`."""
        self._device.close()


def hid_library() -> Any:  # Any: hidapi ships no types
    """Import hidapi.

    Raises:
        ModuleNotFoundError: If it is not installed; says how to.
    """
    try:
        import hid
    except ImportError as error:
        raise ModuleNotFoundError(
            f"hidapi is not installed; install it with: {install_command('drive')}",
            name="hid",
        ) from error
    if not hasattr(hid, "device"):
        raise ModuleNotFoundError(
            "the package hid hides hidapi, which has the same module name; "
            f"run: {pip_command('uninstall')} hid, then: "
            f"{pip_command('install')} --force-reinstall hidapi"
        )
    return hid


def hid_wheels() -> list[WheelDescription]:
    """Logitech wheels that speak the classic protocol.

    Raises:
        ModuleNotFoundError: If hidapi is not installed.
    """
    found: dict[str, WheelDescription] = {}
    for device in hid_library().enumerate(logitech.VENDOR, 0):
        model = logitech.MODELS.get(device["product_id"])
        if model is not None and device.get("interface_number", 0) <= 0:
            path = device["path"].decode()
            identity = f"{logitech.VENDOR:04x}-{device['product_id']:04x}{IDENTITY_END}"
            # macOS lists a device once for each kind of use it has.
            found[path] = WheelDescription("hid", path, model.name, identity)
    return list(found.values())


def hid_model(description: WheelDescription) -> logitech.LogitechModel:
    """The model of a description.

    Raises:
        ValueError: If it is no wheel of the classic protocol.
    """
    vendor, _, rest = description.identity.partition("-")
    product = rest.removesuffix(IDENTITY_END)
    known = {f"{number:04x}": model for number, model in logitech.MODELS.items()}
    if vendor != f"{logitech.VENDOR:04x}" or product not in known:
        names = ", ".join(model.name for model in logitech.MODELS.values())
        raise ValueError(
            f"{description.name} ({description.identity}) does not speak the classic "
            f"Logitech protocol; the wheels that do are {names}"
        )
    return known[product]


def stop_hid(
    description: WheelDescription, transport: HidTransport | None = None
) -> None:
    """Take every force off a wheel, from another process than the one that drove it.

    Args:
        description: As `hid_wheels` gave it.
        transport: To the wheel; opened by the address if None.

    Raises:
        OSError: If the device is not there.
    """
    line = DeviceTransport(description.address) if transport is None else transport
    try:
        for command in logitech.all_stop():
            line.write(command)
    finally:
        line.close()


class HidWheel:
    """A Logitech wheel that we speak to byte for byte."""

    measures_torque = False
    write_rate = 480.0

    def __init__(
        self,
        transport: HidTransport,
        model: logitech.LogitechModel,
        calibration: WheelCalibration,
        patience: float = _PATIENCE,
    ) -> None:
        """Set the wheel up and start a force of zero.

        Args:
            transport: To the device; closed with the wheel.
            model: Of the wheel.
            calibration: Of this device.
            patience: How long it may take to say where it stands [s].

        Raises:
            WheelLost: If it does not answer.
        """
        self.torque_limit = largest_torque(calibration)
        self._transport = transport
        self._model = model
        self._calibration = calibration
        self._report: logitech.InputReport | None = None
        self._open = True
        self._sender: Sender | None = None
        try:
            for command in _opening(model, calibration.full_range):
                transport.write(command)
            self._sender = Sender(transport)
            self._await_report(patience)
        except OSError as error:
            self.close()
            raise WheelLost(f"{model.name} does not answer: {error}") from error

    def read(self) -> WheelReading:
        """See `Wheel.read`; rate and torque are not told."""
        axes = self.axes()
        known = self._calibration
        return WheelReading(
            time=time.perf_counter(),
            steering_wheel_angle=axes[0] * known.angle_sign * known.full_range / 2.0,
            steering_wheel_rate=math.nan,
            driver_torque=math.nan,
            accelerator=pedal_position(
                axis_at(axes, known.accelerator_axis), known.accelerator_sign
            ),
            brake=pedal_position(axis_at(axes, known.brake_axis), known.brake_sign),
            buttons=0 if self._report is None else self._report.buttons,
        )

    def axes(self) -> tuple[float, ...]:
        """Steering, clutch, accelerator and brake in [-1, 1], as they are now.

        Raises:
            WheelLost: If the device is gone.
        """
        self._check()
        self._drain()
        if self._report is None:
            raise WheelLost(f"{self._model.name} has not said where it stands")
        return self._report.axes

    def write(self, torque: float) -> None:
        """See `Wheel.write`; a thread sends it."""
        self._check()
        command = device_command(self._calibration, limited(torque, self.torque_limit))
        if self._sender is not None:
            self._sender.put(round(_FULL_LEVEL * command))

    def close(self) -> None:
        """See `Wheel.close`."""
        if not self._open:
            return
        self._open = False
        if self._sender is not None:
            self._sender.end()
        with contextlib.suppress(OSError):  # if it is gone, its motor is too
            for command in logitech.all_stop():
                self._transport.write(command)
        self._transport.close()

    def _check(self) -> None:
        if not self._open:
            raise WheelLost(f"{self._model.name} is closed")
        if self._sender is not None and self._sender.error is not None:
            reason = self._sender.error
            raise WheelLost(f"{self._model.name} was unplugged: {reason}") from reason

    def _drain(self) -> None:
        """Read all reports that wait; the newest counts."""
        try:
            while report := self._transport.read():
                self._report = logitech.decoded(self._model.layout, report)
        except OSError as error:
            raise WheelLost(f"{self._model.name} was unplugged: {error}") from error
        except ValueError as error:
            raise WheelLost(f"{self._model.name}: {error}") from error

    def _await_report(self, patience: float) -> None:
        """Wait for the first report; some wheels send one only when they move."""
        last = time.perf_counter() + patience
        self._drain()
        while self._report is None:
            if time.perf_counter() > last:
                raise WheelLost("it is silent; turn it a little and try again")
            time.sleep(0.005)
            self._drain()


def _opening(model: logitech.LogitechModel, full_range: float) -> tuple[bytes, ...]:
    """Commands with which a wheel starts: no force but ours, the range, a zero."""
    if model.ranged:
        ranges: tuple[bytes, ...] = (logitech.steering_range(full_range),)
    else:
        ranges = logitech.pro_steering_range(full_range)
    return (
        logitech.fixed_loop_off(),
        logitech.autocenter_off(),
        *ranges,
        logitech.constant(0, 0, logitech.PLAY),
    )
