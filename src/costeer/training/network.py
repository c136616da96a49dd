"""The network of Eq. (2) in JAX, for gradients; intention/gru.py is the reference."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import NUM_INPUTS
from costeer.intention.gru import NetworkWeights
from costeer.training.scaling import Scaling

LONG_MEMORY = 2.0
"""Bias of the update gate at the start: a state lasts for 8 samples, not for 2 [-]."""


class TrainedWeights(NamedTuple):
    """Weights as the training changes them, gates side by side.

    Attributes:
        input_weights: `(input, gate * hidden)`.
        input_bias: `(gate * hidden,)`.
        hidden_weights: `(hidden, gate * hidden)`.
        hidden_bias: `(gate * hidden,)`.
        output_weights: `(hidden,)`.
        output_bias: `()`.
    """

    input_weights: jax.Array
    input_bias: jax.Array
    hidden_weights: jax.Array
    hidden_bias: jax.Array
    output_weights: jax.Array
    output_bias: jax.Array


def initial_weights(hidden: int, prevalence: float, seed: int) -> TrainedWeights:
    """Uniform weights within ±1/√hidden; the first answer is the prevalence."""
    rng = np.random.default_rng([seed, hidden])
    bound = 1.0 / np.sqrt(hidden)

    def draw(*shape: int) -> jax.Array:
        return jnp.asarray(rng.uniform(-bound, bound, shape), jnp.float32)

    slow = np.repeat([0.0, LONG_MEMORY, 0.0], hidden)
    return TrainedWeights(
        input_weights=draw(NUM_INPUTS, 3 * hidden),
        input_bias=jnp.asarray(slow, jnp.float32),
        hidden_weights=draw(hidden, 3 * hidden),
        hidden_bias=jnp.zeros(3 * hidden),
        output_weights=draw(hidden),
        output_bias=jnp.asarray(np.log(prevalence / (1.0 - prevalence)), jnp.float32),
    )


def logits(weights: TrainedWeights, windows: jax.Array) -> jax.Array:
    """Logit of the crossing probability.

    The step is recomputed on the way back (`checkpoint`): the kept intermediates of
    180 steps would not fit the cache, and reading them takes twice the time.

    Args:
        weights: Of the network.
        windows: Network inputs, shape `(batch, time, input)`.

    Returns:
        Shape `(batch,)`.
    """
    hidden = weights.output_weights.shape[0]

    @jax.checkpoint
    def step(state: jax.Array, sample: jax.Array) -> tuple[jax.Array, None]:
        inputs = sample @ weights.input_weights + weights.input_bias
        memory = state @ weights.hidden_weights + weights.hidden_bias
        gates = 0.5 + 0.5 * jnp.tanh(
            0.5 * (inputs[:, : 2 * hidden] + memory[:, : 2 * hidden])
        )
        reset, update = gates[:, :hidden], gates[:, hidden:]
        candidate = jnp.tanh(inputs[:, 2 * hidden :] + reset * memory[:, 2 * hidden :])
        return candidate + update * (state - candidate), None

    start = jnp.zeros((windows.shape[0], hidden), windows.dtype)
    last, _ = jax.lax.scan(step, start, jnp.swapaxes(windows, 0, 1))
    return last @ weights.output_weights + weights.output_bias


def network_weights(weights: TrainedWeights, scaling: Scaling) -> NetworkWeights:
    """The trained weights as the rest of costeer takes them."""
    hidden = weights.output_weights.shape[0]

    def gates(values: jax.Array) -> NDArray[np.float32]:
        """Move the gates to the front, `(gate, hidden, ...)`."""
        return np.asarray(values.T, np.float32).reshape(3, hidden, *values.shape[:-1])

    return NetworkWeights(
        feature_mean=scaling.mean,
        feature_scale=scaling.scale,
        dispensable=scaling.dispensable,
        input_weights=gates(weights.input_weights),
        input_bias=gates(weights.input_bias),
        hidden_weights=gates(weights.hidden_weights),
        hidden_bias=gates(weights.hidden_bias),
        output_weights=np.asarray(weights.output_weights, np.float32),
        output_bias=np.asarray(weights.output_bias, np.float32).reshape(1),
    )


def trained_weights(network: NetworkWeights) -> TrainedWeights:
    """The weights of a network as the training changes them."""
    hidden = network.output_weights.shape[0]

    def side_by_side(values: NDArray[np.float32]) -> jax.Array:
        """Move the gates to the end, `(..., gate * hidden)`."""
        return jnp.asarray(values.reshape(3 * hidden, *values.shape[2:]).T)

    return TrainedWeights(
        input_weights=side_by_side(network.input_weights),
        input_bias=side_by_side(network.input_bias),
        hidden_weights=side_by_side(network.hidden_weights),
        hidden_bias=side_by_side(network.hidden_bias),
        output_weights=jnp.asarray(network.output_weights),
        output_bias=jnp.asarray(network.output_bias[0]),
    )
