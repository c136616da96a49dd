"""What was drawn for the drivers of a population: the parameters that differ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.base.packing import leaf_names, packed
from costeer.drivers.population import USUAL, Population, participant_driver
from costeer.drivers.traits import Traits, correlation_matrix, drawn_traits

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
    "tolerance.band": "rad",
    "decision.headway": "s",
    "decision.return_headway": "s",
    "decision.change_duration": "s",
    "decision.patience": "s",
    "decision.shoulder_share": "-",
    "gaze.amplitude": "-",
    "longitudinal.preferred_speed": "m/s",
    "longitudinal.overtaking_speed": "m/s",
}
"""Parameters that differ between drivers, and their units; but for the reaction time in
an emergency, which manual driving on a free road says nothing of."""

LOG_NORMAL, NORMAL = "log-normal", "normal"


class Distribution(NamedTuple):
    """How a parameter is spread; clipped where docs/drivers.md gives a range.

    Attributes:
        kind: "log-normal" or "normal".
        spread: Name of its `PopulationParameters`: standard deviation of the
            logarithm, or of the value.
    """

    kind: str
    spread: str


DISTRIBUTIONS = {
    "vision.lead_time": Distribution(NORMAL, "lead_time_spread"),
    "vision.near_noise": Distribution(LOG_NORMAL, "near_noise_spread"),
    "vision.motor_noise": Distribution(LOG_NORMAL, "near_noise_spread"),
    "arm.stiffness": Distribution(LOG_NORMAL, "stiffness_spread"),
    "arm.inertia": Distribution(LOG_NORMAL, "arm_spread"),
    "arm.damping": Distribution(LOG_NORMAL, "arm_spread"),
    "reliance.reliance": Distribution(NORMAL, "reliance_spread"),
    "reliance.cocontraction": Distribution(LOG_NORMAL, "cocontraction_spread"),
    "tracking.wander_deviation": Distribution(LOG_NORMAL, "wander_deviation_spread"),
    "tracking.lane_bias": Distribution(NORMAL, "lane_bias_spread"),
    "tolerance.band": Distribution(LOG_NORMAL, "band_spread"),
    "decision.headway": Distribution(LOG_NORMAL, "headway_spread"),
    "decision.return_headway": Distribution(LOG_NORMAL, "headway_spread"),
    "decision.change_duration": Distribution(LOG_NORMAL, "duration_spread"),
    "decision.patience": Distribution(LOG_NORMAL, "patience_spread"),
    "decision.shoulder_share": Distribution(NORMAL, "shoulder_spread"),
    "gaze.amplitude": Distribution(LOG_NORMAL, "glance_spread"),
    "longitudinal.preferred_speed": Distribution(NORMAL, "preferred_speed_spread"),
    "longitudinal.overtaking_speed": Distribution(NORMAL, "overtaking_speed_spread"),
}
"""By the parameter's name."""


def spread_of(name: str, population: Population = USUAL) -> Real:
    """How much a parameter is spread over a population, see `Distribution`."""
    return float(getattr(population.spreads, DISTRIBUTIONS[name].spread))


def differing(population: Population = USUAL) -> dict[str, str]:
    """Units of the parameters that differ between drivers of a population."""
    return {n: unit for n, unit in UNITS.items() if spread_of(n, population) > 0.0}


def distribution_told(name: str, population: Population = USUAL) -> str:
    """Kind and spread of a parameter, as `log-normal, 0.2`."""
    return f"{DISTRIBUTIONS[name].kind}, {spread_of(name, population):g}"


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


def drawn_drivers(
    seed: int, num_drivers: int, speed: Real, population: Population = USUAL
) -> list[dict[str, Real]]:
    """Parameters of each driver that are his or her own.

    Args:
        seed: Of the population.
        num_drivers: How many.
        speed: Suggested speed [m/s].
        population: Who is drawn from.
    """
    names = leaf_names(population.usual)
    places = {name: names.index(name) for name in differing(population)}
    drivers = []
    for number in range(1, num_drivers + 1):
        values = packed(participant_driver(seed, number, speed, population))
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
        if name in drivers[0]
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
