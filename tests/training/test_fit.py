"""Training learns what there is to learn, and nothing where there is nothing."""

from __future__ import annotations

from functools import partial

import jax.numpy as jnp
import numpy as np
import pytest

from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    NUM_SCALED,
    VARIANTS,
    hide,
    network_inputs,
)
from costeer.intention.gru import (
    NetworkWeights,
    crossing_probability,
    hidden_size,
)
from costeer.intention.predictors.gru import our_probabilities
from costeer.training.augmentation import (
    ALL_SIGNALS,
    AugmentationParameters,
    dispensable,
)
from costeer.training.dataset import DatasetParameters, Windows, windows
from costeer.training.evaluate import judged_samples, sample_scores, verdicts
from costeer.training.fit import (
    CurvePoint,
    Fit,
    FitParameters,
    fit,
    trained_variants,
)
from costeer.training.network import initial_weights, logits, network_weights
from costeer.training.recordings import Recording, lacking
from costeer.training.scaling import Scaling, scaling
from costeer.training.train import TrainingParameters, chosen_size, train
from tests.training.synthetic import drive, drives

TINY = FitParameters(
    batch_size=64,
    learning_rate=0.02,
    num_steps=120,
    steps_per_check=60,
    augmentation=ALL_SIGNALS,
)
PLAIN = Scaling(
    mean=np.zeros(NUM_SCALED),
    scale=np.ones(NUM_SCALED),
    dispensable=np.ones(NUM_FEATURES),
)


def data_of(
    recordings: list[Recording], augmentation: AugmentationParameters = ALL_SIGNALS
) -> tuple[Windows, Scaling]:
    scale = scaling(recordings, dispensable(augmentation))
    return windows(recordings, DatasetParameters()), scale


def area(weights: NetworkWeights, absent: tuple[str, ...] = ()) -> float:
    """Under the precision-recall curve of two more drives."""
    judged = [lacking(drive(driver), absent) for driver in (30, 31)]
    drivers = verdicts(partial(our_probabilities, weights), judged)
    return sample_scores(*judged_samples(drivers), 0.5)["pr_auc"]


@pytest.mark.slow
def test_the_trained_network_is_the_reference_network() -> None:
    start = initial_weights(5, 0.1, seed=3)
    start = start._replace(hidden_bias=start.hidden_bias + 0.3)
    rng = np.random.default_rng(0)
    window = rng.normal(size=(7, 180, 6))
    network = network_weights(start, PLAIN)
    for absent in VARIANTS.values():
        reference = crossing_probability(network, window, absent=absent)
        inputs = network_inputs(hide(window, absent), PLAIN.mean, PLAIN.scale)
        logit = np.asarray(logits(start, jnp.asarray(inputs, jnp.float32)))
        # JAX computes in float32 here.
        np.testing.assert_allclose(1.0 / (1.0 + np.exp(-logit)), reference, atol=2e-6)


def test_the_first_answer_is_about_the_prevalence() -> None:
    start = initial_weights(16, 0.06, seed=1)
    network = network_weights(start, PLAIN)
    assert 0.02 < crossing_probability(network, np.zeros((180, 6))) < 0.16


@pytest.fixture(scope="module")
def learned() -> Fit:
    data, scale = data_of(drives(6))
    return fit(data, scale, [drive(20)], hidden=8, seed=1, parameters=TINY)


@pytest.mark.slow
def test_a_separable_problem_is_learned(learned: Fit) -> None:
    # The edge 3 s before a crossing is a matter of tenths of a second; 120 steps do not
    # learn those. Blind guesses have the prevalence, 0.13, as their area.
    assert area(learned.weights) > 0.8
    assert hidden_size(learned.weights) == 8


@pytest.mark.slow
def test_the_curve_holds_each_look_and_the_best_is_kept(learned: Fit) -> None:
    assert [point.step for point in learned.curve] == [60, 120]
    lowest = min(point.validation_log_loss for point in learned.curve)
    assert learned.best.validation_log_loss == lowest


@pytest.mark.slow  # a training of its own
def test_shuffled_labels_teach_nothing() -> None:
    data, scale = data_of(drives(6))
    order = np.random.default_rng(0).permutation(len(data.ends))
    shuffled = data._replace(positive=data.positive[order], weight=data.weight[order])
    fitted = fit(shuffled, scale, [drive(20)], hidden=8, seed=1, parameters=TINY)
    # The few thousand windows overlap, so chance alone leaves some order.
    assert area(fitted.weights) < 0.5


