"""Networks and signals that put a wavefront or a window to the test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH
from costeer.intention.gru import NetworkWeights, random_weights


def lively_weights(hidden: int, seed: int = 1) -> NetworkWeights:
    """Weights whose gates open and close and that remember all of the window.

    The bias keeps the update gates near 0.98, so the first of 180 samples still counts
    0.98^180 = 3 % and a window one sample too long would show.
    """
    weights = random_weights(hidden, seed)
    slow = np.array([0.0, 4.0, 0.0], np.float32)[:, None]
    return weights._replace(
        input_bias=weights.input_bias + slow,
        hidden_weights=2.0 * weights.hidden_weights,
        output_weights=4.0 * weights.output_weights,
    )


def needy_weights(hidden: int, seed: int = 1) -> NetworkWeights:
    """The same, of a network that was not trained to do without any signal."""
    return lively_weights(hidden, seed)._replace(dispensable=np.zeros(NUM_FEATURES))


def signals(num_samples: int, seed: int = 0) -> NDArray[np.float64]:
    """Smooth random signals of a few standard deviations."""
    steps = np.random.default_rng(seed).normal(size=(num_samples, NUM_FEATURES))
    return 3.0 * np.sin(0.05 * np.cumsum(steps, axis=0))


def windows(features: NDArray[np.float64]) -> NDArray[np.float64]:
    """All full windows, shape `(window, time, feature)`."""
    views = np.lib.stride_tricks.sliding_window_view(features, WINDOW_LENGTH, axis=0)
    return views.transpose(0, 2, 1)
