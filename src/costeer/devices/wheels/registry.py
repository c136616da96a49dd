"""Which wheels are there, and how each kind is opened and stopped."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from costeer.devices.wheels import hid, sdl, senso, simulated
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import Wheel, WheelDescription
from costeer.devices.wheels.sdl_session import stay_ready

_INSTALL = (
    "pysdl2 and hidapi are not installed; install them with: "
    "pip install 'costeer[drive]'"
)

Search = Callable[[], list[WheelDescription]]


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
    searches: list[Search] = [sdl.sdl_wheels, hid.hid_wheels]
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
    if description.kind == "sdl":
        return sdl.SdlWheel(description, calibration)
    if description.kind == "hid":
        model = hid.hid_model(description)
        return hid.HidWheel(
            hid.DeviceTransport(description.address), model, calibration
        )
    if description.kind == "senso":
        return senso.SensoWheel(senso.open_bus(description), calibration)
    if description.kind == "simulated":
        return simulated.open_simulated(description, calibration, time.perf_counter)
    raise _unknown(description)


def emergency_stop(description: WheelDescription) -> None:
    """Take the torque off a wheel whose process died or stands still.

    Called from another process, after the first one was killed. A wheel that is not
    there any more pushes with nothing; that is no error.

    Raises:
        ModuleNotFoundError: If the package for it is not installed; says how to.
        ValueError: If the kind is unknown.
    """
    stops = {
        "sdl": sdl.stop_sdl,
        "hid": hid.stop_hid,
        "senso": senso.stop_senso,
        "simulated": simulated.stop_simulated,
    }
    if description.kind not in stops:
        raise _unknown(description)
    try:
        stops[description.kind](description)
    except OSError:
        return


def prepare_stop(description: WheelDescription) -> None:
    """Get ready for `emergency_stop`: imports and a search may take a second.

    Raises:
        ModuleNotFoundError: If the package for it is not installed; says how to.
    """
    if description.kind == "sdl":
        stay_ready()
    elif description.kind == "hid":
        hid.hid_library()
    elif description.kind == "senso":
        senso.can_library()


def _unknown(description: WheelDescription) -> ValueError:
    return ValueError(
        f"kind of the wheel is {description.kind!r}, it must be one of sdl, hid, senso "
        "and simulated"
    )
