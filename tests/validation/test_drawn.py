"""What is drawn for the drivers of a population."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from costeer.base.packing import leaf_names, packed
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import (
    POPULATIONS,
    SECOND,
    Population,
    participant_driver,
)
from costeer.drivers.traits import Traits, correlation_matrix
from costeer.validation.drawn import (
    DISTRIBUTIONS,
    LOG_NORMAL,
    UNITS,
    distribution_told,
    drawn_correlations,
    drawn_drivers,
    spreads,
    trait_pairs,
)

SPEED = 70.0 / 3.6


BOTH = [each for each in POPULATIONS.values() if each is not SECOND]


@cache
def many(name: str) -> list[dict[str, float]]:
    return drawn_drivers(1, 1500, SPEED, POPULATIONS[name])


@pytest.mark.parametrize("population", POPULATIONS.values(), ids=lambda p: p.name)
def test_every_parameter_that_differs_is_listed(population: Population) -> None:
    people = [participant_driver(1, n, SPEED, population) for n in range(1, 30)]
    values = np.array([packed(each) for each in people])
    names = leaf_names(DriverParameters())
    differing = {
        name
        for name, column in zip(names, values.T, strict=True)
        if np.ptp(column) > 0.0
    }
    apart = {"evasion.reaction_time"}  # tests/drivers/test_population.py
    listed = set(drawn_drivers(1, 1, SPEED, population)[0]) - {"participant"}
    assert differing == listed | apart


def test_a_listed_value_is_the_drivers_own() -> None:
    second = drawn_drivers(1, 2, SPEED)[1]
    driver = participant_driver(1, 2, SPEED)
    assert second["participant"] == 2
    assert second["arm.stiffness"] == driver.arm.stiffness
    assert second["decision.change_duration"] == driver.decision.change_duration


def test_percentiles_rise() -> None:
    for spread in spreads(drawn_drivers(1, 50, SPEED)):
        assert spread.low < spread.median < spread.high


def test_every_parameter_that_differs_has_its_distribution() -> None:
    assert set(DISTRIBUTIONS) == set(UNITS)


def test_population_2_tolerates_nothing_and_says_nothing_of_a_band() -> None:
    assert "tolerance.band" in drawn_drivers(1, 1, SPEED)[0]
    alone = drawn_drivers(1, 3, SPEED, SECOND)
    assert not any("tolerance.band" in driver for driver in alone)
    assert "tolerance.band" not in {each.parameter for each in spreads(alone)}


@pytest.mark.slow
@pytest.mark.parametrize("population", BOTH, ids=lambda p: p.name)
@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_a_parameter_is_spread_as_its_distribution_says(
    name: str, population: Population
) -> None:
    kind, spread = DISTRIBUTIONS[name]
    values = np.array([driver[name] for driver in many(population.name)])
    shown = np.log(values) if kind == LOG_NORMAL else values
    low, high = np.percentile(shown, [25.0, 75.0])
    # Quartiles are inside every clip; 1500 drivers give their distance to 5 %.
    told = getattr(population.spreads, spread)
    assert (high - low) / 1.349 == pytest.approx(told, rel=0.12)
    assert distribution_told(name, population) == f"{kind}, {told:g}"


def test_traits_without_a_common_factor_make_no_pair() -> None:
    pairs = {(pair.first, pair.second): pair.correlation for pair in trait_pairs()}
    assert not any("noise" in pair for pair in pairs)
    sizes = [abs(correlation) for correlation in pairs.values()]
    assert sizes == sorted(sizes, reverse=True)
    assert len(pairs) == np.count_nonzero(np.tril(correlation_matrix(), -1))


def test_drawn_traits_are_correlated_as_given() -> None:
    found = drawn_correlations(1, 1500)
    # Standard error of a correlation of 1500: 0.026; 120 pairs, so five of it.
    assert np.abs(found - correlation_matrix()).max() < 0.13
    assert np.isnan(drawn_correlations(1, 2)).all()
    assert found.shape == (len(Traits._fields),) * 2
