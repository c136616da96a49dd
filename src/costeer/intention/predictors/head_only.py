"""What the head alone tells, after Lethaus et al. (2013).

Lethaus, Baumann, Köster, Lemmer, A comparison of selected simple supervised learning
algorithms to predict driver intent based on gaze data, Neurocomputing 121, 2013:
a small neural network reads from where a driver looked during the last seconds which
manoeuvre comes. Our reading: there is no gaze here, only the head's yaw, so the places
looked at become the course of the yaw, means over twelve quarters of a second, and how
much of it lay beyond a few angles to either side; one hidden layer, as theirs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import HEAD_YAW, WINDOW_LENGTH, full_windows
from costeer.intention.gru import sigmoid
from costeer.intention.predictors.summary import trailing_mean
from costeer.intention.predictors.variants import held_head

NEEDS = ("head_yaw",)

NUM_PIECES = 12
"""Pieces of a quarter of a second that the window is cut into [-]."""

ZONES = (-0.6, -0.35, -0.15, 0.15, 0.35)
"""Head yaw between the places looked at, facing right [-]. Source: assumed; from the
shoulder over the right mirror and the road to the left mirror."""

NUM_NUMBERS = NUM_PIECES + len(ZONES) + 3


class HeadWeights(NamedTuple):
    """A network of one hidden layer.

    Attributes:
        number_mean: Of the training windows [-], `(number,)`.
        number_scale: Standard deviations of the training windows [-], `(number,)`.
        hidden_weights: From the numbers to the hidden units [-], `(number, hidden)`.
        hidden_bias: `(hidden,)` [-].
        output_weights: From the hidden units to the logit [-], `(hidden,)`.
        output_bias: Of the logit [-], `(1,)`.
    """

    number_mean: NDArray[np.float64]
    number_scale: NDArray[np.float64]
    hidden_weights: NDArray[np.float64]
    hidden_bias: NDArray[np.float64]
    output_weights: NDArray[np.float64]
    output_bias: NDArray[np.float64]


def expected_shapes(weights: HeadWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    hidden = weights.output_weights.size
    return {
        "number_mean": (NUM_NUMBERS,),
        "number_scale": (NUM_NUMBERS,),
        "hidden_weights": (NUM_NUMBERS, hidden),
        "hidden_bias": (hidden,),
        "output_weights": (hidden,),
        "output_bias": (1,),
    }


def head_numbers(head_yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """The course of the head's yaw over the window that ends at each sample.

    Args:
        head_yaw: All finite, facing right, shape `(time,)`.

    Returns:
        Means of `NUM_PIECES` pieces, newest first; shares of the window beyond each of
        `ZONES`, to its right; last value; lowest of the pieces; share of
        the last second beyond the middle of the right zones; shape `(time, number)`.
        The first 179 rows look back over the start and mean nothing.
    """
    head = np.clip(head_yaw, -1.0, 1.0)
    piece = WINDOW_LENGTH // NUM_PIECES
    means = trailing_mean(head, np.full(piece, 1.0 / piece))
    pieces = [_earlier(means, i * piece) for i in range(NUM_PIECES)]
    window = np.full(WINDOW_LENGTH, 1.0 / WINDOW_LENGTH)
    shares = [trailing_mean((head < z).astype(float), window) for z in ZONES]
    second = np.full(60, 1.0 / 60.0)
    recent = trailing_mean((head < ZONES[1]).astype(float), second)
    lowest = np.minimum.reduce(pieces)
    return np.stack([*pieces, *shares, head, lowest, recent], axis=-1)


def _earlier(values: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """Values as they were so many samples before."""
    padded = np.concatenate([np.zeros(samples), values])
    return padded[: len(values)]


def crossing_probabilities(
    weights: HeadWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Probability of a crossing within 3 s at every sample.

    Args:
        weights: Of the network.
        features: Facing right, NaN where missing, shape `(time, feature)`.
        absent: Signals that the recording does not have.

    Returns:
        Shape `(time,)`; NaN where no full window ends, and where the head was lost for
        longer than `variants.HEAD_MEMORY`.
    """
    if set(NEEDS) & set(absent):
        return np.full(len(features), np.nan)
    held, seen = held_head(features)
    numbers = head_numbers(held[:, HEAD_YAW])
    scaled = (numbers - weights.number_mean) / weights.number_scale
    hidden = np.tanh(scaled @ weights.hidden_weights + weights.hidden_bias)
    said = sigmoid(hidden @ weights.output_weights + weights.output_bias[0])
    return np.where(full_windows(features, absent) & seen, said, np.nan)
