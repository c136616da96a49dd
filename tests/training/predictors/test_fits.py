"""Fits agree with the libraries that made them, and find what there is."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression
from sklearn.svm import SVC

from costeer.intention.features import VARIANTS
from costeer.intention.predictors.crossing_time import (
    crossing_probabilities,
    estimated_times,
    step_rows,
)
from costeer.intention.predictors.logistic import standardised
from costeer.intention.predictors.registry import fitted_predictor
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.variants import signals_of
from costeer.training.dataset import DatasetParameters, Split
from costeer.training.predictors.crossing_time import (
    Cells,
    CrossingTimeParameters,
    crossing_windows,
    fit_crossing_time,
    share_logits,
)
from costeer.training.predictors.descent import DescentParameters, descend
from costeer.training.predictors.line_time import fit_line_time
from costeer.training.predictors.logistic import LogisticParameters, fit_logistic
from costeer.training.predictors.logit import logit_loss
from costeer.training.predictors.samples import (
    Answers,
    Table,
    chosen_rows,
    columns_of,
    feature_scaling,
    summary_table,
    with_columns,
)
from costeer.training.predictors.support_vectors import (
    Candidate,
    MachineParameters,
    Material,
    balanced_rows,
    fit_machine,
    with_filter,
)
from tests.intention.predictors.made import crossing_time, features, machine
from tests.training.synthetic import drives

DATASET = DatasetParameters()
RECORDINGS = drives(6, num_changes=2)
SPLIT = Split(RECORDINGS[:4], RECORDINGS[4:], [])
SCALING = feature_scaling(SPLIT.training)


@pytest.fixture(scope="module")
def tables() -> tuple[Table, Table]:
    training, validation = (summary_table(part, SCALING, DATASET) for part in SPLIT[:2])
    return training, validation


@pytest.mark.slow
def test_logistic_regression_is_that_of_scikit_learn(
    tables: tuple[Table, Table],
) -> None:
    parameters = LogisticParameters(penalty_inverses=(0.1,))
    fitted = fit_logistic(*tables, SCALING, parameters)
    assert set(fitted.variants) == set(VARIANTS)
    weights = fitted.variants["no-head"]
    data = with_columns(tables[0], columns_of(signals_of("no-head")))
    numbers = standardised(data.numbers, weights.summary_mean, weights.summary_scale)
    model = LogisticRegression(C=0.1, solver="newton-cholesky")
    model.fit(numbers, data.answers.positive, sample_weight=data.answers.weight)
    drive = SPLIT.training[0]
    rows, _ = chosen_rows(drive, DATASET)
    one = fitted_predictor("logistic", Baseline({"no-head": weights}, {}))
    said = one.probabilities(drive.features, ())[rows]
    expected = model.predict_proba(numbers[: len(rows)])[:, 1]
    np.testing.assert_allclose(said, expected, atol=1e-9)


def test_the_machine_is_that_of_scikit_learn(tables: tuple[Table, Table]) -> None:
    signals = signals_of("motion")
    columns = np.array([4, 9, 30, 41])
    training, validation = (with_columns(part, columns_of(signals)) for part in tables)
    training, validation = (
        Table(part.numbers[:, columns], part.answers) for part in (training, validation)
    )
    data = Material(signals, columns, training, validation, validation)
    fitted = fit_machine(data, SCALING, Candidate("paper", 2.0, 0.8), 200)
    rows = balanced_rows(training.answers, 200)
    assert training.answers.positive[rows].sum() == 100
    numbers = standardised(training.numbers, fitted.summary_mean, fitted.summary_scale)
    model = SVC(C=2.0, gamma=0.2).fit(numbers[rows], training.answers.positive[rows])
    drive = SPLIT.training[0]
    ends, _ = chosen_rows(drive, DATASET)
    one = fitted_predictor("support-vectors", Baseline({"motion": fitted}, {}))
    said = one.probabilities(drive.features, ())[ends]
    decided = model.decision_function(numbers[: len(ends)])
    logit = fitted.platt[0] + fitted.platt[1] * decided
    # Support vectors are kept in single precision.
    np.testing.assert_allclose(said, 1.0 / (1.0 + np.exp(-logit)), atol=1e-6)


def test_the_filter_is_taken_if_it_helps(tables: tuple[Table, Table]) -> None:
    parameters = MachineParameters(evidence_shares=(0.0, 0.1))
    chosen, losses = with_filter(
        parameters, machine("motion"), signals_of("motion"), SPLIT.validation
    )
    assert list(losses) == ["share 0", "share 0.1"]
    best = min(losses, key=lambda name: losses[name])
    assert best == f"share {chosen.filter[1]:g}"


def test_the_recurrent_network_is_that_of_jax() -> None:
    weights = crossing_time("full")
    rng = np.random.default_rng(0)
    inputs = rng.normal(0.0, 5.0, size=(400, 7))
    ends = np.array([179, 200, 399])
    cells = Cells(*(getattr(weights, name) for name in Cells._fields))
    scaled = (inputs / weights.input_scale)[step_rows(ends)]
    logit = np.asarray(share_logits(cells, jnp.asarray(scaled, jnp.float32)))
    expected = 5.0 / (1.0 + np.exp(-logit))
    time = estimated_times(weights, inputs, ends)
    np.testing.assert_allclose(time, expected, atol=1e-5)


def test_a_shorter_time_is_a_likelier_crossing() -> None:
    weights = crossing_time("full")
    said = crossing_probabilities({"full": weights}, features(250, 1))[179:]
    slower = weights._replace(output_bias=weights.output_bias + 1.0)
    later = crossing_probabilities({"full": slower}, features(250, 1))[179:]
    assert (later < said).all()


@pytest.mark.slow  # a training of its own
def test_times_to_crossing_are_learned() -> None:
    parameters = CrossingTimeParameters(
        variants=("motion",),
        hidden_size=4,
        horizons=(5.0,),
        descent=DescentParameters(
            batch_size=64, learning_rate=0.03, num_steps=120, steps_per_check=60
        ),
    )
    fitted = fit_crossing_time(SPLIT, SCALING, DATASET, 1, parameters)
    weights = fitted.variants["motion"]
    data = crossing_windows(
        SPLIT.validation, signals_of("motion"), SCALING, DATASET, 5.0
    )
    time = estimated_times(weights, data.inputs, data.ends)
    error = time - np.minimum(data.time, 5.0)
    assert np.sqrt(np.mean(error**2)) < 0.6 * np.std(np.minimum(data.time, 5.0))
    assert weights.logistic[1] < 0.0


def test_windows_whose_time_is_not_known_are_left_out() -> None:
    data = crossing_windows(SPLIT.training, signals_of("full"), SCALING, DATASET, 10.0)
    # The synthetic drives end 14 to 18 s after the last change began.
    lengths = np.cumsum([len(one.features) for one in SPLIT.training])
    left = lengths[np.searchsorted(lengths, data.ends, side="right")] - data.ends
    assert (np.isfinite(data.time) | (left > 600)).all()
    blind = [one._replace(absent=("head_yaw",)) for one in SPLIT.training]
    with pytest.raises(ValueError, match="no recording has all of head_yaw"):
        crossing_windows(blind, ("head_yaw",), SCALING, DATASET, 5.0)


def test_the_time_to_the_line_is_fitted() -> None:
    fitted = fit_line_time(SPLIT, DATASET)
    weights = fitted.variants["motion"]
    assert weights.slope[0] < 0.0
    losses = fitted.facts["validation_log_loss"]
    assert losses[f"{weights.time_constant[0]:g} s"] == min(losses.values())


def test_descent_keeps_the_best_and_stops() -> None:
    # The judge likes the first look best, so it ends after the patience.
    looks = iter([1.0, 2.0, 2.0, 2.0])
    parameters = DescentParameters(num_steps=50, steps_per_check=2, patience=2)
    found = descend(
        lambda weights, batch: jnp.sum((weights - batch) ** 2),
        jnp.zeros(1),
        iter([(jnp.ones(1),)] * 50),
        lambda weights: next(looks),
        parameters,
    )
    assert [step for step, _ in found.curve] == [2, 4, 6]
    assert 0.0 < found.weights[0] < 0.02


def test_loss_of_a_logit() -> None:
    answers = Answers(np.array([True, False]), np.array([1.0, 3.0]))
    expected = (np.log1p(np.exp(-2.0)) + 3.0 * np.log(2.0)) / 4.0
    assert logit_loss(np.array([2.0, 0.0]), answers) == pytest.approx(expected)
