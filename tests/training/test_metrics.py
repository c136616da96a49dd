"""Scores against their definitions, counted by hand or by brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.training import metrics

SAID = np.array([0.1, 0.4, 0.35, 0.8])
TRUTH = np.array([False, False, True, True])


def test_curves_match_values_printed_by_scikit_learn() -> None:
    # The example of scikit-learn's manual: average_precision_score 0.8333,
    # roc_auc_score 0.75.
    levels = metrics.level_counts(SAID, TRUTH)
    assert metrics.pr_auc(*levels) == pytest.approx(5.0 / 6.0, abs=1e-15)
    assert metrics.roc_auc(*levels) == pytest.approx(0.75, abs=1e-15)


def drawn(seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Coarse scores, so that ties occur, which tell something."""
    rng = np.random.default_rng(seed)
    truth = rng.random(400) < 0.2
    said = np.round(np.clip(0.3 * truth + rng.random(400) * 0.7, 0.0, 1.0), 2)
    return said, truth


def test_roc_area_is_the_chance_to_rank_a_pair_rightly() -> None:
    said, truth = drawn()
    above = said[truth][:, None] > said[~truth]
    equal = said[truth][:, None] == said[~truth]
    chance = np.mean(above + 0.5 * equal)
    area = metrics.roc_auc(*metrics.level_counts(said, truth))
    assert area == pytest.approx(chance, abs=1e-12)


def test_precision_recall_area_is_mean_precision_over_positives() -> None:
    said, truth = drawn()
    precisions = [np.mean(truth[said >= level]) for level in said[truth]]
    area = metrics.pr_auc(*metrics.level_counts(said, truth))
    assert area == pytest.approx(np.mean(precisions), abs=1e-12)


def test_bins_are_fine_enough() -> None:
    rng = np.random.default_rng(1)
    truth = rng.random(20_000) < 0.1
    said = 1.0 / (1.0 + np.exp(-(rng.normal(size=20_000) + 3.0 * truth - 2.0)))
    edges = metrics.bin_edges(said, truth)
    for area in (metrics.pr_auc, metrics.roc_auc):
        exact = area(*metrics.level_counts(said, truth))
        binned = area(*metrics.binned_counts(said, truth, edges))
        # A bin holds at most 0.1 % of each class.
        assert binned == pytest.approx(exact, abs=1e-3)


def test_bins_follow_a_monotone_change_of_the_score() -> None:
    said, truth = drawn()
    changed = 1.0 - 1e-9 * (1.0 - said) ** 3
    counts = [
        metrics.binned_counts(one, truth, metrics.bin_edges(one, truth))
        for one in (said, changed)
    ]
    np.testing.assert_array_equal(counts[0], counts[1])


def test_a_batch_gives_what_its_members_give() -> None:
    edges = metrics.bin_edges(*drawn())
    sets = [metrics.binned_counts(*drawn(seed), edges) for seed in range(3)]
    positives, negatives = (np.array(part) for part in zip(*sets, strict=True))
    for area in (metrics.pr_auc, metrics.roc_auc):
        together = area(positives, negatives)
        np.testing.assert_array_equal(together, [area(*one) for one in sets])


def test_scores_without_a_class_are_undefined_not_wrong() -> None:
    said, truth = np.array([0.2, 0.7]), np.array([False, False])
    levels = metrics.level_counts(said, truth)
    assert math.isnan(metrics.pr_auc(*levels))
    assert math.isnan(metrics.roc_auc(*levels))
    scores = metrics.scores(metrics.confusion(said, truth, 0.5))
    assert math.isnan(scores["recall"])
    assert scores["accuracy"] == 0.5


def test_never_is_as_accurate_as_positives_are_rare() -> None:
    truth = np.arange(100) < 6
    scores = metrics.scores(metrics.confusion(np.zeros(100), truth, 0.5))
    assert scores["accuracy"] == scores["accuracy_of_never"] == 0.94
    assert scores["balanced_accuracy"] == 0.5
    assert scores["f1"] == 0.0


def test_confusion_counts_each_case() -> None:
    counts = metrics.confusion(SAID, TRUTH, 0.4)
    assert [float(c) for c in counts] == [1.0, 1.0, 1.0, 1.0]
    assert metrics.scores(counts)["f1"] == 0.5


def test_proper_scores_by_hand() -> None:
    said, truth = np.array([0.9, 0.2]), np.array([True, False])
    assert metrics.brier(said, truth) == pytest.approx((0.01 + 0.04) / 2.0, abs=1e-15)
    expected = -(math.log(0.9) + math.log(0.8)) / 2.0
    assert metrics.log_loss(said, truth) == pytest.approx(expected, abs=1e-15)


def test_certain_and_wrong_costs_much_but_not_everything() -> None:
    loss = metrics.log_loss(np.array([0.0]), np.array([True]))
    assert 20.0 < loss < 30.0


def test_calibration_of_honest_probabilities_is_near_the_diagonal() -> None:
    rng = np.random.default_rng(0)
    said = rng.random(100_000)
    bins = metrics.calibration(said, rng.random(100_000) < said)
    assert len(bins) == 10
    assert sum(b.num_samples for b in bins) == 100_000
    # 10,000 samples a bin: standard error of a share is at most 0.005.
    assert metrics.calibration_error(bins) < 0.01
    off = metrics.calibration(said, rng.random(100_000) < said**2)
    assert metrics.calibration_error(off) > 0.1


def test_balanced_counts_weigh_each_class_by_half() -> None:
    counts = metrics.Confusion(*(np.array(n) for n in (8.0, 10.0, 2.0, 90.0)))
    found = metrics.scores(metrics.balanced(counts))
    assert found["prevalence"] == pytest.approx(0.5)
    assert found["accuracy"] == pytest.approx((0.8 + 0.9) / 2.0)
    assert found["precision"] == pytest.approx(0.8 / 0.9)
    assert found["f1"] == pytest.approx(2.0 * 0.8 / (2.0 * 0.8 + 0.1 + 0.2))


def test_balanced_levels_give_what_repeated_positives_give() -> None:
    said, truth = drawn()
    rare, times = said[truth], (~truth).sum()
    repeated = np.concatenate(
        [np.repeat(rare, times), np.repeat(said[~truth], len(rare))]
    )
    kinds = np.arange(len(repeated)) < len(rare) * times
    levels = metrics.balanced_levels(*metrics.level_counts(said, truth))
    expected = metrics.pr_auc(*metrics.level_counts(repeated, kinds))
    assert metrics.pr_auc(*levels) == pytest.approx(expected, abs=1e-12)


def test_even_odds_divide_by_the_prevalence() -> None:
    said = np.array([0.0, 0.1, 0.5, 1.0])
    turned = metrics.with_even_odds(said, 0.1)
    assert turned == pytest.approx([0.0, 0.5, 0.9, 1.0])
    assert metrics.with_even_odds(said, 0.5) == pytest.approx(said)


def test_curves_end_at_all_positives() -> None:
    said, truth = drawn()
    levels = metrics.level_counts(said, truth)
    recall, precision = metrics.pr_curve(*levels)
    assert recall[-1] == 1.0
    assert precision[-1] == pytest.approx(truth.mean())
    false, true = metrics.roc_curve(*levels)
    assert (false[-1], true[-1]) == (1.0, 1.0)
    area = np.trapezoid(np.append(0.0, true), np.append(0.0, false))
    assert area == pytest.approx(metrics.roc_auc(*levels), abs=1e-12)