@pytest.mark.slow
def test_a_network_that_saw_all_signals_needs_them(learned: Fit) -> None:
    assert not learned.weights.dispensable.any()
    assert np.isnan(
        our_probabilities(learned.weights, drive(30).features, ("head_yaw",))
    ).all()
    assert list(learned.best.pr_auc) == ["full"]
    assert learned.best.pr_auc["full"] == learned.best.validation_pr_auc


@pytest.fixture(scope="module")
def learned_without() -> Fit:
    """Taught with signals hidden by lot."""
    augmentation = AugmentationParameters()
    data, scale = data_of(drives(6), augmentation)
    tiny = TINY._replace(augmentation=augmentation, num_steps=240)
    return fit(data, scale, [drive(20)], hidden=8, seed=1, parameters=tiny)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.slow  # a training of its own
def test_a_network_that_missed_signals_does_without(
    variant: str, learned_without: Fit
) -> None:
    # Blind guesses have the prevalence, 0.13. Of the head alone the moment is known by
    # a glance 2 s before, not its end.
    assert area(learned_without.weights, VARIANTS[variant]) > 0.5


@pytest.mark.slow  # a training of its own
def test_the_curve_tells_of_each_variant(learned_without: Fit) -> None:
    for point in learned_without.curve:
        assert list(point.pr_auc) == list(VARIANTS)
        assert point.validation_pr_auc == point.pr_auc["full"]
    needed = [
        name
        for name, can_go in zip(
            FEATURES, learned_without.weights.dispensable, strict=True
        )
        if not can_go
    ]
    assert needed == ["longitudinal_velocity"]


def test_only_variants_with_a_share_are_trained() -> None:
    assert trained_variants(ALL_SIGNALS) == ["full"]
    assert trained_variants(AugmentationParameters()) == list(VARIANTS)
    some = ALL_SIGNALS._replace(head=0.5)
    assert trained_variants(some) == ["full", "head"]


@pytest.mark.slow
def test_the_same_seed_gives_the_same_weights() -> None:
    data, scale = data_of(drives(3, num_changes=1))
    short = TINY._replace(num_steps=5, steps_per_check=5)
    first, second, other = (
        fit(data, scale, [drive(9)], hidden=4, seed=seed, parameters=short).weights
        for seed in (1, 1, 2)
    )
    for one, two in zip(first, second, strict=True):
        np.testing.assert_array_equal(one, two)
    assert (first.hidden_weights != other.hidden_weights).any()


@pytest.mark.slow
def test_training_stops_when_nothing_gets_better() -> None:
    data, scale = data_of(drives(3, num_changes=1))
    wild = FitParameters(
        batch_size=16,
        learning_rate=1.0,
        num_steps=200,
        steps_per_check=2,
        patience=2,
        augmentation=ALL_SIGNALS,
    )
    fitted = fit(data, scale, [drive(9)], hidden=4, seed=1, parameters=wild)
    assert fitted.curve[-1].step < 200
    best = [p.step for p in fitted.curve].index(fitted.best.step)
    assert len(fitted.curve) - 1 - best == 2


def fitted_with(area: float) -> Fit:
    point = CurvePoint(1, 0.0, 0.0, area, {"full": area})
    network = network_weights(initial_weights(2, 0.1, 1), PLAIN)
    return Fit(weights=network, best=point, curve=[point])


def test_the_smallest_size_near_the_best_is_chosen() -> None:
    fits = {8: fitted_with(0.90), 16: fitted_with(0.946), 32: fitted_with(0.95)}
    assert chosen_size(fits, tolerance=0.005) == 16
    assert chosen_size(fits, tolerance=0.0) == 32
    assert chosen_size(fits, tolerance=0.1) == 8


@pytest.mark.slow  # a training of its own
def test_facts_tell_where_a_network_comes_from() -> None:
    parameters = TrainingParameters(
        hidden_sizes=(2, 4), fit=TINY._replace(num_steps=4, steps_per_check=2)
    )
    done: list[int] = []
    recordings = drives(5, num_changes=1)
    network = train(recordings, 1, parameters, "five drives", done.append)
    assert sum(done) == 8
    assert network.facts["source"] == "five drives"
    assert set(network.facts["curves"]) == {"2", "4"}
    drivers = network.facts["drivers"]
    assert sum(len(names) for names in drivers.values()) == 5
    assert network.facts["test"]["num_drivers"] == len(drivers["test"]) == 1
