"""Wheels through SDL2: DirectInput on Windows, evdev on Linux.

One constant force of finite length is kept running and changed; it dies by itself when
nobody refreshes it. Open, read and write from one thread of a process of its own.
"""

from __future__ import annotations

import ctypes
import math
import time
from typing import Any, NamedTuple

from costeer.devices.wheels.calibration import (
    WheelCalibration,
    device_command,
    largest_torque,
)
from costeer.devices.wheels.interface import (
    EFFECT_LIFE,
    LEFT_INDICATOR,
    RIGHT_INDICATOR,
    WheelDescription,
    WheelLost,
    WheelReading,
    axis_at,
    limited,
    pedal_position,
)
from costeer.devices.wheels.sdl_session import (
    addresses,
    constant_force,
    last_error,
    name_of_pushing,
    opened,
    running,
    sdl_library,
)

_RERUN_AFTER = EFFECT_LIFE / 2.0
_STEERING_AXIS = 0
_FULL_LEVEL = 32767
_AXIS_STEPS = 32768.0


class Paddles(NamedTuple):
    """Numbers of the buttons behind the rim.

    Attributes:
        left: Of the left paddle; 5 on Logitech's wheels.
        right: Of the right paddle; 4 on Logitech's wheels.
    """

    left: int = 5
    right: int = 4


def sdl_wheels() -> list[WheelDescription]:
    """Devices that can push with a constant force.

    Raises:
        ModuleNotFoundError: If SDL2 is not installed.
        WheelLost: If SDL2 does not start.
    """
    sdl = sdl_library()
    found: list[WheelDescription] = []
    with running(sdl):
        for address, index in addresses(sdl).items():
            if (name := name_of_pushing(sdl, index)) is not None:
                vendor = sdl.SDL_JoystickGetDeviceVendor(index)
                product = sdl.SDL_JoystickGetDeviceProduct(index)
                identity = f"{vendor:04x}-{product:04x}"
                found.append(WheelDescription("sdl", address, name, identity))
    return found


def stop_sdl(description: WheelDescription) -> None:
    """Stop every effect of a device, from another process than the one that drives it.

    On Linux the kernel has erased the effects of a process that died, and others die
    within `EFFECT_LIFE`; on Windows this stops them at once.

    Raises:
        WheelLost: If the device is not there.
    """
    sdl = sdl_library()
    with running(sdl):
        joystick, haptic = opened(sdl, description)
        sdl.SDL_HapticStopAll(haptic)
        sdl.SDL_HapticClose(haptic)
        sdl.SDL_JoystickClose(joystick)


