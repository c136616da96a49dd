"""The intention network in NumPy: the reference for every faster form, Eq. (2).

Gate convention ("reset after", that of cuDNN, PyTorch, Keras' default and ONNX with
`linear_before_reset=1`): with input x and old state h,

    reset     r  = sigmoid(W_r x + b_r + U_r h + c_r)
    update    z  = sigmoid(W_z x + b_z + U_z h + c_z)
    candidate n  = tanh(W_n x + b_n + r (U_n h + c_n))
    new state h' = (1 - z) n + z h

from h = 0 at the window's first sample. The last hidden state feeds a sigmoid. Weights
are stacked in the order reset, update, candidate.

The input x holds the six signals of Eq. (1), scaled, their product (the velocity
towards the line) and a flag for each signal that is missing (`features.INPUTS`). The
paper's own network has the signals only: its other input weights are 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import DTypeLike, NDArray

from costeer.intention.features import (
    FEATURES,
    HEAD_YAW,
    NUM_FEATURES,
    NUM_INPUTS,
    NUM_SCALED,
    hide,
    network_inputs,
    valid_samples,
)

Floats = NDArray[np.floating]

GATES = ("reset", "update", "candidate")


class NetworkWeights(NamedTuple):
    """All numbers of the network, with the scaling of its inputs.

    Attributes:
        feature_mean: Of the training set, in the signals' units, with the approach
            velocity at the end, `(7,)`.
        feature_scale: Standard deviations of the training set, `(7,)`.
        dispensable: 1 for each signal that the network was trained to do without,
            else 0, `(feature,)`.
        input_weights: W [-], `(gate, hidden, input)`.
        input_bias: b [-], `(gate, hidden)`.
        hidden_weights: U [-], `(gate, hidden, hidden)`.
        hidden_bias: c [-], `(gate, hidden)`.
        output_weights: From the last hidden state to the logit [-], `(hidden,)`.
        output_bias: Of the logit [-], `(1,)`.
    """

    feature_mean: NDArray[np.float64]
    feature_scale: NDArray[np.float64]
    dispensable: NDArray[np.float64]
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
        feature_mean=np.zeros(NUM_SCALED),
        feature_scale=np.ones(NUM_SCALED),
        dispensable=np.ones(NUM_FEATURES),
        input_weights=draw(3, hidden, NUM_INPUTS),
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
    sample: Float[Floats, "*batch input"],
) -> Float[Floats, "*batch hidden"]:
    """New hidden state after one sample.

    Args:
        weights: Of the precision in which to compute.
        state: Old hidden state, shape `(*batch, hidden)`.
        sample: Network inputs, shape `(*batch, input)`.
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


def without(dispensable: NDArray[np.generic], absent: tuple[str, ...]) -> None:
    """Refuse to do without signals that a network needs.

    Args:
        dispensable: What it can do without, `(feature,)`.
        absent: What is not there.

    Raises:
        ValueError: Naming them.
    """
    needed = [n for n in absent if not dispensable[FEATURES.index(n)]]
    if needed:
        raise ValueError(
            f"this network was not trained to do without {', '.join(needed)}: give "
            "the signal, or take a network that was"
        )


def usable(
    weights: NetworkWeights, features: NDArray[np.float64], absent: tuple[str, ...]
) -> NDArray[np.bool_]:
    """Whether each sample of `features`, shape `(*batch, feature)`, may be used.

    As `features.valid_samples`; a lost head only by a network trained for it.
    """
    flat = features.reshape(-1, NUM_FEATURES)
    valid = valid_samples(flat, absent)
    if not weights.dispensable[HEAD_YAW]:
        valid &= np.isfinite(flat[:, HEAD_YAW])
    return valid.reshape(features.shape[:-1])


def crossing_probability(
    weights: NetworkWeights,
    feature_window: NDArray[np.float64],
    dtype: DTypeLike = np.float64,
    absent: tuple[str, ...] = (),
) -> Float[Floats, "*batch"]:
    """Probability of a crossing to the adjacent side within the next 3 s, Eq. (2).

    Args:
        weights: The network.
        feature_window: In the signals' units, facing right (features.py), NaN where
            missing, shape `(*batch, time, feature)`; Eq. (1) has 180 samples, oldest
            first.
        dtype: Precision of the computation, float64 or float32.
        absent: Signals that are not there at all.

    Returns:
        Shape `(*batch,)`; NaN where the window holds a sample that cannot be used.

    Raises:
        ValueError: If the last axis does not hold the six signals, or the network
            cannot do without an absent one.
    """
    if feature_window.ndim < 2 or feature_window.shape[-1] != NUM_FEATURES:
        raise ValueError(
            f"feature_window has the shape {feature_window.shape}; it needs "
            f"(..., time, {NUM_FEATURES}), the signals of Eq. (1) last"
        )
    without(weights.dispensable, absent)
    known = hide(feature_window, absent)
    inputs = network_inputs(known, weights.feature_mean, weights.feature_scale)
    inputs = inputs.astype(dtype)
    network = NetworkWeights(*(part.astype(dtype) for part in weights))
    state = np.zeros((*inputs.shape[:-2], hidden_size(weights)), dtype)
    for step in range(inputs.shape[-2]):
        state = gru_step(network, state, inputs[..., step, :])
    probability = sigmoid(state @ network.output_weights + network.output_bias[0])
    valid = usable(weights, feature_window, absent).all(axis=-1)
    return np.where(valid, probability, np.asarray(np.nan, dtype))
