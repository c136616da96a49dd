"""Whether the values of a recording look like SI units.

Numbers in degrees or km/h are read without complaint and judged as nonsense; here they
are noticed.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import radians
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

# Any: the element type differs from column to column.
Columns = Mapping[str, NDArray[Any]]

_ANGLE, _SPEED = "steering_wheel_angle", "longitudinal_velocity"

_PLAUSIBLE = {
    "steering_wheel_angle": (15.0, "rad", "degrees", radians(1.0)),
    "yaw_angle": (np.pi, "rad", "degrees", radians(1.0)),
    "longitudinal_velocity": (70.0, "m/s", "km/h", 1.0 / 3.6),
    "driver_torque": (40.0, "N·m", "hundredths of N·m", 0.01),
    "head_yaw": (1.5, "-", "degrees instead of [-1, 1]", 1.0 / 90.0),
    "lateral_position": (30.0, "m", "centimetres", 0.01),
}
"""Largest plausible absolute values, the SI unit, what a larger one looks like, and the
factor that mends it. Source: assumed, beyond what cars and drivers reach."""

_LARGEST_LATERAL_ACCELERATION = 12.0  # [m/s²], more than tyres give
_STEERING_RATIO_TIMES_WHEELBASE = 16.0 * 2.7  # [m], a passenger car


class Suspicion(NamedTuple):
    """A column that does not look like its unit.

    Attributes:
        column: Its name.
        words: What it looks like.
        factor: That would give the expected unit.
    """

    column: str
    words: str
    factor: float


def suspicions(columns: Columns) -> list[Suspicion]:
    """Columns whose values do not look like SI units; those of text are left out."""
    columns = {n: values for n, values in columns.items() if values.dtype.kind in "fiu"}
    found = [
        Suspicion(name, f"{name} looks like {other}, expected {unit}", factor)
        for name, (largest, unit, other, factor) in _PLAUSIBLE.items()
        if name in columns and _largest(columns[name]) > largest
    ]
    told = {each.column: each.factor for each in found}
    if _ANGLE not in told and _steers_too_hard(columns, told.get(_SPEED, 1.0)):
        words = f"{_ANGLE} looks like degrees, expected rad"
        found.append(Suspicion(_ANGLE, words, radians(1.0)))
    return found


def unit_doubts(columns: Columns) -> list[str]:
    """What does not look like SI units, in words, with what would mend it."""
    return [
        f"{each.words}; if so, multiply it by {each.factor:.6g} (on the command line: "
        f"--scale {each.column}={each.factor:.6g})"
        for each in suspicions(columns)
    ]


def _largest(values: NDArray[np.float64]) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def _steers_too_hard(columns: Columns, speed_factor: float) -> bool:
    """Whether the angle, in radians, would need more grip than tyres have."""
    if not {_ANGLE, _SPEED} <= columns.keys():
        return False
    speed = columns[_SPEED] * speed_factor
    acceleration = columns[_ANGLE] * speed**2 / _STEERING_RATIO_TIMES_WHEELBASE
    return _largest(acceleration) > _LARGEST_LATERAL_ACCELERATION
