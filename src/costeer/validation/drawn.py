"""What was drawn for the drivers of a population: the parameters that differ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.base.packing import leaf_names, packed
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import (
    Traits,
    correlation_matrix,
    drawn_traits,
    participant_driver,
)

UNITS = {
    "vision.lead_time": "s",
    "vision.near_noise": "rad",
    "vision.motor_noise": "rad",
    "arm.stiffness": "N·m/rad",
    "arm.inertia": "kg·m²",
    "arm.damping": "N·m·s/rad",
    "reliance.reliance": "-",
    "reliance.cocontraction": "-",
    "tracking.wander_deviation": "m",
    "tracking.lane_bias": "m",
    "decision.headway": "s",
    "decision.return_headway": "s",
    "decision.change_duration": "s",
    "decision.patience": "s",
    "decision.shoulder_share": "-",
    "gaze.amplitude": "-",
    "longitudinal.preferred_speed": "m/s",
    "longitudinal.overtaking_speed": "m/s",
}
"""Parameters that differ between drivers, and their units."""


class Spread(NamedTuple):
    """How one parameter is spread over a population.

    Attributes:
        parameter: Part of the driver and name.
        unit: SI.
        low: 5th percentile.
        median: 50th percentile.
        high: 95th percentile.
    """

    parameter: str
    unit: str
    low: Real
    median: Real
    high: Real


def drawn_drivers(seed: int, num_drivers: int, speed: Real) -> list[dict[str, Real]]:
    """Parameters of each driver that are his or her own.

    Args:
        seed: Of the population.
        num_drivers: How many.
        speed: Suggested speed [m/s].
    """
    places = {name: leaf_names(DriverParameters()).index(name) for name in UNITS}
    drivers = []
    for number in range(1, num_drivers + 1):
        values = packed(participant_driver(seed, number, speed))
        own = {name: float(values[place]) for name, place in places.items()}
        drivers.append({"participant": number, **own})
    return drivers


def spreads(drivers: list[dict[str, Real]]) -> list[Spread]:
    """Percentiles of each parameter over the drivers."""
    return [
        Spread(
            name,
            unit,
            *map(float, np.percentile([d[name] for d in drivers], [5, 50, 95])),
        )
        for name, unit in UNITS.items()
    ]


class TraitPair(NamedTuple):
    """Two traits that go together.

    Attributes:
        first: Name of a trait.
        second: Name of another.
        correlation: In the population [-].
    """

    first: str
    second: str
    correlation: Real


def trait_pairs() -> list[TraitPair]:
    """Every two traits that are correlated, strongest first."""
    matrix, names = correlation_matrix(), Traits._fields
    pairs = [
        TraitPair(names[row], names[column], float(matrix[row, column]))
        for row in range(len(names))
        for column in range(row)
        if matrix[row, column] != 0.0
    ]
    return sorted(pairs, key=lambda pair: -abs(pair.correlation))


def drawn_correlations(seed: int, num_drivers: int) -> NDArray[np.float64]:
    """Correlations of the traits among these drivers, shape `(trait, trait)`.

    Returns:
        NaN with fewer than three drivers.
    """
    if num_drivers < 3:
        return np.full((len(Traits._fields), len(Traits._fields)), np.nan)
    drawn = [drawn_traits(seed, number) for number in range(1, num_drivers + 1)]
    return np.asarray(np.corrcoef(np.array(drawn), rowvar=False))
