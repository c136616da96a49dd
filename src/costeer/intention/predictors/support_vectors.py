"""Support vector machine with a probability, after Kumar et al. (2013).

Kumar, Perrollaz, Lefèvre, Laugier, Learning-based approach for online lane change
intention prediction, IEEE Intelligent Vehicles Symposium 2013: a support vector machine
with an RBF kernel says for each sample how likely a lane change is, and a Bayesian
filter joins what it said over time. Our reading:

- *Numbers*: theirs come from a lane tracker, lateral position and steering angle
  against the road with their derivatives. Ours are columns of summary.py; the
  validation drivers choose between those four and a longer list.
- *Classes*: to the adjacent side or not, since the signals face that side; theirs are
  left, right and none. So the probability is Platt's (1999), a logistic function of
  the decision value, instead of a coupling of pairs.
- *Filter*: two states; the one before a crossing lasts for 3 s in the mean, the other
  so long that their shares are those of the training. The evidence, the odds of Platt
  over those of the prior, counts by a share of itself, since neighbouring samples say
  the same thing. The validation drivers choose the share; 0 means no filter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH
from costeer.intention.gru import sigmoid
from costeer.intention.predictors.logistic import standardised
from costeer.intention.predictors.summary import bounded, summary
from costeer.intention.predictors.variants import by_variant

NEEDS = (
    "longitudinal_acceleration",
    "longitudinal_velocity",
    "distance_to_adjacent_lane",
    "yaw_angle",
)
"""Signals of the variant "motion"; with head and wheel the full one speaks."""

STATE_SAMPLES = 180
"""Samples for which the state before a crossing lasts: 3 s, as in the labels [-]."""

BLOCK = 1024
"""Windows whose kernel is held at a time: 12 MB with 1500 support vectors [-]."""


class SupportVectorWeights(NamedTuple):
    """One machine.

    Attributes:
        feature_mean: Of the training set, in the signals' units, `(feature,)`.
        feature_scale: Standard deviations of the training set, `(feature,)`.
        columns: Of the summary that it looks at [-], `(column,)`.
        summary_mean: Of the training windows, in the channels' units, `(column,)`.
        summary_scale: Standard deviations of the training windows, `(column,)`.
        vectors: Support vectors, standardised [-], `(vector, column)`.
        dual: Coefficient of each [-], `(vector,)`.
        bias: Of the decision value [-], `(1,)`.
        width: γ of the kernel exp(-γ |x - y|²) [-], `(1,)`.
        platt: Intercept and slope of the logit over the decision value [-], `(2,)`.
        filter: Logit of the prior, and share of the evidence that counts [-], `(2,)`.
    """

    feature_mean: NDArray[np.float64]
    feature_scale: NDArray[np.float64]
    columns: NDArray[np.int64]
    summary_mean: NDArray[np.float64]
    summary_scale: NDArray[np.float64]
    vectors: NDArray[np.float32]
    dual: NDArray[np.float64]
    bias: NDArray[np.float64]
    width: NDArray[np.float64]
    platt: NDArray[np.float64]
    filter: NDArray[np.float64]


def expected_shapes(weights: SupportVectorWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    width = weights.columns.size
    return {
        "feature_mean": (NUM_FEATURES,),
        "feature_scale": (NUM_FEATURES,),
        "columns": (width,),
        "summary_mean": (width,),
        "summary_scale": (width,),
        "vectors": (weights.dual.size, width),
        "dual": (weights.dual.size,),
        "bias": (1,),
        "width": (1,),
        "platt": (2,),
        "filter": (2,),
    }


def decision_values(
    weights: SupportVectorWeights, numbers: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Signed distance from the border in the kernel's space [-].

    Args:
        weights: Of the machine.
        numbers: Standardised, shape `(window, column)`.

    Returns:
        Shape `(window,)`.
    """
    vectors = weights.vectors.astype(np.float64)
    lengths = (vectors**2).sum(axis=1)
    found = np.empty(len(numbers))
    for start in range(0, len(numbers), BLOCK):
        block = numbers[start : start + BLOCK]
        cross = block @ vectors.T
        squared = (block**2).sum(axis=1)[:, None] + lengths - 2.0 * cross
        kernel = np.exp(-weights.width[0] * squared)
        found[start : start + BLOCK] = kernel @ weights.dual + weights.bias[0]
    return found


def filtered(
    logit: NDArray[np.float64], prior: float, evidence_share: float
) -> NDArray[np.float64]:
    """Logit of the state before a crossing after all samples so far.

    Args:
        logit: By Platt at each sample, NaN where there is none, `(time,)`.
        prior: Logit of the prior.
        evidence_share: Of each sample's evidence that counts, 0 for no filter [-].

    Returns:
        Shape `(time,)`; begins anew from the prior after each NaN.
    """
    if evidence_share == 0.0:
        return logit
    leave = 1.0 / STATE_SAMPLES
    enter = leave * math.exp(prior)
    belief, found = math.nan, np.full(len(logit), np.nan)
    for i, seen in enumerate(logit.tolist()):
        before = 1.0 / (1.0 + math.exp(-(prior if math.isnan(belief) else belief)))
        expected = before * (1.0 - leave) + (1.0 - before) * enter
        odds = math.log(expected / (1.0 - expected))
        belief = min(max(odds + evidence_share * (seen - prior), -30.0), 30.0)
        found[i] = belief = math.nan if math.isnan(seen) else belief
    return found


def platt_logits(
    weights: SupportVectorWeights,
    signals: tuple[str, ...],
    features: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Logit of the crossing probability before the filter.

    Args:
        weights: Of the machine.
        signals: Of its variant.
        features: Without lost heads, facing right, shape `(time, feature)`.

    Returns:
        Shape `(time,)`; NaN before the first window is full.
    """
    held = bounded(features, weights.feature_mean, weights.feature_scale)
    numbers = standardised(
        summary(held, signals)[:, weights.columns],
        weights.summary_mean,
        weights.summary_scale,
    )
    logit = weights.platt[0] + weights.platt[1] * decision_values(weights, numbers)
    logit[: WINDOW_LENGTH - 1] = np.nan
    return np.asarray(logit)


def _verdict(
    weights: SupportVectorWeights,
    signals: tuple[str, ...],
    features: NDArray[np.float64],
) -> NDArray[np.float64]:
    logit = platt_logits(weights, signals, features)
    return np.asarray(sigmoid(filtered(logit, *weights.filter)))


crossing_probabilities = by_variant(_verdict)
"""Probability of a crossing within 3 s at every sample, from weights by variant."""
