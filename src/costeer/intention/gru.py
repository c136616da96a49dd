"""The intention network in NumPy: the reference for every faster form, Eq. (2).

Gate convention ("reset after", that of cuDNN, PyTorch, Keras' default and ONNX with
`linear_before_reset=1`): with input x and old state h,

    reset     r  = sigmoid(W_r x + b_r + U_r h + c_r)
    update    z  = sigmoid(W_z x + b_z + U_z h + c_z)
    candidate n  = tanh(W_n x + b_n + r (U_n h + c_n))
    new state h' = (1 - z) n + z h

from h = 0 at the window's first sample. The last hidden state feeds a sigmoid. Weights
are stacked in the order reset, update, candidate.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import DTypeLike, NDArray

from costeer.intention.features import NUM_FEATURES, scaled

Floats = NDArray[np.floating]

GATES = ("reset", "update", "candidate")


class NetworkWeights(NamedTuple):
    """All numbers of the network, with the scaling of its inputs.

    Attributes:
        feature_mean: Of the training set, in the signals' units, `(feature,)`.
        feature_scale: Standard deviations of the training set, `(feature,)`.
        input_weights: W [-], `(gate, hidden, feature)`.
        input_bias: b [-], `(gate, hidden)`.
        hidden_weights: U [-], `(gate, hidden, hidden)`.
        hidden_bias: c [-], `(gate, hidden)`.
        output_weights: From the last hidden state to the logit [-], `(hidden,)`.
        output_bias: Of the logit [-], `(1,)`.
    """

    feature_mean: NDArray[np.float64]
    feature_scale: NDArray[np.float64]
    input_weights: NDArray[np.float32]
    input_bias: NDArray[np.float32]
    hidden_weights: NDArray[np.float32]
    hidden_bias: NDArray[np.float32]
    output_weights: NDArray[np.float32]
    output_bias: NDArray[np.float32]


def hidden_size(weights: NetworkWeights) -> int:
    """Number of hidden units."""
    return int(weights.output_weights.shape[0])


def random_weights(hidden: int, seed: int) -> NetworkWeights:
    """Untrained weights, uniform within ±1/√hidden, for tests and benchmarks."""
    rng = np.random.default_rng(seed)
    bound = 1.0 / np.sqrt(hidden)

    def draw(*shape: int) -> NDArray[np.float32]:
        return rng.uniform(-bound, bound, shape).astype(np.float32)

    return NetworkWeights(
        feature_mean=np.zeros(NUM_FEATURES),
        feature_scale=np.ones(NUM_FEATURES),
        input_weights=draw(3, hidden, NUM_FEATURES),
        input_bias=draw(3, hidden),
        hidden_weights=draw(3, hidden, hidden),
        hidden_bias=draw(3, hidden),
        output_weights=draw(hidden),
        output_bias=draw(1),
    )


def sigmoid(x: Floats | np.floating) -> Floats | np.floating:
    """Logistic function, without overflow."""
    value: Floats | np.floating = 0.5 + 0.5 * np.tanh(0.5 * x)
    return value


def gru_step(
    weights: NetworkWeights,
    state: Float[Floats, "*batch hidden"],
    sample: Float[Floats, "*batch feature"],
) -> Float[Floats, "*batch hidden"]:
    """New hidden state after one sample.

    Args:
        weights: Of the precision in which to compute.
        state: Old hidden state, shape `(*batch, hidden)`.
        sample: Scaled features, shape `(*batch, feature)`.
    """
    from_input = np.einsum("...f,ghf->g...h", sample, weights.input_weights)
    from_state = np.einsum("...k,ghk->g...h", state, weights.hidden_weights)
    input_part = [from_input[g] + weights.input_bias[g] for g in range(3)]
    state_part = [from_state[g] + weights.hidden_bias[g] for g in range(3)]
    reset = sigmoid(input_part[0] + state_part[0])
    update = sigmoid(input_part[1] + state_part[1])
    candidate = np.tanh(input_part[2] + reset * state_part[2])
    new_state: Floats = candidate + update * (state - candidate)
    return new_state


def crossing_probability(
    weights: NetworkWeights,
    feature_window: NDArray[np.float64],
    dtype: DTypeLike = np.float64,
) -> Float[Floats, "*batch"]:
    """Probability of a crossing to the adjacent side within the next 3 s, Eq. (2).

    Args:
        weights: The network.
        feature_window: In the signals' units, facing right (features.py), shape
            `(*batch, time, feature)`; Eq. (1) has 180 samples, oldest first.
        dtype: Precision of the computation, float64 or float32.

    Returns:
        Shape `(*batch,)`; NaN where the window holds a value that is not finite.

    Raises:
        ValueError: If the last axis does not hold the six signals.
    """
    if feature_window.ndim < 2 or feature_window.shape[-1] != NUM_FEATURES:
        raise ValueError(
            f"feature_window has the shape {feature_window.shape}; it needs "
            f"(..., time, {NUM_FEATURES}), the signals of Eq. (1) last"
        )
    inputs = scaled(feature_window, weights.feature_mean, weights.feature_scale)
    inputs = inputs.astype(dtype)
    network = NetworkWeights(*(part.astype(dtype) for part in weights))
    state = np.zeros((*inputs.shape[:-2], hidden_size(weights)), dtype)
    for step in range(inputs.shape[-2]):
        state = gru_step(network, state, inputs[..., step, :])
    probability = sigmoid(state @ network.output_weights + network.output_bias[0])
    valid = np.isfinite(feature_window).all(axis=(-2, -1))
    return np.where(valid, probability, np.asarray(np.nan, dtype))
