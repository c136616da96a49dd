"""Traits: which go together, by how much, and that people are drawn one by one."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers.traits import (
    FACTORS,
    Traits,
    correlation_matrix,
    drawn_traits,
    loadings,
)

NUM_DRIVERS = 4000
NAMES = Traits._fields


@cache
def people(seed: int = 5) -> NDArray[np.float64]:
    """Traits of many drivers, shape `(driver, trait)`."""
    return np.array([drawn_traits(seed, n) for n in range(1, NUM_DRIVERS + 1)])


def stated(one: str, other: str) -> float:
    """Correlation that the factors state, written out: the sum of both loadings."""
    if one == other:
        return 1.0
    return float(
        sum(f.loadings.get(one, 0.0) * f.loadings.get(other, 0.0) for f in FACTORS)
    )


def test_correlations_are_exactly_those_of_the_factors() -> None:
    expected = [[stated(one, other) for other in NAMES] for one in NAMES]
    # Two products at most are added: one rounding.
    np.testing.assert_allclose(correlation_matrix(), expected, atol=1e-15)


def test_correlations_are_a_correlation_matrix() -> None:
    matrix = correlation_matrix()
    np.testing.assert_array_equal(matrix, matrix.T)
    np.testing.assert_array_equal(np.diag(matrix), 1.0)
    assert np.linalg.eigvalsh(matrix).min() > 0.1


@pytest.mark.parametrize(
    ("one", "other", "correlation"),
    [
        ("preferred_speed", "headway", -0.3),
        ("headway", "duration", 0.24),
        ("arm_inertia", "stiffness", 0.36),
        ("reliance", "cocontraction", -0.3025),
        ("noise", "wander", 0.0),
        ("stiffness", "reliance", 0.0),
    ],
)
def test_who_drives_fast_keeps_short_gaps_and_so_on(
    one: str, other: str, correlation: float
) -> None:
    matrix = correlation_matrix()
    assert matrix[NAMES.index(one), NAMES.index(other)] == pytest.approx(correlation)


def test_no_factor_explains_more_than_there_is() -> None:
    assert (np.sum(loadings() ** 2, axis=1) < 1.0).all()
    assert {name for f in FACTORS for name in f.loadings} < set(NAMES)
    assert all(factor.source for factor in FACTORS)


def test_drawn_traits_correlate_as_stated() -> None:
    # Standard error (1 - r²) / sqrt(n) of each; the largest of 120 pairs stays
    # below 4.5 of them in all but one of a thousand samples.
    matrix = correlation_matrix()
    error = (1.0 - matrix**2) / math.sqrt(NUM_DRIVERS)
    assert (np.abs(np.corrcoef(people().T) - matrix) <= 4.5 * error + 1e-12).all()


def test_each_trait_is_standard_normal() -> None:
    # Four and a half standard errors of mean, deviation and the share within one.
    within = np.mean(np.abs(people()) < 1.0, axis=0)
    share = math.erf(math.sqrt(0.5))
    n = NUM_DRIVERS
    np.testing.assert_allclose(people().mean(axis=0), 0.0, atol=4.5 / math.sqrt(n))
    np.testing.assert_allclose(people().std(axis=0), 1.0, atol=4.5 / math.sqrt(2 * n))
    allowed = 4.5 * math.sqrt(share * (1.0 - share) / n)
    np.testing.assert_allclose(within, share, atol=allowed)


def test_people_do_not_resemble_their_neighbours_nor_those_of_another_seed() -> None:
    others = np.array([drawn_traits(6, n) for n in range(1, NUM_DRIVERS + 1)])
    for one, other in (
        (people()[:-1], people()[1:]),
        (people(), others),
    ):
        mean = np.mean(one * other, axis=0)
        # A product of two independent standard normals has the variance 1.
        assert np.abs(mean).max() < 4.5 / math.sqrt(NUM_DRIVERS - 1)


def test_a_persons_traits_do_not_depend_on_who_else_was_drawn() -> None:
    alone = drawn_traits(5, 77)
    drawn_traits(5, 3)
    assert drawn_traits(5, 77) == alone == Traits(*people()[76])
