"""The car that a record says was driven."""

from __future__ import annotations

from collections.abc import Mapping

from costeer.plant.parameters import CARS, DEFAULT_CAR, CarParameters


def recorded_car(about: Mapping[str, object]) -> CarParameters:
    """The car of a record's description; what it does not say is as usual.

    Args:
        about: The description; empty for a table without one.
    """
    configuration = about.get("configuration")
    told = configuration.get("car") if isinstance(configuration, Mapping) else None
    given = told if isinstance(told, Mapping) else {}
    usual = CARS.get(str(about.get("car")), DEFAULT_CAR)
    known = {k: given[k] for k in CarParameters._fields if _is_number(given.get(k))}
    return usual._replace(**known)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
