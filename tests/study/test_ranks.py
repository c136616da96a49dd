"""Friedman's and Wilcoxon's tests, against pingouin, SciPy and counting by hand."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from costeer.study.ranks import friedman_test, wilcoxon_test
from tests.study.test_against_pingouin import SAME, STORED

SCALE = st.lists(st.integers(0, 6), min_size=2, max_size=9)


def test_friedman_is_that_of_pingouin() -> None:
    expected = STORED["ranks"]
    test = friedman_test(np.array(expected["scores"]))
    assert test.effect_size.value == pytest.approx(expected["W"], rel=SAME)
    assert test.statistic == pytest.approx(expected["Q"], rel=SAME)
    assert (test.df, test.p) == (4.0, pytest.approx(expected["p"], rel=SAME))


def test_signed_ranks_are_those_of_pingouin() -> None:
    expected = STORED["ranks"]
    pairs = itertools.combinations(np.array(expected["scores"]).T, 2)
    for (first, second), smaller, size in zip(
        pairs, expected["W_val"], expected["RBC"], strict=True
    ):
        test, other = wilcoxon_test(first, second), wilcoxon_test(second, first)
        assert min(test.statistic, other.statistic) == pytest.approx(smaller)
        assert test.effect_size.value == pytest.approx(size, rel=SAME)


@pytest.mark.parametrize("seed", range(5))
def test_friedman_is_that_of_scipy(seed: int) -> None:
    scores = np.random.default_rng(seed).integers(0, 4, (9, 5)).astype(float)
    expected = stats.friedmanchisquare(*scores.T)
    test = friedman_test(scores)
    assert (test.statistic, test.p) == pytest.approx(tuple(expected), rel=SAME)


@pytest.mark.parametrize("seed", range(5))
def test_p_without_ties_is_the_exact_one_of_scipy(seed: int) -> None:
    first, second = np.random.default_rng(seed).normal(size=(2, 30))
    expected = stats.wilcoxon(first, second, method="exact").pvalue
    assert wilcoxon_test(first, second).p == pytest.approx(expected, rel=SAME)


@given(st.data())
def test_p_with_ties_counts_all_signs(data: st.DataObject) -> None:
    differences = np.array(data.draw(SCALE), dtype=float) - 3.0
    if not differences.any():
        return
    test = wilcoxon_test(differences, np.zeros(differences.size))
    ranks = stats.rankdata(np.abs(differences[differences != 0.0]))
    sums = np.array(
        [
            float(np.dot(signs, ranks))
            for signs in itertools.product((0.0, 1.0), repeat=ranks.size)
        ]
    )
    observed = ranks[differences[differences != 0.0] > 0.0].sum()
    assert test.statistic == pytest.approx(observed)
    tails = np.mean(sums <= observed), np.mean(sums >= observed)
    assert test.p == pytest.approx(min(1.0, 2.0 * min(tails)), rel=1e-12)


def test_rounding_breaks_no_tie() -> None:
    # 0.3 - 0.2 and 0.2 - 0.1 differ in the last digit of a double.
    first, second = np.array([0.3, 0.2, 0.1, 0.5]), np.array([0.2, 0.1, 0.2, 0.2])
    whole = wilcoxon_test(np.round(10.0 * first), np.round(10.0 * second))
    found = wilcoxon_test(first, second)
    assert (found.statistic, found.p) == (whole.statistic, whole.p) == (8.0, 0.5)


@given(st.integers(0, 2**32 - 1))
def test_only_the_order_of_a_scale_counts(seed: int) -> None:
    scores = np.random.default_rng(seed).integers(0, 6, (8, 4)).astype(float)
    before, after = friedman_test(scores), friedman_test(np.exp(scores))
    assert before[:3] == pytest.approx(after[:3], nan_ok=True)


@pytest.mark.parametrize(
    ("scores", "reason"),
    [
        (np.zeros((1, 5)), "1 participant(s)"),
        (np.zeros((9, 2)), "fewer than three"),
        (np.ones((9, 4)), "everyone answers alike"),
    ],
)
def test_friedman_without_an_answer_gives_a_reason(
    scores: NDArray[np.float64], reason: str
) -> None:
    test = friedman_test(scores)
    assert math.isnan(test.p)
    assert reason in test.note


@pytest.mark.parametrize("first", [[], [1.0], [2.0, 3.0]])
def test_signed_ranks_without_an_answer_give_a_reason(first: list[float]) -> None:
    test = wilcoxon_test(np.array(first), np.array(first))
    assert math.isnan(test.p)
    assert test.note


def test_full_agreement_has_no_interval_and_says_so() -> None:
    test = friedman_test(np.tile(np.arange(4.0), (6, 1)))
    assert test.effect_size.value == pytest.approx(1.0)
    assert math.isnan(test.effect_size.low)
    assert "no interval" in test.note


def test_one_direction_has_the_interval_of_a_share() -> None:
    # Clopper and Pearson (1934): 12 of 12 have a lower limit of 0.7354, R: binom.test.
    first = np.arange(1.0, 13.0)
    size = wilcoxon_test(first, np.zeros(12)).effect_size
    assert size[:3] == pytest.approx((1.0, 2.0 * 0.7353515 - 1.0, 1.0), abs=1e-6)
    mirrored = wilcoxon_test(np.zeros(12), first).effect_size
    assert mirrored[:3] == pytest.approx((-1.0, -size.high, -size.low))


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.1, 0.5])
def test_intervals_hold_the_truth_in_95_of_100_studies(step: float) -> None:
    # 600 studies of 12 participants: a share of 0.95 has a standard error of 0.009;
    # jackknife intervals err on the safe side near zero.
    rng = np.random.default_rng(1)

    def answers(num: int) -> NDArray[np.float64]:
        return np.asarray(np.round(step * np.arange(7) + rng.normal(size=(num, 7))))

    # Of many participants W is the spread of the mean ranks over that of the ranks, and
    # the correlation that of signed ranks.
    many = answers(100_000)
    ranks = stats.rankdata(many, axis=1) - 4.0
    agreement = float(
        np.sum(ranks.mean(axis=0) ** 2) / np.mean(np.sum(ranks**2, axis=1))
    )
    differences = many[:, 6] - many[:, 0]
    differences = differences[differences != 0.0]
    signed = np.sign(differences) * stats.rankdata(np.abs(differences))
    lead = float(signed.sum() / np.abs(signed).sum())
    held = np.zeros(2)
    for _ in range(600):
        scores = answers(12)
        one = friedman_test(scores).effect_size
        other = wilcoxon_test(scores[:, 6], scores[:, 0]).effect_size
        held += one.low <= agreement <= one.high, other.low <= lead <= other.high
    assert np.all(held / 600 > 0.92)
