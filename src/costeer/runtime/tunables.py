"""What an experimenter may change while a person drives: what the method declares."""

from __future__ import annotations

import math

from costeer.base.array import Real
from costeer.methods.interface import Tunable
from costeer.methods.registry import AnyMethod


def tunable_named(method: AnyMethod, name: str) -> Tunable:
    """The tunable of that name.

    Raises:
        ValueError: If the method has none.
    """
    by_name = {tunable.name: tunable for tunable in method.tunables}
    if name not in by_name:
        known = ", ".join(by_name) or "nothing"
        raise ValueError(
            f"'{name}' cannot be tuned in method {method.name}; choose one of {known}"
        )
    return by_name[name]


def place_of(tunable: Tunable) -> str:
    """Its dotted place in the `LoopParameters` of its method."""
    return f"controller.{tunable.leaf}"


def checked_value(tunable: Tunable, value: Real) -> Real:
    """The value, if it may be set.

    Raises:
        ValueError: If it is out of range or no number.
    """
    if not (math.isfinite(value) and tunable.low <= value <= tunable.high):
        unit = "" if tunable.unit == "-" else f" {tunable.unit}"
        raise ValueError(
            f"{tunable.name} is {value:g}; give a number from {tunable.low:g} to "
            f"{tunable.high:g}{unit}"
        )
    return value
