"""Driver models by name: costeer's own, those of installed packages, and files."""

from __future__ import annotations

from costeer.base.plugins import advertised, is_place, load_object, refuse_twin
from costeer.drivers.checked import checked_driver
from costeer.drivers.interface import AnyDriver, DriverModel
from costeer.drivers.population import VIRTUAL

ENTRY_POINTS = "costeer.drivers"
"""Group of entry points under which an installed package offers its drivers."""

HANDS_OFF = "hands-off"
"""Name of nobody: the virtual driver's foot without hands, eyes or wishes."""

NAMES = (VIRTUAL.name, HANDS_OFF)
"""Drivers that need no place to be found."""


def driver_named(driver: str | AnyDriver) -> AnyDriver:
    """The driver model that is meant.

    Args:
        driver: A name of `NAMES` or of an installed plug-in, `module:object`,
            `file.py`, `file.py:object`, or the model itself.

    Raises:
        ValueError: If there is none, two have the name, or it cannot be run.
    """
    if not isinstance(driver, str):
        return _own(driver)
    if driver in NAMES:
        refuse_twin(ENTRY_POINTS, driver)
        return VIRTUAL
    if is_place(driver):
        return _own(load_object(driver, DriverModel, "DRIVER"))
    offered = advertised(ENTRY_POINTS)
    if driver in offered:
        return _own(load_object(offered[driver], DriverModel, "DRIVER"))
    raise ValueError(
        f"driver '{driver}' is not known; choose one of "
        f"{', '.join([*NAMES, *offered])}, or give a driver model as module:object or "
        "as a Python file"
    )


def _own(driver: AnyDriver) -> AnyDriver:
    """A driver from outside, if the loop can run it and its name is free.

    Raises:
        ValueError: If not.
    """
    if driver is VIRTUAL:
        return driver
    checked = checked_driver(driver)
    if checked.name in NAMES:
        raise ValueError(
            f"a driver model of yours is called '{checked.name}', as costeer's own; "
            "give it another name"
        )
    return checked
