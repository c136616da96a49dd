"""The paper's network and ours differ in what they do without a signal."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from costeer.intention.features import FEATURES, HEAD_YAW
from costeer.intention.gru import random_weights
from costeer.intention.predictors.gru import our_probabilities, paper_probabilities
from costeer.intention.predictors.registry import predictor
from costeer.intention.weights import intention_network, save_weights
from tests.intention.predictors.made import features

WEIGHTS = random_weights(4, seed=1)


def test_a_lost_head_silences_the_papers_network_only() -> None:
    seen = features(500, 1)
    seen[200, HEAD_YAW] = np.nan
    paper, ours = paper_probabilities(WEIGHTS, seen), our_probabilities(WEIGHTS, seen)
    assert np.isnan(paper[200:380]).all()
    assert np.isfinite(ours[179:]).all()
    np.testing.assert_array_equal(paper[380:], ours[380:])


def test_our_network_does_without_what_it_was_fitted_to() -> None:
    seen = features(200, 2)
    assert np.isfinite(our_probabilities(WEIGHTS, seen, ("head_yaw",))[179:]).all()
    assert np.isnan(paper_probabilities(WEIGHTS, seen, ("head_yaw",))).all()
    needs_all = WEIGHTS._replace(dispensable=np.zeros(len(FEATURES)))
    assert np.isnan(our_probabilities(needs_all, seen, ("head_yaw",))).all()


def test_our_network_comes_from_a_file_of_weights(tmp_path: Path) -> None:
    path = tmp_path / "ours.npz"
    save_weights(path, intention_network(WEIGHTS, {}))
    seen = features(220, 3)
    one = predictor("gru", path)
    np.testing.assert_array_equal(
        one.probabilities(seen, ()), our_probabilities(WEIGHTS, seen)
    )
