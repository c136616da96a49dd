"""Units that people read: files and interfaces hold SI, pages and tables these."""

from __future__ import annotations

import math
from typing import NamedTuple

_DEGREES = 180.0 / math.pi


class Shown(NamedTuple):
    """How a quantity is shown.

    Attributes:
        unit: To people.
        factor: Shown value of one unit of the file.
    """

    unit: str
    factor: float


_SHOWN = {
    "rad": Shown("deg", _DEGREES),
    "rad/s": Shown("deg/s", _DEGREES),
    "rad/s²": Shown("deg/s²", _DEGREES),
}
KMH = Shown("km/h", 3.6)


def shown(unit: str) -> Shown:
    """How a quantity in an SI unit is shown; m/s is that of a car along its road."""
    return KMH if unit == "m/s" else _SHOWN.get(unit, Shown(unit, 1.0))
