"""The interval of a counted rate."""

from __future__ import annotations

import math

import pytest
from scipy import stats

from costeer.study.rates import poisson_interval


def test_the_interval_is_that_of_poisson_counts() -> None:
    # Garwood's table: 0 (0 to 3.689), 5 (1.623 to 11.668).
    assert poisson_interval(0, 1.0) == pytest.approx((0.0, 3.689), abs=5e-4)
    assert poisson_interval(5, 10.0) == pytest.approx((0.1623, 1.1668), abs=5e-5)


def test_nothing_counted_still_has_the_exact_upper_end() -> None:
    assert poisson_interval(0, 96.0)[1] == pytest.approx(-math.log(0.025) / 96.0)


@pytest.mark.parametrize("count", [1, 7])
def test_at_either_end_the_count_is_a_chance_of_a_fortieth(count: int) -> None:
    low, high = poisson_interval(count, 1.0)
    assert stats.poisson.sf(count - 1, low) == pytest.approx(0.025)
    assert stats.poisson.cdf(count, high) == pytest.approx(0.025)
