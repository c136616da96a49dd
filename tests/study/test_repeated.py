from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.anova import AnovaRM

from costeer.study.contrasts import one_way, two_way
from costeer.study.repeated import repeated_f_test

# Winer, Brown and Michels (1991), table 4.3: five persons' scores under four drugs.
DRUGS = np.array(
    [
        [30.0, 28.0, 16.0, 34.0],
        [14.0, 18.0, 10.0, 22.0],
        [24.0, 20.0, 18.0, 30.0],
        [38.0, 34.0, 20.0, 44.0],
        [26.0, 28.0, 14.0, 30.0],
    ]
)


def test_one_way_is_that_of_stata() -> None:
    # Stata, [R] anova, example with repeated(drug): F 24.76, Greenhouse-Geisser
    # epsilon 0.6049 with p 0.0006, Huynh-Feldt epsilon 1.0789 "reset to 1.0000".
    test = repeated_f_test(DRUGS, one_way("drug", 4)[0])
    assert (test.df1, test.df2) == (3.0, 12.0)
    assert test.statistic == pytest.approx(24.76, abs=5e-3)
    assert test.epsilon == pytest.approx(0.6049, abs=5e-5)
    p = stats.f.sf(test.statistic, 3.0 * test.epsilon, 12.0 * test.epsilon)
    assert p == pytest.approx(0.0006, abs=5e-5)
    assert test.huynh_feldt == 1.0


@pytest.mark.parametrize("seed", range(5))
def test_one_way_equals_statsmodels(seed: int) -> None:
    means = np.random.default_rng(seed).normal(size=(9, 7)) + np.arange(7) * 0.2
    test = repeated_f_test(means, one_way("condition", 7)[0])
    who, what = np.indices(means.shape)
    frame = pd.DataFrame({"y": means.ravel(), "who": who.ravel(), "c": what.ravel()})
    expected = AnovaRM(frame, "y", "who", within=["c"]).fit().anova_table
    assert test.statistic == pytest.approx(expected["F Value"].iloc[0], rel=1e-10)
    assert (test.df1, test.df2) == (6.0, 48.0)


@pytest.mark.parametrize("seed", range(5))
def test_two_way_equals_statsmodels(seed: int) -> None:
    means = np.random.default_rng(seed).normal(size=(9, 6)) + np.arange(6) * 0.2
    who, what = np.indices(means.shape)
    frame = pd.DataFrame(
        {
            "y": means.ravel(),
            "who": who.ravel(),
            "a": what.ravel() // 3,
            "b": what.ravel() % 3,
        }
    )
    expected = AnovaRM(frame, "y", "who", within=["a", "b"]).fit().anova_table
    for effect, row in zip(
        two_way("a", 2, "b", 3), expected.itertuples(index=False), strict=True
    ):
        test = repeated_f_test(means, effect)
        assert test.statistic == pytest.approx(row[0], rel=1e-10)
        assert (test.df1, test.df2) == (row[1], row[2])


def test_two_levels_give_the_square_of_the_paired_t() -> None:
    means = np.random.default_rng(3).normal(size=(12, 2))
    test = repeated_f_test(means, one_way("condition", 2)[0])
    paired = stats.ttest_rel(means[:, 0], means[:, 1])
    assert test.statistic == pytest.approx(paired.statistic**2, rel=1e-12)
    assert test.epsilon == test.huynh_feldt == 1.0


@given(st.integers(0, 2**32 - 1), st.integers(2, 15), st.integers(2, 7))
def test_epsilon_lies_between_one_contrast_and_sphericity(
    seed: int, num_participants: int, num_cells: int
) -> None:
    means = np.random.default_rng(seed).normal(size=(num_participants, num_cells))
    test = repeated_f_test(means, one_way("condition", num_cells)[0])
    lowest = 1.0 / (num_cells - 1)
    assert lowest <= test.epsilon <= test.huynh_feldt <= 1.0


@given(st.integers(0, 2**32 - 1))
def test_what_a_participant_adds_to_all_cells_counts_for_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    means = rng.normal(size=(12, 7))
    plain = repeated_f_test(means, one_way("condition", 7)[0])
    shifted = repeated_f_test(
        means + 100.0 * rng.normal(size=(12, 1)), one_way("condition", 7)[0]
    )
    # Values a hundred times larger lose two of sixteen digits, F twice as many.
    assert shifted[:4] == pytest.approx(plain[:4], rel=1e-10)


@pytest.mark.parametrize(
    ("means", "reason"),
    [
        (np.zeros((0, 3)), "0 participant(s)"),
        (np.ones((1, 3)), "1 participant(s)"),
        (np.ones((5, 1)), "fewer than two levels"),
        (np.full((5, 3), 0.1), "no variance"),
        (np.full((5, 3), 0.1) + np.arange(3), "no variance"),
        (np.full((5, 3), 0.1) + np.arange(5)[:, None], "no variance"),
    ],
)
def test_data_without_an_answer_give_a_reason(
    means: np.ndarray[tuple[int, int], np.dtype[np.float64]], reason: str
) -> None:
    test = repeated_f_test(means, one_way("condition", means.shape[1])[0])
    assert math.isnan(test.statistic)
    assert reason in test.note


@pytest.mark.slow
def test_p_is_uniform_where_conditions_do_nothing() -> None:
    # Spherical data of 12 participants; Kolmogorov-Smirnov over 2,000 studies fails
    # one of a thousand right programs, and the seed is fixed.
    rng = np.random.default_rng(2)
    effect = one_way("condition", 7)[0]
    data = rng.normal(size=(2000, 12, 7)) + rng.normal(size=(2000, 12, 1))
    tests = [repeated_f_test(means, effect) for means in data]
    p = [stats.f.sf(test.statistic, test.df1, test.df2) for test in tests]
    assert stats.kstest(p, "uniform").pvalue > 0.001
