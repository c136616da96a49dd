from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy import stats

from costeer.study.contrasts import one_way
from costeer.study.effects import (
    cohens_d,
    cohens_d_z,
    generalised_eta_squared,
    hedges_correction,
    partial_eta_squared,
)
from costeer.study.repeated import repeated_f_test
from costeer.study.rows import About, effect_row
from costeer.study.ttests import paired_t_test

DEGREES = st.floats(1.0, 700.0)


def test_eta_interval_is_that_of_confintr() -> None:
    # R 4.3, confintr 1.0: ci_rsquared(lm(Sepal.Length ~ ., data = iris)).
    share = 0.8673123
    size = partial_eta_squared(share / 5.0 / ((1.0 - share) / 144.0), 5.0, 144.0)
    assert size.value == pytest.approx(share, abs=1e-12)
    # The seven printed digits of the share go in, so seven come out.
    assert (size.low, size.high) == pytest.approx((0.8244916, 0.8889573), abs=1e-7)


def test_small_sample_correction_is_that_of_hedges_and_olkin() -> None:
    # Hedges and Olkin (1985): J(10) = Γ(5) / (√5 Γ(4.5)) = 0.922745.
    assert hedges_correction(10.0) == pytest.approx(0.922745, abs=1e-6)
    # Their approximation 1 - 3 / (4 df - 1) is off by 0.007 at 2 and less beyond.
    for df in (2.0, 5.0, 30.0, 600.0):
        assert hedges_correction(df) == pytest.approx(1 - 3 / (4 * df - 1), abs=8e-3)
    assert hedges_correction(1.0) == 0.0


@given(st.floats(0.0, 1e6), DEGREES, DEGREES, st.floats(0.01, 1.0))
def test_generalised_share_is_smaller_by_the_errors_of_the_rest(
    statistic: float, df1: float, df2: float, error_share: float
) -> None:
    partial = partial_eta_squared(statistic, df1, df2)
    size = generalised_eta_squared(partial, error_share, 11.0, df2)
    # By hand: the effect's sum of squares F df1 / df2 beside an own error of 1, and
    # all errors of 1 / error_share.
    explained = statistic * df1 / df2
    by_hand = explained / (explained + 1.0 / error_share)
    assert size.value == pytest.approx(by_hand, rel=1e-9, abs=1e-300)
    assert 0.0 <= size.low <= size.high <= 1.0
    if error_share == 1.0:
        assert size[:3] == pytest.approx(partial[:3], rel=1e-9, abs=1e-300)
    assert size.value <= partial.value * (1.0 + 1e-12)


def test_eta_interval_is_that_of_smithsons_spss_script() -> None:
    # NoncF3.sps by M. Smithson, as printed by K. Wuensch for t(86) = 3.267, 90 %.
    size = partial_eta_squared(10.673, 1.0, 86.0, confidence=0.90)
    assert (size.low, size.high) == pytest.approx((0.027, 0.218), abs=5e-4)


def test_d_interval_is_that_of_real_statistics() -> None:
    # Real Statistics for Excel, "CI Functions for Effect Size d": one sample of 40.
    size = cohens_d_z(-3.66393, 40)
    assert size.value == pytest.approx(-0.579318, abs=1e-6)
    assert (size.low, size.high) == pytest.approx((-0.91148, -0.24079), abs=1e-5)


@given(st.floats(1e-3, 1e3), DEGREES, DEGREES)
def test_f_is_in_the_tails_at_the_ends_of_its_interval(
    statistic: float, df1: float, df2: float
) -> None:
    size = partial_eta_squared(statistic, df1, df2)
    assert 0.0 <= size.low <= size.high < 1.0
    for share, tail in ((size.low, 0.975), (size.high, 0.025)):
        noncentrality = share / (1.0 - share) * (df1 + df2 + 1.0)
        if share > 0.0:
            below = stats.ncf.cdf(statistic, df1, df2, noncentrality)
            # brentq stops at 2e-12 of the noncentrality.
            assert below == pytest.approx(tail, abs=1e-8)
        else:
            assert stats.f.cdf(statistic, df1, df2) <= tail


