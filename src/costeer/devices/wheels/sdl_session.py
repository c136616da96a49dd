"""SDL2's library, and its devices: found, opened, described."""

from __future__ import annotations

import ctypes
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from costeer.base.extras import install_command
from costeer.devices.wheels.interface import EFFECT_LIFE, WheelDescription, WheelLost

_HINTS = {
    "SDL_JOYSTICK_HIDAPI": "0",  # SDL's own drivers know pads, not forces
    "SDL_JOYSTICK_RAWINPUT": "0",  # takes wheels away from DirectInput
    "SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": "1",  # the browser has the focus
    "SDL_JOYSTICK_THREAD": "1",  # on Windows nobody pumps messages here
    "SDL_NO_SIGNAL_HANDLERS": "1",  # Ctrl-C belongs to Python
}
_ACCESS = "close other programs that use it, and see that your user may write to it"


def sdl_library() -> Any:  # Any: sdl2 ships no types
    """Import SDL2 and set it up for a process without a window.

    Raises:
        ModuleNotFoundError: If it is not installed; says how to.
    """
    try:
        with warnings.catch_warnings():
            # It warns of the library that it brings itself.
            warnings.simplefilter("ignore", UserWarning)
            import sdl2
    except ImportError as error:
        raise ModuleNotFoundError(
            "pysdl2 or its library is not installed; install it with: "
            f"{install_command('drive')}",
            name="sdl2",
        ) from error
    hints = dict(_HINTS)
    if sys.platform != "win32":
        hints["SDL_VIDEODRIVER"] = "dummy"  # DirectInput wants a real window
    for name, value in hints.items():
        sdl2.SDL_SetHint(name.encode(), value.encode())
    return sdl2


def constant_force(sdl: Any) -> Any:  # Any: sdl2 ships no types
    """An effect of zero level along the steering axis, as long as `EFFECT_LIFE`."""
    effect = sdl.SDL_HapticEffect()
    # Bytes of the union that are left as they were would be sent as an envelope.
    ctypes.memset(ctypes.byref(effect), 0, ctypes.sizeof(effect))
    effect.type = sdl.SDL_HAPTIC_CONSTANT
    effect.constant.direction.type = sdl.SDL_HAPTIC_STEERING_AXIS
    effect.constant.length = round(1000.0 * EFFECT_LIFE)
    return effect


def stay_ready() -> None:
    """Start SDL2 for the rest of the process, so that a session costs no time.

    Where it does not start, nothing is said: a session will say it.

    Raises:
        ModuleNotFoundError: If SDL2 is not installed.
    """
    sdl = sdl_library()
    sdl.SDL_InitSubSystem(sdl.SDL_INIT_JOYSTICK | sdl.SDL_INIT_HAPTIC)


@contextmanager
def running(sdl: Any) -> Iterator[None]:  # Any: sdl2 ships no types
    """Keep SDL's joysticks and forces alive; sessions may nest."""
    parts = sdl.SDL_INIT_JOYSTICK | sdl.SDL_INIT_HAPTIC
    if sdl.SDL_InitSubSystem(parts) != 0:
        raise WheelLost(f"SDL2 does not start: {last_error(sdl)}")
    # Nobody reads SDL's events; kept, they would fill its queue.
    sdl.SDL_JoystickEventState(sdl.SDL_IGNORE)
    try:
        yield
    finally:
        sdl.SDL_QuitSubSystem(parts)


def addresses(sdl: Any) -> dict[str, int]:  # Any: sdl2 ships no types
    """Index of each joystick by its address: GUID and number among its equals."""
    found: dict[str, int] = {}
    sdl.SDL_JoystickUpdate()
    for index in range(sdl.SDL_NumJoysticks()):
        text = ctypes.create_string_buffer(33)
        sdl.SDL_JoystickGetGUIDString(sdl.SDL_JoystickGetDeviceGUID(index), text, 33)
        guid = text.value.decode()
        number = sum(1 for address in found if address.startswith(guid))
        found[f"{guid}#{number}"] = index
    return found


def name_of_pushing(sdl: Any, index: int) -> str | None:  # Any: sdl2 ships no types
    """Name of a joystick that has a constant force, else None."""
    joystick = sdl.SDL_JoystickOpen(index)
    if not joystick:
        return None
    haptic = sdl.SDL_HapticOpenFromJoystick(joystick)
    features = sdl.SDL_HapticQuery(haptic) if haptic else 0
    name = (sdl.SDL_JoystickName(joystick) or b"steering wheel").decode(
        errors="replace"
    )
    if haptic:
        sdl.SDL_HapticClose(haptic)
    sdl.SDL_JoystickClose(joystick)
    return name if features & sdl.SDL_HAPTIC_CONSTANT else None


def opened(sdl: Any, description: WheelDescription) -> tuple[Any, Any]:  # Any: sdl2's
    """Joystick and haptic device of a description.

    Raises:
        WheelLost: If it is not there or does not open.
    """
    index = addresses(sdl).get(description.address)
    if index is None:
        raise WheelLost(f"{description.name} is not plugged in; plug it in")
    joystick = sdl.SDL_JoystickOpen(index)
    haptic = sdl.SDL_HapticOpenFromJoystick(joystick) if joystick else None
    if not haptic:
        reason = last_error(sdl)
        if joystick:
            sdl.SDL_JoystickClose(joystick)
        raise WheelLost(f"{description.name} does not open: {reason}; {_ACCESS}")
    return joystick, haptic


def last_error(sdl: Any) -> str:  # Any: sdl2 ships no types
    """What SDL says went wrong last."""
    return (sdl.SDL_GetError() or b"no reason given").decode(errors="replace")
