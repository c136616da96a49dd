from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from statsmodels.regression.mixed_linear_model import MixedLM

from costeer.study.anova import pooled_f_tests
from costeer.study.contrasts import Effect, one_way, two_way
from costeer.study.mixed import BOUNDARY, mixed_f_tests
from costeer.study.repeated import repeated_f_test


def gappy_means(seed: int, num_cells: int = 7) -> NDArray[np.float64]:
    """Cell means of 12 participants who differ, one in eight missing."""
    rng = np.random.default_rng(seed)
    means = rng.normal(size=(12, num_cells)) + rng.normal(size=(12, 1))
    means += 0.3 * np.arange(num_cells)
    means[rng.random(means.shape) < 0.125] = np.nan
    return means


def statsmodels_f(
    means: NDArray[np.float64], effects: tuple[Effect, ...]
) -> list[float]:
    """Wald F of each effect by MixedLM, from the covariance of the fixed effects."""
    rows, cells = np.nonzero(np.isfinite(means))
    fixed = np.hstack([effect.contrasts for effect in effects])[cells]
    design = np.hstack([np.ones((rows.size, 1)), fixed])
    fit = MixedLM(means[rows, cells], design, rows).fit(reml=True, gtol=1e-8)
    # MixedLM inverts the whole Hessian; lme4, nlme and SAS its fixed effects only.
    size = design.shape[1]
    information = np.linalg.inv(np.asarray(fit.cov_params()))[:size, :size]
    covariance = np.linalg.inv(information)
    found, start = [], 1
    for effect in effects:
        part = slice(start, start + effect.contrasts.shape[1])
        chosen = fit.fe_params[part]
        wald = chosen @ np.linalg.solve(covariance[part, part], chosen)
        found.append(float(wald) / chosen.size)
        start = part.stop
    return found


@pytest.mark.parametrize("seed", range(4))
def test_missing_cells_give_the_wald_f_of_statsmodels(seed: int) -> None:
    means, effects = gappy_means(seed), one_way("condition", 7)
    (test,) = mixed_f_tests(means, effects)
    # MixedLM stops at a gradient of 1e-8, which leaves 1e-6 in F.
    assert [test.statistic] == pytest.approx(statsmodels_f(means, effects), rel=1e-5)
    assert test.df2 == np.isfinite(means).sum() - 12 - 6


def test_two_factors_with_missing_cells_give_the_wald_f_of_statsmodels() -> None:
    means, effects = gappy_means(5, num_cells=6), two_way("a", 2, "b", 3)
    found = [test.statistic for test in mixed_f_tests(means, effects)]
    assert found == pytest.approx(statsmodels_f(means, effects), rel=1e-5)


@pytest.mark.parametrize("spread", [0.5, 1.0, 30.0])
def test_without_missing_cells_it_is_the_repeated_measures_test(spread: float) -> None:
    rng = np.random.default_rng(4)
    means = rng.normal(size=(12, 6)) + spread * rng.normal(size=(12, 1))
    for effect, test in zip(
        two_way("a", 2, "b", 3),
        mixed_f_tests(means, two_way("a", 2, "b", 3)),
        strict=True,
    ):
        assert (test.df1, test.note) == (effect.contrasts.shape[1], "")
        assert test.df2 == 12 * 6 - 12 - 5
    (condition,) = mixed_f_tests(means, one_way("condition", 6))
    expected = repeated_f_test(means, one_way("condition", 6)[0])
    # REML finds the residual variance to the square root of machine precision.
    assert condition[:3] == pytest.approx(expected[:3], rel=1e-6)


def test_boundary_fit_is_named_and_treats_cells_as_independent() -> None:
    means = np.random.default_rng(1).normal(size=(12, 7))
    means -= 0.9 * means.mean(axis=1, keepdims=True)
    (test,) = mixed_f_tests(means, one_way("condition", 7))
    (pooled,) = pooled_f_tests(
        means.ravel(), np.tile(np.arange(7), 12), one_way("condition", 7)
    )
    assert test.note == BOUNDARY
    assert test.statistic == pytest.approx(pooled.statistic, rel=1e-12)
    assert (pooled.df2, test.df2) == (77.0, 66.0)


def test_order_of_participants_does_not_matter() -> None:
    means = gappy_means(7)
    (one,) = mixed_f_tests(means, one_way("condition", 7))
    (other,) = mixed_f_tests(means[::-1], one_way("condition", 7))
    # REML finds the variance to the square root of machine precision.
    assert one[:3] == pytest.approx(other[:3], rel=1e-6)


def only_one_participant() -> NDArray[np.float64]:
    means = np.full((3, 3), np.nan)
    means[0] = [1.0, 2.0, 4.0]
    return means


def one_cell_each() -> NDArray[np.float64]:
    return np.where(np.eye(3) > 0.0, 1.0, np.nan)


def nobody_in_the_last_cell() -> NDArray[np.float64]:
    means = np.random.default_rng(1).normal(size=(5, 3))
    means[:, 2] = np.nan
    return means


@pytest.mark.parametrize(
    ("means", "reason"),
    [
        (np.full((3, 3), np.nan), "fewer than two participants"),
        (only_one_participant(), "fewer than two participants"),
        (nobody_in_the_last_cell(), "a cell is empty"),
        (one_cell_each(), "too few cells"),
        (np.full((4, 3), 0.1), "no variance"),
        (np.ones((4, 1)), "fewer than two levels"),
    ],
)
def test_data_without_an_answer_give_a_reason(
    means: NDArray[np.float64], reason: str
) -> None:
    (test,) = mixed_f_tests(means, one_way("condition", means.shape[1]))
    assert math.isnan(test.statistic)
    assert reason in test.note
