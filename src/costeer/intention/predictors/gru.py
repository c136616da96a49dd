"""Gated recurrent units, Eq. (2): the paper's, and ours that does without signals.

The paper's is fitted on windows of all six signals and says nothing where one is
missing, a lost head included. Ours is the same network, fitted with signals hidden from
it at random, so that it says what the remaining ones tell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.intention import wavefront
from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    NUM_INPUTS,
    NUM_SCALED,
)
from costeer.intention.gru import NetworkWeights

PAPER_NEEDS = FEATURES
OUR_NEEDS = ("longitudinal_velocity",)
"""As in all of `features.VARIANTS`."""


def paper_probabilities(
    weights: NetworkWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Verdicts of the paper's network, NaN while any signal is missing, `(time,)`.

    Args:
        weights: Of a network fitted on all six signals.
        features: Facing right, NaN where missing, shape `(time, feature)`.
        absent: Signals that the recording does not have.
    """
    if absent:
        return np.full(len(features), np.nan)
    whole = np.where(np.isnan(features), np.inf, features)
    return wavefront.crossing_probabilities(weights, whole)


def our_probabilities(
    weights: NetworkWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Verdicts of a network that does without what is missing, `(time,)`.

    Args:
        weights: Of a network fitted with signals hidden.
        features: Facing right, NaN where missing, shape `(time, feature)`.
        absent: Signals that the recording does not have.

    Returns:
        NaN where no full window ends, or the network was not fitted to do without
        what is absent.
    """
    needed = [n for n in absent if not weights.dispensable[FEATURES.index(n)]]
    if needed:
        return np.full(len(features), np.nan)
    return wavefront.crossing_probabilities(weights, features, absent)


def expected_shapes(weights: NetworkWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    hidden = weights.output_weights.size
    return {
        "feature_mean": (NUM_SCALED,),
        "feature_scale": (NUM_SCALED,),
        "dispensable": (NUM_FEATURES,),
        "input_weights": (3, hidden, NUM_INPUTS),
        "input_bias": (3, hidden),
        "hidden_weights": (3, hidden, hidden),
        "hidden_bias": (3, hidden),
        "output_weights": (hidden,),
        "output_bias": (1,),
    }
