"""Temperature and bias: what they change, and what they must leave as it is."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.intention.gru import random_weights
from costeer.intention.predictors.gru import our_probabilities
from costeer.training.calibration import (
    NEUTRAL,
    Calibration,
    calibrated,
    calibrated_weights,
    fit_calibration,
    logit,
)
from costeer.training.metrics import level_counts, log_loss, pr_auc, roc_auc
from costeer.training.verdicts import judged_samples, verdicts
from tests.training.synthetic import drive

calibrations = st.builds(
    Calibration,
    temperature=st.floats(0.2, 5.0),
    bias=st.floats(-3.0, 3.0),
)


def said(seed: int, num: int = 400) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Probabilities that are far apart, and a truth that leans on them."""
    rng = np.random.default_rng(seed)
    values = rng.permutation(np.linspace(-6.0, 6.0, num))
    truth = rng.random(num) < 1.0 / (1.0 + np.exp(-values))
    return 1.0 / (1.0 + np.exp(-values)), truth


@given(calibration=calibrations, seed=st.integers(0, 99))
def test_the_ranking_and_so_the_areas_stay(calibration: Calibration, seed: int) -> None:
    before, truth = said(seed)
    after = calibrated(calibration, before)
    np.testing.assert_array_equal(np.argsort(before), np.argsort(after))
    for area in (pr_auc, roc_auc):
        first = area(*level_counts(before, truth))
        assert float(area(*level_counts(after, truth))) == float(first)


@given(calibration=calibrations)
def test_equal_verdicts_stay_equal_and_none_overtakes(calibration: Calibration) -> None:
    extreme = np.array([0.0, 1e-30, 1e-9, 0.5, 0.5, 1.0 - 1e-9, 1.0])
    assert (np.diff(calibrated(calibration, extreme)) >= 0.0).all()


def test_no_verdict_stays_none() -> None:
    assert np.isnan(calibrated(Calibration(2.0, 1.0), np.array([np.nan]))).all()


@pytest.mark.parametrize(("temperature", "bias"), [(1.0, 0.0), (2.5, -1.0), (0.5, 1.5)])
def test_what_was_said_too_loudly_is_found_out(temperature: float, bias: float) -> None:
    rng = np.random.default_rng(1)
    true = rng.normal(-1.0, 2.0, 100_000)
    truth = rng.random(true.size) < 1.0 / (1.0 + np.exp(-true))
    distorted = temperature * (true - bias)
    found = fit_calibration(distorted, truth, np.ones(true.size))
    assert found.temperature == pytest.approx(temperature, rel=0.03)
    assert found.bias == pytest.approx(bias, abs=0.05)


def test_windows_count_by_their_weight() -> None:
    before, truth = said(3, 4000)
    twice = np.where(np.arange(4000) < 1000, 2.0, 1.0)
    rows = np.repeat(np.arange(4000), twice.astype(int))
    weighted = fit_calibration(logit(before), truth, twice)
    repeated = fit_calibration(logit(before)[rows], truth[rows], np.ones(len(rows)))
    np.testing.assert_allclose(weighted, repeated, rtol=1e-4)


def test_perfect_answers_do_not_make_it_certain() -> None:
    found = fit_calibration(
        np.array([-1.0, -1.0, 1.0]), np.array([False, False, True]), np.ones(3)
    )
    assert 0.01 < found.temperature < 1.0


def test_answers_that_are_upside_down_keep_their_order() -> None:
    before, truth = said(4)
    found = fit_calibration(logit(before), ~truth, np.ones(len(truth)))
    assert found.temperature > 1.0


def test_neutral_changes_no_bit_of_the_weights() -> None:
    start = random_weights(5, seed=1)
    same = calibrated_weights(NEUTRAL, start)
    assert all(np.array_equal(a, b) for a, b in zip(start, same, strict=True))


def test_a_calibrated_network_says_what_its_calibration_says() -> None:
    start, one = random_weights(5, seed=1), [drive(1, num_changes=1)]
    calibration = Calibration(temperature=0.6, bias=-2.0)
    before, truth = judged_samples(verdicts(partial(our_probabilities, start), one))
    changed = calibrated_weights(calibration, start)
    after, _ = judged_samples(verdicts(partial(our_probabilities, changed), one))
    np.testing.assert_allclose(after, calibrated(calibration, before), atol=2e-6)
    assert log_loss(after, truth) < log_loss(before, truth)
