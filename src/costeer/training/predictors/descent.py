"""Gradient descent that the small networks share; needs JAX and Optax.

Every so many steps the validation drivers are looked at; the weights with the lowest
loss there are kept, and the descent stops when it has not fallen for a while.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeVar

import jax
import numpy as np
import optax
from numpy.typing import NDArray

from costeer.training.optimiser import optimiser

Weights = TypeVar("Weights")
Loss = Callable[..., jax.Array]


class DescentParameters(NamedTuple):
    """How long and how fast to learn.

    Attributes:
        batch_size: Windows per step [-]. Source: assumed.
        learning_rate: Of Adam at its highest [-]. Source: assumed.
        weight_decay: Of Adam [-]. Source: assumed.
        largest_gradient: Norm at which a gradient is cut [-]. Source: assumed.
        num_steps: At most; the rate falls to a hundredth along a cosine [-]. Source:
            assumed.
        steps_per_check: Between two looks at the validation drivers [-]. Source:
            assumed.
        patience: Looks without a better loss before it stops [-]. Source: assumed.
    """

    batch_size: int = 256
    learning_rate: float = 5e-3
    weight_decay: float = 1e-4
    largest_gradient: float = 1.0
    num_steps: int = 3000
    steps_per_check: int = 250
    patience: int = 5


class Descent(NamedTuple):
    """What came out.

    Attributes:
        weights: The best on the validation drivers, a tree of arrays.
        curve: Step and validation loss of each look.
    """

    weights: Any  # Any: a tree of arrays
    curve: list[tuple[int, float]]


def batch_rows(
    num_windows: int, batch_size: int, seed: int
) -> Iterator[NDArray[np.int64]]:
    """Which windows come in each step; each once per pass, in a new order."""
    rng = np.random.default_rng([seed, 2])
    size = min(batch_size, num_windows)
    while True:
        order = rng.permutation(num_windows)
        for start in range(0, num_windows - size + 1, size):
            yield order[start : start + size]


def descend(
    loss: Loss,
    start: Weights,
    batches: Iterator[tuple[Any, ...]],
    judged: Callable[[Weights], float],
    parameters: DescentParameters,
) -> Descent:
    """Go down the slope of a loss.

    Args:
        loss: Of weights and the arrays of a batch.
        start: First weights.
        batches: Without end.
        judged: Loss of weights on the validation drivers.
        parameters: How long and how fast.
    """
    rule = optimiser(parameters)

    @jax.jit
    def update(weights: Weights, memory: Any, batch: Any) -> Any:
        slope = jax.grad(loss)(weights, *batch)
        change, memory = rule.update(slope, memory, weights)
        return optax.apply_updates(weights, change), memory

    weights, memory, best = start, rule.init(start), start
    curve: list[tuple[int, float]] = []
    for step, batch in enumerate(batches, 1):
        weights, memory = update(weights, memory, batch)
        if step % parameters.steps_per_check and step < parameters.num_steps:
            continue
        curve.append((step, judged(weights)))
        losses = [value for _, value in curve]
        place = int(np.argmin(losses))
        best = weights if place == len(curve) - 1 else best
        stalled = len(curve) - 1 - place >= parameters.patience
        if step >= parameters.num_steps or stalled:
            break
    return Descent(weights=jax.device_get(best), curve=curve)