class SdlWheel:
    """A wheel that SDL2 drives.

    SDL2 shows an axis as it was when it was opened until it has moved by 1.25 % of its
    half, 5.6 deg of 900; then the axis jumps to where it is.

    Attributes:
        is_awake: Whether the angle is shown as it is: False until a reading of the
            steering differs from the one that SDL2 took when it was opened.
    """

    measures_torque = False
    # A third of the loop's 960 Hz: an update takes one USB transfer of 1 to 2 ms.
    write_rate = 320.0

    def __init__(
        self,
        description: WheelDescription,
        calibration: WheelCalibration,
        paddles: Paddles = Paddles(),  # noqa: B008  because it cannot change
    ) -> None:
        """Open the device and start a constant force of zero.

        Args:
            description: As `sdl_wheels` gave it.
            calibration: Of this device.
            paddles: Which buttons are the indicators.

        Raises:
            WheelLost: If the device is not there or does not push.
        """
        self.torque_limit = largest_torque(calibration)
        self.is_awake = False
        self._calibration = calibration
        self._name = description.name
        self._paddles = paddles
        self._sdl = sdl_library()
        self._session = running(self._sdl)
        self._session.__enter__()
        try:
            self._joystick, self._haptic = opened(self._sdl, description)
        except WheelLost:
            self._session.__exit__(None, None, None)
            raise
        self._open = True
        self._run_at = -math.inf
        self._start()

    def read(self) -> WheelReading:
        """See `Wheel.read`; rate and torque are not told."""
        axes = self.axes()
        known = self._calibration
        half_range = known.angle_sign * known.full_range / 2.0
        return WheelReading(
            time=time.perf_counter(),
            steering_wheel_angle=axes[_STEERING_AXIS] * half_range,
            steering_wheel_rate=math.nan,
            driver_torque=math.nan,
            accelerator=pedal_position(
                axis_at(axes, known.accelerator_axis), known.accelerator_sign
            ),
            brake=pedal_position(axis_at(axes, known.brake_axis), known.brake_sign),
            buttons=self._indicators(),
        )

    def axes(self) -> tuple[float, ...]:
        """Every axis of the device, in [-1, 1], as it is now.

        Raises:
            WheelLost: If the device is gone.
        """
        if not self._open:
            raise WheelLost(f"{self._name} is closed")
        self._sdl.SDL_JoystickUpdate()
        if not self._sdl.SDL_JoystickGetAttached(self._joystick):
            raise WheelLost(f"{self._name} was unplugged")
        axis = self._sdl.SDL_JoystickGetAxis
        self.is_awake = self.is_awake or self._has_moved()
        return tuple(axis(self._joystick, n) / _AXIS_STEPS for n in self._axis_numbers)

    def write(self, torque: float) -> None:
        """See `Wheel.write`."""
        if not self._open:
            raise WheelLost(f"{self._name} is closed")
        torque = limited(torque, self.torque_limit)
        self._update(round(_FULL_LEVEL * device_command(self._calibration, torque)))
        now = time.perf_counter()
        if now - self._run_at >= _RERUN_AFTER:
            self._run_at = now
            self._taken(self._sdl.SDL_HapticRunEffect(self._haptic, self._number, 1))

    def close(self) -> None:
        """See `Wheel.close`."""
        if not self._open:
            return
        self._open = False
        sdl, haptic = self._sdl, self._haptic
        self._effect.constant.level = 0
        sdl.SDL_HapticUpdateEffect(haptic, self._number, ctypes.byref(self._effect))
        sdl.SDL_HapticStopEffect(haptic, self._number)
        sdl.SDL_HapticDestroyEffect(haptic, self._number)
        sdl.SDL_HapticClose(haptic)
        sdl.SDL_JoystickClose(self._joystick)
        self._session.__exit__(None, None, None)

    def _start(self) -> None:
        """Switch off what the device does by itself; run an effect of zero."""
        sdl = self._sdl
        self._axis_numbers = range(sdl.SDL_JoystickNumAxes(self._joystick))
        features = sdl.SDL_HapticQuery(self._haptic)
        if features & sdl.SDL_HAPTIC_AUTOCENTER:
            sdl.SDL_HapticSetAutocenter(self._haptic, 0)
        if features & sdl.SDL_HAPTIC_GAIN:
            sdl.SDL_HapticSetGain(self._haptic, 100)
        self._effect = constant_force(sdl)
        self._number: int = sdl.SDL_HapticNewEffect(
            self._haptic, self._effect_pointer()
        )
        try:
            self._taken(self._number)
            self.write(0.0)
        except WheelLost:
            self.close()
            raise

    def _has_moved(self) -> bool:
        """Whether SDL2 shows another steering axis than the first that it was told."""
        first = ctypes.c_int16()
        known = self._sdl.SDL_JoystickGetAxisInitialState(
            self._joystick, _STEERING_AXIS, ctypes.byref(first)
        )
        now = self._sdl.SDL_JoystickGetAxis(self._joystick, _STEERING_AXIS)
        return bool(known) and now != first.value

    def _update(self, level: int) -> None:
        self._effect.constant.level = level
        self._taken(
            self._sdl.SDL_HapticUpdateEffect(
                self._haptic, self._number, self._effect_pointer()
            )
        )

    def _effect_pointer(self) -> Any:  # Any: a pointer of ctypes
        return ctypes.byref(self._effect)

    def _taken(self, answer: int) -> None:
        if answer < 0:
            raise WheelLost(f"{self._name} takes no force: {last_error(self._sdl)}")

    def _indicators(self) -> int:
        button = self._sdl.SDL_JoystickGetButton
        left = LEFT_INDICATOR if button(self._joystick, self._paddles.left) else 0
        right = RIGHT_INDICATOR if button(self._joystick, self._paddles.right) else 0
        return left + right
