"""Which wheels are there, and how each kind is opened and stopped."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from functools import cache

from costeer.base.extras import install_command
from costeer.base.plugins import advertised, load_object
from costeer.devices.wheels import hid, sdl, senso, simulated
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import Wheel, WheelDescription, WheelKind
from costeer.devices.wheels.sdl_session import stay_ready

_INSTALL = (
    "pysdl2 and hidapi are not installed; install them with: "
    f"{install_command('drive')}"
)

ENTRY_POINTS = "costeer.wheels"
"""Group of entry points under which an installed package offers a `WheelKind`."""


def _open_hid(description: WheelDescription, calibration: WheelCalibration) -> Wheel:
    transport = hid.DeviceTransport(description.address)
    return hid.HidWheel(transport, hid.hid_model(description), calibration)


def _open_senso(description: WheelDescription, calibration: WheelCalibration) -> Wheel:
    return senso.SensoWheel(senso.open_bus(description), calibration)


def _open_simulated(
    description: WheelDescription, calibration: WheelCalibration
) -> Wheel:
    return simulated.open_simulated(description, calibration, time.perf_counter)


OWN = (
    WheelKind("sdl", sdl.SdlWheel, sdl.stop_sdl, stay_ready, lambda: sdl.sdl_wheels()),
    WheelKind(
        "hid", _open_hid, hid.stop_hid, hid.hid_library, lambda: hid.hid_wheels()
    ),
    WheelKind("senso", _open_senso, senso.stop_senso, senso.can_library),
    WheelKind("simulated", _open_simulated, simulated.stop_simulated),
)
"""Kinds of wheels that costeer knows by itself, in the order they are searched."""


@cache
def wheel_kinds() -> dict[str, WheelKind]:
    """Every kind of wheel by name, those of installed plug-ins last.

    Raises:
        ValueError: If two have one name, or a plug-in is no `WheelKind`.
    """
    kinds = {kind.name: kind for kind in OWN}
    for place in advertised(ENTRY_POINTS).values():
        kind = load_object(place, WheelKind, "WHEEL")
        if kind.name in kinds:
            raise ValueError(
                f"two kinds of wheels are called '{kind.name}', one of them {place}; "
                "give it another name"
            )
        kinds[kind.name] = kind
    return kinds


def _kind_of(description: WheelDescription) -> WheelKind:
    """The kind of a wheel.

    Raises:
        ValueError: If it is not known.
    """
    kinds = wheel_kinds()
    if description.kind not in kinds:
        raise ValueError(
            f"kind of the wheel is {description.kind!r}, it must be one of "
            f"{', '.join(kinds)}"
        )
    return kinds[description.kind]


def found_wheels(can: str = "", platform: str = sys.platform) -> list[WheelDescription]:
    """Wheels that are plugged in, each once.

    SDL2 is asked first, since it knows every vendor's wheel; on macOS its drivers lack
    the force of current wheels, so raw HID goes first there.

    Args:
        can: CAN bus with a SENSO-Wheel, as "pcan:PCAN_USBBUS1"; none is searched for.
        platform: As `sys.platform`.

    Raises:
        ModuleNotFoundError: If neither SDL2 nor hidapi is installed; says how to.
        ValueError: If `can` is no address.
    """
    if can:
        return [senso.senso_description(can)]
    searches = [each.search for each in wheel_kinds().values() if each.search]
    if platform == "darwin":
        searches.reverse()
    found: list[WheelDescription] = []
    missing: list[ModuleNotFoundError] = []
    for search in searches:
        try:
            others = search()
        except ModuleNotFoundError as error:
            missing.append(error)
            continue
        known = {_device(wheel) for wheel in found}
        found += [wheel for wheel in others if _device(wheel) not in known]
    if len(missing) == len(searches):
        raise ModuleNotFoundError(_INSTALL, name="sdl2") from missing[0]
    return found


def _device(description: WheelDescription) -> str:
    """Vendor and product, whichever backend found them."""
    return description.identity.removesuffix(hid.IDENTITY_END)


def open_wheel(description: WheelDescription, calibration: WheelCalibration) -> Wheel:
    """Open a device; call it in the process and the thread that reads and writes.

    Args:
        description: Which device.
        calibration: Of this device.

    Raises:
        ModuleNotFoundError: If the package for it is not installed; says how to.
        ValueError: If the calibration is another device's, or the kind is unknown.
        WheelLost: If it is not there or does not answer.
    """
    if calibration.identity != description.identity:
        raise ValueError(
            f"the calibration is of wheel {calibration.identity}, not of "
            f"{description.name} ({description.identity}); run: costeer wheel calibrate"
        )
    return _kind_of(description).open(description, calibration)


def emergency_stop(description: WheelDescription) -> None:
    """Take the torque off a wheel whose process died or stands still.

    Called from another process, after the first one was killed. A wheel that is not
    there any more pushes with nothing; that is no error.

    Raises:
        ModuleNotFoundError: If the package for it is not installed; says how to.
        ValueError: If the kind is unknown.
    """
    with suppress(OSError):
        _kind_of(description).stop(description)


def prepare_stop(description: WheelDescription) -> None:
    """Get ready for `emergency_stop`: imports and a search may take a second.

    Raises:
        ModuleNotFoundError: If the package for it is not installed; says how to.
        ValueError: If the kind is unknown.
    """
    _kind_of(description).prepare()
