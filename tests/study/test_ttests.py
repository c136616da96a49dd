from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.study.effects import hedges_correction
from costeer.study.ttests import (
    benjamini_hochberg,
    independent_t_test,
    paired_t_test,
    significance_mark,
)

# R's data set sleep (Student 1908): extra hours of ten people under two drugs.
FIRST = np.array([0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0])
SECOND = np.array([1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4])


def test_paired_test_is_that_of_r() -> None:
    # R: t.test(extra ~ group, data = sleep, paired = TRUE).
    test = paired_t_test(FIRST, SECOND)
    assert test.statistic == pytest.approx(-4.0621, abs=5e-5)
    assert (test.df, test.p) == pytest.approx((9.0, 0.002833), abs=5e-7)
    assert (test.low, test.high) == pytest.approx((-2.4598858, -0.7001142), abs=5e-8)
    assert test.effect_size.value == pytest.approx(test.statistic / math.sqrt(10))
    assert test.effect_size.kind == "Cohen's d_z"


def test_independent_test_is_that_of_r() -> None:
    # R: t.test(extra ~ group, data = sleep, var.equal = TRUE).
    test = independent_t_test(FIRST, SECOND)
    assert test.statistic == pytest.approx(-1.8608, abs=5e-5)
    assert (test.df, test.p) == pytest.approx((18.0, 0.07919), abs=5e-6)
    assert (test.low, test.high) == pytest.approx((-3.363874, 0.203874), abs=5e-7)
    assert test.effect_size.kind == "Cohen's d"


def test_paired_sizes_are_those_that_lakens_prints() -> None:
    # Lakens (2013), Frontiers in Psychology 4:863: ten people rate two films; t(9) =
    # 4.74, d_z 1.50, g_av 1.03, and ESCI's interval of d_av from 0.42 to 1.80.
    first = np.array([9.0, 7.0, 8.0, 9.0, 8.0, 9.0, 9.0, 10.0, 9.0, 9.0])
    second = np.array([9.0, 6.0, 7.0, 8.0, 7.0, 9.0, 8.0, 8.0, 8.0, 7.0])
    test = paired_t_test(first, second)
    assert test.statistic == pytest.approx(4.74, abs=5e-3)
    assert test.effect_size.value == pytest.approx(1.50, abs=5e-3)
    corrected = test.d_av.value * hedges_correction(test.df)
    assert corrected == pytest.approx(1.03, abs=5e-3)
    assert test.d_av[1:3] == pytest.approx((0.42, 1.80), abs=5e-3)


def test_d_av_of_equal_groups_is_their_d() -> None:
    # With as many values in both, the pooled variance is the mean of the two.
    test = independent_t_test(FIRST, SECOND)
    assert test.d_av[:3] == pytest.approx(test.effect_size[:3], rel=1e-12)
    swapped = independent_t_test(SECOND, FIRST[:7]).d_av
    mean = math.sqrt((SECOND.var(ddof=1) + FIRST[:7].var(ddof=1)) / 2.0)
    difference = SECOND.mean() - FIRST[:7].mean()
    assert swapped.value == pytest.approx(difference / mean, rel=1e-12)


def test_correction_is_that_of_benjamini_and_hochberg_by_hand() -> None:
    # Six values: p * 6 / rank, then the smallest of it and those of larger ranks.
    p = (0.010, 0.040, 0.030, 0.005, 0.900, 0.500)
    expected = (0.030, 0.060, 0.060, 0.030, 0.900, 0.600)
    assert benjamini_hochberg(p) == pytest.approx(expected, rel=1e-12)


def test_missing_test_does_not_count_in_the_correction() -> None:
    corrected = benjamini_hochberg((0.02, math.nan, 0.04))
    assert corrected[0] == pytest.approx(0.04)
    assert math.isnan(corrected[1])
    assert corrected[2] == pytest.approx(0.04)
    assert benjamini_hochberg(()) == ()


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_correction_never_lowers_a_p_value(p: list[float]) -> None:
    for before, after in zip(p, benjamini_hochberg(p), strict=True):
        assert before <= after * (1.0 + 1e-12) <= 1.0 + 1e-9


@pytest.mark.parametrize(
    ("p", "mark"),
    [
        (0.0, "***"),
        (0.000999, "***"),
        (0.001, "**"),
        (0.00999, "**"),
        (0.01, "*"),
        (0.04999, "*"),
        (0.05, ""),
        (1.0, ""),
        (math.nan, ""),
    ],
)
def test_mark_stands_for_a_p_below_its_level(p: float, mark: str) -> None:
    assert significance_mark(p) == mark


@pytest.mark.parametrize(
    ("first", "second", "reason"),
    [
        ([], [1.0, 2.0], "0 and 2 values"),
        ([1.0], [1.0, 2.0], "1 and 2 values"),
        ([0.1, 0.1], [0.7, 0.7, 0.7], "no variance"),
    ],
)
def test_independent_test_without_an_answer_gives_a_reason(
    first: list[float], second: list[float], reason: str
) -> None:
    test = independent_t_test(np.array(first), np.array(second))
    assert math.isnan(test.statistic)
    assert reason in test.note


@pytest.mark.parametrize(
    ("first", "second", "reason"),
    [
        ([], [], "0 participant(s)"),
        ([1.0], [2.0], "1 participant(s)"),
        ([0.1, 0.2, 0.3], [0.2, 0.3, 0.4], "no variance of the difference"),
        ([0.1, 0.2], [0.1, 0.2], "no variance of the difference"),
    ],
)
def test_paired_test_without_an_answer_gives_a_reason(
    first: list[float], second: list[float], reason: str
) -> None:
    test = paired_t_test(np.array(first), np.array(second))
    assert math.isnan(test.statistic)
    assert reason in test.note
