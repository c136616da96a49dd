"""Fit of the logistic regression, a set of coefficients per variant of the signals."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from costeer.intention.predictors.logistic import LogisticWeights, standardised
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.variants import signals_of
from costeer.training.predictors.logit import fit_logit, logit_loss
from costeer.training.predictors.samples import (
    FeatureScaling,
    Table,
    columns_of,
    number_scaling,
    with_columns,
)


class LogisticParameters(NamedTuple):
    """What is fitted and what the validation drivers choose from.

    Attributes:
        variants: Keys of `features.VARIANTS` [-]. Source: assumed, all of them.
        penalty_inverses: C of the L2 penalty [-]. Source: assumed, from strong to
            hardly any at 10⁵ windows.
    """

    variants: tuple[str, ...] = (
        "full",
        "no-head",
        "no-wheel",
        "motion",
        "motion-without-place",
        "head",
    )
    penalty_inverses: tuple[float, ...] = (0.1, 1.0, 10.0)


DEFAULTS = LogisticParameters()


def fit_logistic(
    training: Table,
    validation: Table,
    scaling: FeatureScaling,
    parameters: LogisticParameters = DEFAULTS,
) -> Baseline:
    """Fit all variants that the recordings have the signals for.

    Args:
        training: `samples.summary_table` of the training drivers.
        validation: Of the validation drivers.
        scaling: By which both were made.
        parameters: What to choose from.
    """
    variants, facts = {}, {}
    for variant in parameters.variants:
        columns = columns_of(signals_of(variant))
        seen = with_columns(training, columns)
        unseen = with_columns(validation, columns)
        if seen.answers.positive.any() and unseen.answers.positive.any():
            fitted = _fit(seen, unseen, scaling, parameters)
            variants[variant], facts[variant] = fitted
    return Baseline(variants, {"validation_log_loss": facts})


def _fit(
    training: Table,
    validation: Table,
    scaling: FeatureScaling,
    parameters: LogisticParameters,
) -> tuple[LogisticWeights, dict[str, Any]]:
    """One variant with the penalty that suits the validation drivers."""
    mean, scale = number_scaling(training.numbers, training.answers.weight)
    numbers = standardised(training.numbers, mean, scale)
    unseen = standardised(validation.numbers, mean, scale)
    losses, fits = {}, {}
    for penalty in parameters.penalty_inverses:
        fits[penalty] = one = fit_logit(numbers, training.answers, penalty)
        logit = unseen @ one.coefficients + one.intercept
        losses[penalty] = logit_loss(logit, validation.answers)
    best = min(losses, key=lambda penalty: losses[penalty])
    weights = LogisticWeights(
        feature_mean=scaling.mean,
        feature_scale=scaling.scale,
        summary_mean=mean,
        summary_scale=scale,
        coefficients=fits[best].coefficients,
        intercept=np.array([fits[best].intercept]),
    )
    return weights, {f"C = {penalty:g}": loss for penalty, loss in losses.items()}
