"""Driver models by name: costeer's own, those of installed packages, and files."""

from __future__ import annotations

from costeer.base.registry import Registry
from costeer.drivers.checked import checked_driver
from costeer.drivers.interface import AnyDriver, DriverModel
from costeer.drivers.population import MODELS, VIRTUAL

HANDS_OFF = "hands-off"
"""Name of nobody: the virtual driver's foot without hands, eyes or wishes."""

DRIVERS: dict[str, AnyDriver] = {**MODELS, HANDS_OFF: VIRTUAL}
"""Driver models that need no place to be found."""

driver_named = Registry[AnyDriver](
    what="driver",
    group="costeer.drivers",
    own=DRIVERS,
    kind=DriverModel,
    checked=checked_driver,
).named
