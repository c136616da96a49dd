"""Fit of the support vector machine: columns, kernel and filter by validation drivers.

A machine is fitted on as many windows before a crossing as others, drawn from the
training drivers; Platt's logistic and the prior come from windows of these drivers that
the machine has not seen, at natural shares.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import SVC

from costeer.intention.features import full_windows
from costeer.intention.predictors.logistic import standardised
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.summary import summary_names
from costeer.intention.predictors.support_vectors import (
    SupportVectorWeights,
    decision_values,
    filtered,
    platt_logits,
)
from costeer.intention.predictors.variants import held_head, signals_of
from costeer.training.predictors.logit import fit_logit, logit_loss
from costeer.training.predictors.samples import (
    Answers,
    FeatureScaling,
    Table,
    columns_of,
    number_scaling,
    with_columns,
)
from costeer.training.recordings import Recording

COLUMNS: dict[str, tuple[str, ...]] = {
    "paper": (
        "distance_to_adjacent_lane last",
        "approach_velocity mean_half",
        "yaw_angle last",
        "yaw_angle slope",
        "steering_wheel_angle last",
        "steering_wheel_angle slope",
    ),
    "long": (
        "distance_to_adjacent_lane last",
        "distance_after_one_and_a_half last",
        "distance_after_three last",
        "inverse_line_time last",
        "approach_velocity last",
        "approach_velocity mean_half",
        "approach_velocity mean",
        "approach_velocity slope",
        "yaw_angle slope",
        "longitudinal_velocity mean",
        "longitudinal_acceleration mean_one",
        "steering_wheel_angle last",
        "steering_wheel_angle mean_half",
        "turning mean_one",
        "turning lowest",
        "turning highest",
        "head_yaw mean_one",
        "head_yaw mean",
        "head_yaw lowest",
        "head_yaw highest",
    ),
}
"""Lists of columns to choose from: those of the paper, and a longer one."""


class MachineParameters(NamedTuple):
    """What is fitted and what the validation drivers choose from.

    Attributes:
        variants: Keys of `features.VARIANTS` [-]. Source: assumed, with driver and
            without.
        num_trial_windows: Windows of the machines that are only compared [-]. Source:
            assumed, for time.
        num_windows: Windows of the machine that is kept [-]. Source: assumed, what
            fits on two cores in seconds.
        num_vectors: Most support vectors of the machine that is kept; it is fitted on
            fewer windows if there are more [-]. Source: assumed, keeps the file small.
        num_calibration_windows: Most windows for Platt's logistic, and of validation
            drivers [-]. Source: assumed.
        penalties: C of the machine [-]. Source: assumed; 1 was worse on simulated
            drivers with the longer list.
        widths: γ of the kernel times the number of columns [-]. Source: assumed, around
            scikit-learn's default of 1.
        evidence_shares: Of the Bayesian filter, 0 for none [-]. Source: assumed; 1 is
            the filter of the paper.
    """

    variants: tuple[str, ...] = ("full", "motion")
    num_trial_windows: int = 2500
    num_windows: int = 6000
    num_vectors: int = 1500
    num_calibration_windows: int = 15000
    penalties: tuple[float, ...] = (10.0, 100.0)
    widths: tuple[float, ...] = (0.03, 0.1, 0.3)
    evidence_shares: tuple[float, ...] = (0.0, 0.03, 0.1, 0.3, 1.0)


DEFAULTS = MachineParameters()


class Candidate(NamedTuple):
    """Settings of one machine.

    Attributes:
        columns: Name of the list of columns.
        penalty: C [-].
        width: γ times the number of columns [-].
    """

    columns: str
    penalty: float
    width: float


class Material(NamedTuple):
    """Windows of one variant and one list of columns.

    Attributes:
        signals: Of the variant.
        columns: Places in `summary_names(signals)`, `(column,)`.
        training: Windows of the training drivers.
        calibration: Others of theirs.
        validation: Of the validation drivers.
    """

    signals: tuple[str, ...]
    columns: NDArray[np.int64]
    training: Table
    calibration: Table
    validation: Table


def fit_machines(
    training: Table,
    validation: Table,
    scaling: FeatureScaling,
    recordings: Sequence[Recording],
    seed: int,
    parameters: MachineParameters = DEFAULTS,
) -> Baseline:
    """Fit all variants that the recordings have the signals for.

    Args:
        training: `samples.summary_table` of the training drivers.
        validation: Of the validation drivers.
        scaling: By which both were made.
        recordings: Of the validation drivers, for the filter.
        seed: Of the draw of windows.
        parameters: What to choose from.
    """
    variants: dict[str, SupportVectorWeights] = {}
    facts = {}
    for variant in parameters.variants:
        signals = signals_of(variant)
        places = columns_of(signals)
        seen = with_columns(training, places)
        unseen = with_columns(validation, places)
        if not (seen.answers.positive.any() and unseen.answers.positive.any()):
            continue
        rng = np.random.default_rng([seed, 3])
        material = {
            name: _material(parameters, signals, name, seen, unseen, rng)
            for name in COLUMNS
        }
        found, looked = _chosen(material, scaling, parameters)
        variants[variant], shares = with_filter(parameters, found, signals, recordings)
        facts[variant] = {"validation_log_loss": looked, "filter_log_loss": shares}
    return Baseline(variants, facts)


def _material(
    parameters: MachineParameters,
    signals: tuple[str, ...],
    columns: str,
    training: Table,
    validation: Table,
    rng: np.random.Generator,
) -> Material:
    """Windows for the machine, for Platt's logistic and for the choice."""
    names = summary_names(signals)
    places = np.array([names.index(n) for n in COLUMNS[columns] if n in names])
    order = rng.permutation(len(training.numbers))
    most = min(parameters.num_calibration_windows, len(order) // 2)
    checked = rng.permutation(len(validation.numbers))
    return Material(
        signals=signals,
        columns=places,
        training=_rows(training, order[most:], places),
        calibration=_rows(training, order[:most], places),
        validation=_rows(
            validation, checked[: parameters.num_calibration_windows], places
        ),
    )


def _rows(data: Table, rows: NDArray[np.int64], places: NDArray[np.int64]) -> Table:
    answers = Answers(data.answers.positive[rows], data.answers.weight[rows])
    return Table(data.numbers[np.ix_(rows, places)], answers)


def balanced_rows(answers: Answers, num_windows: int) -> NDArray[np.int64]:
    """The first windows of each kind, half of them before a crossing if there are."""
    half = num_windows // 2
    before = np.flatnonzero(answers.positive)[:half]
    other = np.flatnonzero(~answers.positive)[: num_windows - len(before)]
    return np.sort(np.concatenate([before, other]))


def _chosen(
    material: dict[str, Material],
    scaling: FeatureScaling,
    parameters: MachineParameters,
) -> tuple[SupportVectorWeights, dict[str, float]]:
    """The settings that suit the validation drivers, fitted on more windows."""
    grid = itertools.product(COLUMNS, parameters.penalties, parameters.widths)
    losses: dict[Candidate, float] = {}
    for one in itertools.starmap(Candidate, grid):
        data = material[one.columns]
        machine = fit_machine(data, scaling, one, parameters.num_trial_windows)
        losses[one] = _loss(machine, data.validation)
    best = min(losses, key=lambda candidate: losses[candidate])
    num_windows = parameters.num_windows
    machine = fit_machine(material[best.columns], scaling, best, num_windows)
    while machine.dual.size > parameters.num_vectors:
        share = parameters.num_vectors / machine.dual.size
        num_windows = int(0.95 * share * num_windows)
        machine = fit_machine(material[best.columns], scaling, best, num_windows)
    return machine, {
        f"{one.columns} columns, C = {one.penalty:g}, width {one.width:g}": loss
        for one, loss in losses.items()
    }


def fit_machine(
    data: Material, scaling: FeatureScaling, settings: Candidate, num_windows: int
) -> SupportVectorWeights:
    """One machine with Platt's logistic, without a filter."""
    rows = balanced_rows(data.training.answers, num_windows)
    mean, scale = number_scaling(data.training.numbers, data.training.answers.weight)
    # Support vectors are kept in single precision, so they are fitted in it.
    numbers = standardised(data.training.numbers[rows], mean, scale)
    numbers = numbers.astype(np.float32).astype(np.float64)
    width = settings.width / len(data.columns)
    model = SVC(C=settings.penalty, gamma=width)
    model.fit(numbers, data.training.answers.positive[rows])
    machine = SupportVectorWeights(
        feature_mean=scaling.mean,
        feature_scale=scaling.scale,
        columns=data.columns,
        summary_mean=mean,
        summary_scale=scale,
        vectors=np.asarray(model.support_vectors_, np.float32),
        dual=np.asarray(model.dual_coef_[0]),
        bias=np.asarray(model.intercept_),
        width=np.array([width]),
        platt=np.array([0.0, 1.0]),
        filter=np.array([prior_logit(data.calibration.answers), 0.0]),
    )
    decided = _decided(machine, data.calibration)
    fit = fit_logit(decided[:, None], data.calibration.answers)
    platt = np.array([fit.intercept, *fit.coefficients])
    return SupportVectorWeights(**{**machine._asdict(), "platt": platt})


def prior_logit(answers: Answers) -> float:
    """Logit of the natural share of windows before a crossing [-]."""
    share = np.average(answers.positive, weights=answers.weight)
    return float(np.log(share / (1.0 - share)))


def _decided(machine: SupportVectorWeights, data: Table) -> NDArray[np.float64]:
    numbers = standardised(data.numbers, machine.summary_mean, machine.summary_scale)
    return decision_values(machine, numbers)


def _loss(machine: SupportVectorWeights, data: Table) -> float:
    logit = machine.platt[0] + machine.platt[1] * _decided(machine, data)
    return logit_loss(logit, data.answers)


def with_filter(
    parameters: MachineParameters,
    machine: SupportVectorWeights,
    signals: tuple[str, ...],
    recordings: Sequence[Recording],
) -> tuple[SupportVectorWeights, dict[str, float]]:
    """The machine with the filter that suits the validation drivers."""
    runs = [
        (platt_logits(machine, signals, held_head(one.features)[0]), one)
        for one in recordings
        if not set(signals) & set(one.absent)
    ]
    losses = {
        share: float(np.mean([_filter_loss(machine, share, *run) for run in runs]))
        for share in parameters.evidence_shares
    }
    best = min(losses, key=lambda share: losses[share])
    settings = np.array([machine.filter[0], best])
    chosen = SupportVectorWeights(**{**machine._asdict(), "filter": settings})
    return chosen, {f"share {share:g}": loss for share, loss in losses.items()}


def _filter_loss(
    machine: SupportVectorWeights,
    share: float,
    logit: NDArray[np.float64],
    recording: Recording,
) -> float:
    """Log loss of the filtered verdicts on one recording [nat]."""
    said = filtered(logit, float(machine.filter[0]), share)
    rows = full_windows(recording.features, recording.absent) & recording.labels.known
    truth = recording.labels.positive[rows]
    return logit_loss(said[rows], Answers(truth, np.ones(len(truth))))
