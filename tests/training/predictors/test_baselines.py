"""All fits in one go: names, facts, and the same numbers for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.gru import random_weights
from costeer.intention.predictors.registry import fitted_predictor
from costeer.intention.predictors.store import baselines_hash
from costeer.training.dataset import Split
from costeer.training.predictors import baselines
from costeer.training.predictors.baselines import (
    FITTED,
    train_baselines,
    with_paper_network,
)
from costeer.training.predictors.crossing_time import (
    CrossingTimeParameters,
    initial_cells,
)
from costeer.training.predictors.descent import DescentParameters
from costeer.training.predictors.head_only import HeadParameters
from costeer.training.predictors.judge import predictor_scores
from costeer.training.predictors.line_time import LineTimeParameters
from costeer.training.predictors.logistic import LogisticParameters
from costeer.training.predictors.support_vectors import MachineParameters
from tests.training.synthetic import drives

SHORT = DescentParameters(
    batch_size=32, learning_rate=0.02, num_steps=30, steps_per_check=30
)
TINY = baselines.BaselineParameters(
    num_windows=500,
    line_time=LineTimeParameters(time_constants=(0.1,)),
    logistic=LogisticParameters(variants=("full", "head"), penalty_inverses=(0.1,)),
    machine=MachineParameters(
        variants=("motion",),
        num_trial_windows=60,
        num_windows=100,
        num_vectors=30,
        penalties=(1.0,),
        widths=(0.2,),
        evidence_shares=(0.0,),
    ),
    head=HeadParameters(hidden_sizes=(3,), descent=SHORT),
    crossing_time=CrossingTimeParameters(
        variants=("motion",), hidden_size=2, horizons=(5.0,), descent=SHORT
    ),
)
FEW = SHORT._replace(num_steps=2, steps_per_check=2)
SHORTER = TINY._replace(
    head=TINY.head._replace(descent=FEW),
)
RECORDINGS = drives(5, num_changes=1)
SPLIT = Split(RECORDINGS[:3], RECORDINGS[3:4], RECORDINGS[4:])


@pytest.mark.slow
def test_all_are_fitted_with_their_facts() -> None:
    done: list[int] = []
    found = train_baselines(SPLIT, 1, done.append, parameters=TINY)
    assert tuple(found) == FITTED
    assert done == [1] * len(FITTED)
    for one in found.values():
        assert one.facts["seed"] == 1
        assert one.facts["drivers"]["test"] == ["driver 4"]
        for scores in one.facts["validation"].values():
            assert scores["pr_auc"] > 0.1
    assert found["support-vectors"].variants["motion"].dual.size <= 30


@pytest.mark.slow  # three rounds of fits
def test_the_same_seed_gives_the_same_numbers() -> None:
    # The LSTM goes down the same way as the head's network, and takes longer.
    drawn = ("support-vectors", "head-only")
    first, again = (
        train_baselines(SPLIT, 1, names=drawn, parameters=SHORTER) for _ in range(2)
    )
    for one, two in zip(initial_cells(3, 2, 1), initial_cells(3, 2, 1), strict=True):
        np.testing.assert_array_equal(one, two)
    assert baselines_hash(again) == baselines_hash(first)
    other = train_baselines(SPLIT, 2, names=("head-only",), parameters=SHORTER)
    assert baselines_hash(other) != baselines_hash({"head-only": first["head-only"]})


def test_a_few_can_be_fitted_alone() -> None:
    found = train_baselines(SPLIT, 1, names=("line-time",), parameters=TINY)
    assert tuple(found) == ("line-time",)
    with pytest.raises(ValueError, match="'paper-gru' is none of the fits line-time"):
        train_baselines(SPLIT, 1, names=("paper-gru",), parameters=TINY)


@pytest.mark.slow
def test_the_papers_network_joins_the_others() -> None:
    weights = random_weights(3, seed=1)
    found = with_paper_network({}, weights, {"source": "thin air"})
    one = fitted_predictor("paper-gru", found["paper-gru"])
    said = one.probabilities(RECORDINGS[0].features, ())
    assert np.isfinite(said[179:]).all()


def test_a_predictor_that_says_nothing_has_no_scores() -> None:
    network = with_paper_network({}, random_weights(3, seed=1), {})["paper-gru"]
    silent = [one._replace(absent=("head_yaw",)) for one in RECORDINGS[:1]]
    assert predictor_scores(fitted_predictor("paper-gru", network), silent) == {}
