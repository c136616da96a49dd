"""Numbers for predictors that nobody fitted, and drives for them to look at."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import FEATURES, VARIANTS
from costeer.intention.gru import random_weights
from costeer.intention.predictors.crossing_time import CrossingTimeWeights
from costeer.intention.predictors.head_only import NUM_NUMBERS, HeadWeights
from costeer.intention.predictors.line_time import LineTimeWeights
from costeer.intention.predictors.logistic import LogisticWeights
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.summary import summary_names
from costeer.intention.predictors.support_vectors import SupportVectorWeights
from costeer.intention.predictors.variants import signals_of

MEAN = np.array([0.0, 0.0, 20.0, 0.0, 1.75, 0.0])
SCALE = np.array([0.2, 0.3, 3.0, 0.05, 0.5, 0.01])


def features(length: int, seed: int) -> NDArray[np.float64]:
    """Smooth signals of about the usual size, facing right, `(time, feature)`."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(length, len(FEATURES)))
    smooth = np.cumsum(steps, axis=0) / np.sqrt(np.arange(1, length + 1))[:, None]
    return MEAN + SCALE * smooth


def line_time() -> LineTimeWeights:
    return LineTimeWeights(np.array([0.2]), np.array([3.0]), np.array([-2.0]))


def logistic(variant: str) -> LogisticWeights:
    width = len(summary_names(signals_of(variant)))
    rng = np.random.default_rng(width)
    return LogisticWeights(
        feature_mean=MEAN,
        feature_scale=SCALE,
        summary_mean=rng.normal(size=width),
        summary_scale=rng.uniform(0.5, 2.0, width),
        coefficients=rng.normal(0.0, 0.3, width),
        intercept=np.array([-1.0]),
    )


def machine(variant: str, evidence_share: float = 0.0) -> SupportVectorWeights:
    width, vectors = 5, 20
    rng = np.random.default_rng(len(variant))
    columns = rng.permutation(len(summary_names(signals_of(variant))))[:width]
    return SupportVectorWeights(
        feature_mean=MEAN,
        feature_scale=SCALE,
        columns=columns.astype(np.int64),
        summary_mean=np.zeros(width),
        summary_scale=np.ones(width),
        vectors=rng.normal(size=(vectors, width)).astype(np.float32),
        dual=rng.normal(size=vectors),
        bias=np.array([0.1]),
        width=np.array([0.2]),
        platt=np.array([-1.0, 2.0]),
        filter=np.array([-2.7, evidence_share]),
    )


def head_only() -> HeadWeights:
    rng = np.random.default_rng(4)
    return HeadWeights(
        number_mean=np.zeros(NUM_NUMBERS),
        number_scale=np.ones(NUM_NUMBERS),
        hidden_weights=rng.normal(size=(NUM_NUMBERS, 4)),
        hidden_bias=rng.normal(size=4),
        output_weights=rng.normal(size=4),
        output_bias=np.array([-1.0]),
    )


def crossing_time(variant: str, hidden: int = 5) -> CrossingTimeWeights:
    inputs = len(signals_of(variant)) + 1
    rng = np.random.default_rng(inputs)

    def draw(*shape: int) -> NDArray[np.float32]:
        return rng.uniform(-0.5, 0.5, shape).astype(np.float32)

    return CrossingTimeWeights(
        feature_mean=MEAN,
        feature_scale=SCALE,
        input_mean=np.zeros(inputs),
        input_scale=np.full(inputs, 5.0),
        input_weights=draw(inputs, 4 * hidden),
        bias=draw(4 * hidden),
        hidden_weights=draw(hidden, 4 * hidden),
        output_weights=draw(hidden),
        output_bias=draw(1),
        horizon=np.array([5.0]),
        logistic=np.array([3.0, -1.0]),
    )


def baselines() -> dict[str, Baseline]:
    """One of each, with numbers out of thin air."""
    variants: dict[str, dict[str, Any]] = {
        "line-time": {"motion": line_time()},
        "logistic": {name: logistic(name) for name in VARIANTS},
        "support-vectors": {name: machine(name) for name in ("full", "motion")},
        "head-only": {"head": head_only()},
        "crossing-time": {name: crossing_time(name) for name in ("full", "motion")},
        "paper-gru": {"full": random_weights(4, seed=1)},
    }
    return {name: Baseline(each, {"seed": 1}) for name, each in variants.items()}