@given(st.floats(-200.0, 200.0), st.integers(2, 700))
@example(1.2e-144, 2)
def test_t_is_in_the_tails_at_the_ends_of_its_interval(
    statistic: float, n: int
) -> None:
    size = cohens_d_z(statistic, n)
    assert size.low <= size.value <= size.high
    if statistic < 0.0:  # the library is accurate in the upper half
        statistic, low, high = -statistic, -size.high, -size.low
    else:
        low, high = size.low, size.high
    if statistic < 1e-12:  # the library gives NaN for 1e-144
        statistic = 0.0
    for limit, tail in ((low, 0.975), (high, 0.025)):
        below = stats.nct.cdf(statistic, n - 1, limit * math.sqrt(n))
        assert below == pytest.approx(tail, abs=1e-8)


@given(st.floats(0.0, 1e9), st.integers(2, 300), st.integers(2, 300))
def test_mirrored_difference_has_mirrored_effect_size(
    statistic: float, first: int, second: int
) -> None:
    right, left = (cohens_d(sign * statistic, first, second) for sign in (1.0, -1.0))
    mirrored = (-left.value, -left.high, -left.low)
    assert right[:3] == pytest.approx(mirrored, rel=1e-9)


def test_d_equals_difference_over_pooled_deviation() -> None:
    first, second = [1.0, 2.0, 3.0, 6.0], [4.0, 5.0, 9.0]
    pooled = math.sqrt((14.0 + 14.0) / 5.0)  # sums of squares 14 and 14, df 5
    statistic = stats.ttest_ind(first, second).statistic
    assert cohens_d(statistic, 4, 3).value == pytest.approx(-3.0 / pooled, rel=1e-12)


@pytest.mark.parametrize("n", [2, 12, 600])
def test_interval_has_no_step_where_its_formula_changes(n: int) -> None:
    # At the change the approximation is 4e-7 off, the step in t itself 1e-6.
    below, above = cohens_d_z(9_999.995, n), cohens_d_z(10_000.005, n)
    assert below[:3] == pytest.approx(above[:3], rel=2e-6)


@pytest.mark.parametrize("df2", [1.0, 11.0, 652.0])
def test_eta_interval_has_no_step_where_its_formula_changes(df2: float) -> None:
    below = partial_eta_squared(9.99999e7, 1.0, df2)
    above = partial_eta_squared(1.00001e8, 1.0, df2)
    # What is not explained falls as 1 / F, which steps by 2e-5.
    for one, other in zip(below[:3], above[:3], strict=True):
        assert 1.0 - one == pytest.approx(1.0 - other, rel=1e-4)


def test_no_effect_at_all_has_an_interval_at_zero() -> None:
    assert partial_eta_squared(0.0, 2.0, 22.0)[:3] == (0.0, 0.0, 0.0)


@pytest.mark.slow
def test_ninety_five_of_hundred_intervals_hold_the_true_share() -> None:
    # 4,000 draws: the share has a standard error of 0.0034; four of them are allowed.
    noncentrality, df1, df2 = 20.0, 2, 60
    truth = noncentrality / (noncentrality + df1 + df2 + 1)
    draws = stats.ncf.rvs(df1, df2, noncentrality, size=4000, random_state=1)
    sizes = [partial_eta_squared(float(draw), df1, df2) for draw in draws]
    share = sum(size.low <= truth <= size.high for size in sizes) / len(sizes)
    assert share == pytest.approx(0.95, abs=0.014)


@pytest.mark.slow
@pytest.mark.parametrize("likeness", [0.3, 0.9])
def test_intervals_of_what_people_share_hold_the_truth(likeness: float) -> None:
    # 300 studies of 12 participants whose values in two conditions correlate by the
    # likeness: a share of 0.95 has a standard error of 0.013; three are allowed.
    means = 0.3 * np.arange(7)
    explained = float(np.sum((means - means.mean()) ** 2))
    truth = explained / (explained + 7.0), 0.3 * 6.0
    rng, held = np.random.default_rng(1), np.zeros(2)
    for _ in range(300):
        people = math.sqrt(likeness) * rng.normal(size=(12, 1))
        values = means + people + math.sqrt(1.0 - likeness) * rng.normal(size=(12, 7))
        test = repeated_f_test(values, one_way("condition", 7)[0])
        row = effect_row(About("made up", "within", 12, ""), "condition", test)
        ends = row.generalised_eta_squared_low, row.generalised_eta_squared_high
        other = paired_t_test(values[:, 6], values[:, 0]).d_av
        held += ends[0] <= truth[0] <= ends[1], other.low <= truth[1] <= other.high
    assert np.all(held / 300 > 0.91)
