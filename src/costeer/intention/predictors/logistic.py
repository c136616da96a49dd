"""Logistic regression on what a window looks like.

The plainest learned classifier (Cox 1958, The regression analysis of binary sequences):
the logit is a weighted sum of the numbers in summary.py. Our reading: geometry goes in
where it is known (time to the line, place in a while), because a weighted sum of raw
signals could not form it; one set of coefficients per variant of the signals
(variants.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import NUM_FEATURES
from costeer.intention.gru import sigmoid
from costeer.intention.predictors.summary import bounded, summary
from costeer.intention.predictors.variants import by_variant

NEEDS = ("longitudinal_velocity",)
"""In every variant; what else there is decides which one speaks."""

LARGEST = 10.0
"""Standardised numbers are held within ± this [-]. Source: assumed, as
`features.FEATURE_LIMIT`."""


class LogisticWeights(NamedTuple):
    """Coefficients of one variant.

    Attributes:
        feature_mean: Of the training set, in the signals' units, `(feature,)`.
        feature_scale: Standard deviations of the training set, `(feature,)`.
        summary_mean: Of the training windows, in the channels' units, `(summary,)`.
        summary_scale: Standard deviations of the training windows, `(summary,)`.
        coefficients: Of the standardised numbers [-], `(summary,)`.
        intercept: Logit of a window that is average in all [-], `(1,)`.
    """

    feature_mean: NDArray[np.float64]
    feature_scale: NDArray[np.float64]
    summary_mean: NDArray[np.float64]
    summary_scale: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    intercept: NDArray[np.float64]


def expected_shapes(weights: LogisticWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    width = weights.coefficients.shape
    return {
        "feature_mean": (NUM_FEATURES,),
        "feature_scale": (NUM_FEATURES,),
        "summary_mean": width,
        "summary_scale": width,
        "coefficients": (weights.coefficients.size,),
        "intercept": (1,),
    }


def standardised(
    numbers: NDArray[np.float64],
    mean: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Numbers as standard deviations from the mean, within ±`LARGEST`."""
    return np.clip((numbers - mean) / scale, -LARGEST, LARGEST)


def _verdict(
    weights: LogisticWeights, signals: tuple[str, ...], features: NDArray[np.float64]
) -> NDArray[np.float64]:
    held = bounded(features, weights.feature_mean, weights.feature_scale)
    numbers = standardised(
        summary(held, signals), weights.summary_mean, weights.summary_scale
    )
    return np.asarray(sigmoid(numbers @ weights.coefficients + weights.intercept[0]))


crossing_probabilities = by_variant(_verdict)
"""Probability of a crossing within 3 s at every sample, from weights by variant."""
