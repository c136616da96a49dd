"""All rivals of the intention network in one go, from one split of drivers.

Training drivers teach, validation drivers choose; test drivers are not looked at. The
paper's network is fitted by training/fit.py and joins the others afterwards
(`with_paper_network`), since its fit takes longer than all of these together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.registry import fitted_predictor
from costeer.intention.predictors.store import KINDS, Baseline
from costeer.training.dataset import DatasetParameters, Split
from costeer.training.predictors import (
    crossing_time,
    head_only,
    line_time,
    logistic,
    support_vectors,
)
from costeer.training.predictors.judge import predictor_scores
from costeer.training.predictors.kept import Kept, keep
from costeer.training.predictors.samples import (
    Answers,
    FeatureScaling,
    Table,
    feature_scaling,
    summary_table,
    thinned,
)

FITTED: tuple[str, ...] = tuple(name for name in KINDS if name != "paper-gru")
"""Names of the predictors that `train_baselines` fits."""


class BaselineParameters(NamedTuple):
    """All that the fits depend on besides recordings and seed.

    Attributes:
        dataset: Which windows are used.
        num_windows: Most training windows of the summaries [-]. Source: assumed,
            for memory and time.
        line_time: Of the time to lane crossing.
        logistic: Of the logistic regression.
        machine: Of the support vector machine.
        head: Of the head alone.
        crossing_time: Of the LSTM.
    """

    dataset: DatasetParameters = DatasetParameters()
    num_windows: int = 120_000
    line_time: line_time.LineTimeParameters = line_time.DEFAULTS
    logistic: logistic.LogisticParameters = logistic.DEFAULTS
    machine: support_vectors.MachineParameters = support_vectors.DEFAULTS
    head: head_only.HeadParameters = head_only.DEFAULTS
    crossing_time: crossing_time.CrossingTimeParameters = crossing_time.DEFAULTS


DEFAULTS = BaselineParameters()


class Summaries(NamedTuple):
    """What logistic regression and support vector machine share.

    Attributes:
        scaling: Of the signals.
        training: Windows of the training drivers.
        validation: Windows of the validation drivers.
    """

    scaling: FeatureScaling
    training: Table
    validation: Table


def train_baselines(
    split: Split,
    seed: int,
    progress: Callable[[int], None] | None = None,
    names: Sequence[str] = FITTED,
    parameters: BaselineParameters = DEFAULTS,
    kept: Kept | None = None,
) -> dict[str, Baseline]:
    """Fit the rivals of the network.

    Args:
        split: Training drivers to learn from, validation drivers to choose by.
        seed: Of draws, first weights and the order of windows.
        progress: Told 1 after each predictor.
        names: Some of `FITTED`.
        parameters: Everything else.
        kept: Where each fit is put when it is done, and those that need none; a kept
            fit must be of the same split, seed and parameters.

    Returns:
        By name, in the order of spec section 9, with facts: drivers, seed, what was
        chosen from, and scores on the validation drivers.

    Raises:
        ValueError: If a name is unknown or the recordings do not suffice.
    """
    unknown = [name for name in names if name not in FITTED]
    if unknown:
        raise ValueError(f"{unknown[0]!r} is none of the fits {', '.join(FITTED)}")
    there = {} if kept is None else kept.done
    missing = [name for name in names if name not in there]
    shared = _summaries(split, seed, parameters, missing)
    found = {}
    for name in (name for name in FITTED if name in names):
        if name in there:
            found[name] = there[name]
        else:
            fitted = _fitted(name, split, shared, seed, parameters)
            found[name] = _with_facts(name, fitted, split, seed)
            if kept is not None:
                keep(kept, name, found[name])
        if progress:
            progress(1)
    return found


def with_paper_network(
    baselines: Mapping[str, Baseline], weights: NetworkWeights, facts: dict[str, Any]
) -> dict[str, Baseline]:
    """The same set with the paper's network, fitted on all six signals."""
    return {**baselines, "paper-gru": Baseline({"full": weights}, facts)}


def _summaries(
    split: Split, seed: int, parameters: BaselineParameters, names: Sequence[str]
) -> Summaries:
    scaling = feature_scaling(split.training)
    if not {"logistic", "support-vectors"} & set(names):
        none = Table(np.empty((0, 0)), Answers(np.empty(0, bool), np.empty(0)))
        return Summaries(scaling, none, none)
    training, validation = (
        summary_table(part, scaling, parameters.dataset)
        for part in (split.training, split.validation)
    )
    return Summaries(
        scaling, thinned(training, seed, parameters.num_windows), validation
    )


def _fitted(
    name: str,
    split: Split,
    shared: Summaries,
    seed: int,
    parameters: BaselineParameters,
) -> Baseline:
    """One predictor."""
    scaling, training, validation = shared
    dataset = parameters.dataset
    if name == "line-time":
        return line_time.fit_line_time(split, dataset, parameters.line_time)
    if name == "logistic":
        return logistic.fit_logistic(training, validation, scaling, parameters.logistic)
    if name == "support-vectors":
        return support_vectors.fit_machines(
            training,
            validation,
            scaling,
            split.validation,
            seed,
            parameters.machine,
        )
    if name == "head-only":
        return head_only.fit_head_only(split, dataset, seed, parameters.head)
    return crossing_time.fit_crossing_time(
        split, scaling, dataset, seed, parameters.crossing_time
    )


def _with_facts(name: str, fitted: Baseline, split: Split, seed: int) -> Baseline:
    """The fit with where it comes from and what it is worth."""
    scores = {
        variant: predictor_scores(
            fitted_predictor(name, Baseline({variant: weights}, {})), split.validation
        )
        for variant, weights in fitted.variants.items()
    }
    drivers = {
        part: sorted({r.driver for r in recordings})
        for part, recordings in split._asdict().items()
    }
    facts = {"seed": seed, "drivers": drivers, "validation": scores, **fitted.facts}
    return Baseline(fitted.variants, facts)
