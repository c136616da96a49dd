"""Spread between and within drivers: the parts that were put in come out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.validation.manual import ManualDriving, Row
from costeer.validation.spread import (
    components,
    correlation,
    interval,
    target_spreads,
)
from costeer.validation.targets import MEASURES, target_statistic

RANDOM = np.random.Generator(np.random.PCG64(7))


def people(
    amount: int, between: float, within: float, sizes: tuple[int, ...]
) -> list[np.ndarray]:
    """Values of people who differ by `between` and from time to time by `within`."""
    return [
        5.0
        + between * RANDOM.standard_normal()
        + within * RANDOM.standard_normal(sizes[k % len(sizes)])
        for k in range(amount)
    ]


@pytest.mark.parametrize("sizes", [(8,), (2,), (3, 9)])
def test_both_parts_come_back(sizes: tuple[int, ...]) -> None:
    found = components(people(4000, 0.7, 1.2, sizes))
    # 4000 people: the standard error of the smaller part is 2 % with two values each.
    assert found.between == pytest.approx(0.7, rel=0.08)
    assert found.within == pytest.approx(1.2, rel=0.03)


def test_equal_groups_give_the_textbook_analysis_of_variance() -> None:
    groups = [np.array([1.0, 3.0]), np.array([5.0, 7.0])]
    # Mean squares: within 2, between 16; (16 - 2) / 2 values = 7.
    assert components(groups) == pytest.approx((math.sqrt(7.0), math.sqrt(2.0)))


def test_drivers_who_differ_less_than_chance_do_not_differ() -> None:
    assert components([np.array([1.0, 3.0]), np.array([1.0, 3.0])]).between == 0.0


def test_one_driver_or_one_value_each_has_no_parts() -> None:
    assert all(map(math.isnan, components([np.array([1.0, 2.0])])))
    assert all(map(math.isnan, components([np.array([1.0]), np.array([2.0])])))


def test_a_pair_that_is_not_known_does_not_count() -> None:
    first = np.array([1.0, 2.0, 3.0, math.nan])
    assert correlation(first, 2.0 * first + 1.0) == pytest.approx(1.0)
    assert math.isnan(correlation(first[:2], first[:2]))


def test_the_interval_of_a_mean_is_that_of_its_standard_error() -> None:
    measure = MEASURES["M1"]
    groups = [np.array([value]) for value in RANDOM.standard_normal(400)]
    low, high = interval(measure, groups)
    # 400 values: 1.96 / 20; 1000 resamples give the ends to 5 %.
    assert (high - low) / 2.0 == pytest.approx(1.96 / 20.0, rel=0.15)
    assert low < target_statistic(measure, np.concatenate(groups)) < high
    assert interval(measure, groups) == (low, high)


def made_up(noise: float) -> ManualDriving:
    """Drivers whose values grow with their number, and a little noise."""
    columns = {measure.column for measure in MEASURES.values()}

    def row(driver: int, place: int) -> Row:
        extra = noise * math.sin(37.0 * driver + 11.0 * place)
        return {"participant": driver, **dict.fromkeys(columns, driver + extra)}

    trials = [row(driver, 0) for driver in range(1, 9)]
    changes = [row(driver, place) for driver in range(1, 9) for place in range(4)]
    return ManualDriving(trials, changes, 0)


def test_drivers_who_do_the_same_again_correlate_fully() -> None:
    spreads = {s.name: s for s in target_spreads(made_up(0.0), made_up(0.0))}
    assert all(s.retest == pytest.approx(1.0) for s in spreads.values())
    assert all(s.within == pytest.approx(0.0) for s in spreads.values())
    # Standard deviation of 1 to 8.
    assert spreads["M1"].between == pytest.approx(math.sqrt(6.0))
    assert spreads["M11"].between == pytest.approx(100.0 * math.sqrt(6.0))


def test_noise_shows_within_drivers() -> None:
    spreads = target_spreads(made_up(0.3), made_up(-0.3))
    assert all(s.within > 0.0 and s.retest < 1.0 for s in spreads)


def test_unequal_numbers_of_values_are_weighed_as_in_an_analysis_of_variance() -> None:
    # By hand: means 0 and 4, grand mean 3, mean squares 12 between and 1 within, and
    # (4 - (1 + 9) / 4) / (2 - 1) = 1.5 values in the usual driver.
    found = components([np.array([0.0]), np.array([3.0, 4.0, 5.0])])
    assert found.within == pytest.approx(1.0)
    assert found.between == pytest.approx(math.sqrt(11.0 / 1.5))
