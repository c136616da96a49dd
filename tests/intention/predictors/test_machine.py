"""The support vector machine and its filter."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.predictors.support_vectors import (
    BLOCK,
    decision_values,
    filtered,
)
from tests.intention.predictors.made import machine

PRIOR = -2.7


def test_blocks_give_what_single_windows_give() -> None:
    weights = machine("full")
    rng = np.random.default_rng(0)
    numbers = rng.normal(size=(BLOCK + 3, 5))
    together = decision_values(weights, numbers)
    vectors = weights.vectors.astype(float)
    for row in (0, BLOCK - 1, BLOCK, BLOCK + 2):
        squared = ((numbers[row] - vectors) ** 2).sum(axis=1)
        alone = weights.dual @ np.exp(-0.2 * squared) + 0.1
        assert together[row] == pytest.approx(alone, abs=1e-12)


def test_no_share_is_no_filter() -> None:
    logit = np.array([np.nan, -1.0, 2.0])
    np.testing.assert_array_equal(filtered(logit, PRIOR, 0.0), logit)


def test_evidence_that_says_nothing_leaves_the_prior() -> None:
    # The prior is the share of time that the two states take in the long run.
    np.testing.assert_allclose(filtered(np.full(500, PRIOR), PRIOR, 1.0), PRIOR)


def test_evidence_adds_up_and_fades() -> None:
    logit = np.concatenate([np.full(60, PRIOR + 1.0), np.full(900, PRIOR)])
    said = filtered(logit, PRIOR, 0.3)
    assert (np.diff(said[:60]) > 0.0).all()
    assert said[59] > PRIOR + 1.0
    assert said[-1] == pytest.approx(PRIOR, abs=0.1)


def test_the_filter_forgets_what_lies_before_a_gap() -> None:
    logit = np.concatenate([np.full(60, 5.0), [np.nan], np.full(60, PRIOR)])
    said = filtered(logit, PRIOR, 1.0)
    assert np.isnan(said[60])
    np.testing.assert_allclose(said[61:], PRIOR)
