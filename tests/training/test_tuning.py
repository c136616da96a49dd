"""A network goes on learning from a few recordings."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.predictors.gru import our_probabilities
from costeer.training.dataset import DatasetParameters, split_by_driver
from costeer.training.fit import FitParameters
from costeer.training.metrics import log_loss
from costeer.training.network import network_weights, trained_weights
from costeer.training.predictors.paper_gru import fit_paper_network, signals_only
from costeer.training.recordings import lacking
from costeer.training.scaling import Scaling
from costeer.training.tuning import DEFAULTS, fine_tuned
from costeer.training.verdicts import judged_samples, verdicts
from tests.training.synthetic import drive, drives

FEW = DEFAULTS._replace(batch_size=64, learning_rate=0.02, num_steps=60)
START = random_weights(6, seed=1)


def same(one: NetworkWeights, other: NetworkWeights) -> bool:
    pairs = zip(one, other, strict=True)
    return all(np.array_equal(a, b) for a, b in pairs)


def test_there_and_back_is_the_same_network() -> None:
    scale = Scaling(START.feature_mean, START.feature_scale, START.dispensable)
    assert same(network_weights(trained_weights(START), scale), START)


@pytest.mark.slow
def test_no_step_changes_nothing_but_the_first() -> None:
    still = FEW._replace(learning_rate=0.0, num_steps=1)
    assert same(fine_tuned(START, drives(3), 1, still), START)


@pytest.mark.slow
def test_it_learns_from_the_recordings_and_keeps_its_scaling() -> None:
    unseen = [drive(30), drive(31)]
    tuned = fine_tuned(START, drives(6), 1, FEW)
    before, after = (
        log_loss(*judged_samples(verdicts(partial(our_probabilities, one), unseen)))
        for one in (START, tuned)
    )
    # Blind guesses at the prevalence of 0.13 cost 0.39 nat; these weights start worse.
    assert after < 0.8 * before
    np.testing.assert_array_equal(tuned.feature_mean, START.feature_mean)


@pytest.mark.slow  # a training of its own
def test_what_the_recordings_lack_stays_hidden() -> None:
    blind = [lacking(one, ("head_yaw",)) for one in drives(3, num_changes=2)]
    spoilt = [
        one._replace(features=one.features + 5.0 * (np.arange(6) == 0)) for one in blind
    ]
    assert same(fine_tuned(START, blind, 1, FEW), fine_tuned(START, spoilt, 1, FEW))


def test_recordings_without_a_lane_change_teach_nothing() -> None:
    with pytest.raises(ValueError, match="hold 0 that precede a crossing"):
        fine_tuned(START, drives(2, num_changes=0), 1, FEW)


@pytest.mark.slow  # a training of its own
def test_the_papers_network_sees_the_six_signals_only() -> None:
    split = split_by_driver(drives(5, num_changes=2), 1, DatasetParameters())
    tiny = FitParameters(batch_size=32, num_steps=4, steps_per_check=4)
    tiny = tiny._replace(augmentation=DEFAULTS.augmentation)
    network = fit_paper_network(split, 1, None, tiny, hidden=3).variants["full"]
    assert not network.input_weights[:, :, 6:].any()
    assert not network.dispensable.any()
    assert network.input_weights[:, :, :6].any()
    assert same(signals_only(network), network)
