"""Fit of the small network that sees the head alone; needs JAX and Optax."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

from costeer.intention.features import HEAD_YAW
from costeer.intention.predictors.head_only import HeadWeights, head_numbers
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.variants import held_head
from costeer.training.dataset import DatasetParameters, Split
from costeer.training.predictors.descent import (
    Descent,
    DescentParameters,
    batch_rows,
    descend,
)
from costeer.training.predictors.logit import logit_loss
from costeer.training.predictors.samples import (
    Answers,
    Table,
    chosen_rows,
    number_scaling,
    table,
)
from costeer.training.recordings import Recording


class HeadParameters(NamedTuple):
    """What is fitted and what the validation drivers choose from.

    Attributes:
        hidden_sizes: Units of the hidden layer [-]. Source: assumed.
        descent: How long and how fast to learn.
    """

    hidden_sizes: tuple[int, ...] = (8, 16)
    descent: DescentParameters = DescentParameters(
        batch_size=512, learning_rate=1e-2, num_steps=4000
    )


DEFAULTS = HeadParameters()


class Layers(NamedTuple):
    """Weights as the descent changes them; fields as in `HeadWeights`."""

    hidden_weights: Any
    hidden_bias: Any
    output_weights: Any
    output_bias: Any


def head_table(recordings: Sequence[Recording], dataset: DatasetParameters) -> Table:
    """Windows with the numbers of the head's course.

    Raises:
        ValueError: If no recording has a head, or all windows are of one class.
    """
    numbers, answers = [], []
    for one in recordings:
        if "head_yaw" in one.absent:
            continue
        held, seen = held_head(one.features)
        rows, answer = chosen_rows(one, dataset)
        there = seen[rows]
        numbers.append(head_numbers(held[:, HEAD_YAW])[rows[there]])
        answers.append(Answers(answer.positive[there], answer.weight[there]))
    return table(numbers, answers)


def logits(layers: Layers, numbers: Any) -> Any:
    """Logit of each window, from standardised numbers."""
    hidden = jnp.tanh(numbers @ layers.hidden_weights + layers.hidden_bias)
    return hidden @ layers.output_weights + layers.output_bias[0]


def initial_layers(num_numbers: int, hidden: int, seed: int) -> Layers:
    """Uniform weights within ±1/√width."""
    rng = np.random.default_rng([seed, 4, hidden])

    def draw(*shape: int) -> jax.Array:
        bound = 1.0 / np.sqrt(shape[0])
        return jnp.asarray(rng.uniform(-bound, bound, shape), jnp.float32)

    return Layers(
        hidden_weights=draw(num_numbers, hidden),
        hidden_bias=jnp.zeros(hidden),
        output_weights=draw(hidden),
        output_bias=jnp.full(1, -2.0),
    )


def fit_head_only(
    split: Split,
    dataset: DatasetParameters,
    seed: int,
    parameters: HeadParameters = DEFAULTS,
) -> Baseline:
    """Fit on the training drivers with the size that suits the validation drivers.

    Raises:
        ValueError: If no recording has a head, or all windows are of one class.
    """
    training = head_table(split.training, dataset)
    validation = head_table(split.validation, dataset)
    mean, scale = number_scaling(training.numbers, training.answers.weight)
    seen, unseen = (
        Table((part.numbers - mean) / scale, part.answers)
        for part in (training, validation)
    )
    fits = {h: _fit(seen, unseen, h, seed, parameters) for h in parameters.hidden_sizes}
    losses = {h: min(loss for _, loss in one.curve) for h, one in fits.items()}
    best = min(losses, key=lambda hidden: losses[hidden])
    layers = {n: np.asarray(v, float) for n, v in fits[best].weights._asdict().items()}
    weights = HeadWeights(number_mean=mean, number_scale=scale, **layers)
    looked = {f"{hidden} units": loss for hidden, loss in losses.items()}
    return Baseline({"head": weights}, {"validation_log_loss": looked})


def _fit(
    training: Table,
    validation: Table,
    hidden: int,
    seed: int,
    parameters: HeadParameters,
) -> Descent:
    """One network, from standardised numbers."""

    def batches() -> Iterator[tuple[Any, ...]]:
        size = parameters.descent.batch_size
        for rows in batch_rows(len(training.numbers), size, seed):
            positive, weight = (part[rows] for part in training.answers)
            numbers = training.numbers[rows].astype(np.float32)
            yield numbers, positive.astype(np.float32), weight

    def judged(layers: Layers) -> float:
        said = np.asarray(logits(layers, validation.numbers), np.float64)
        return logit_loss(said, validation.answers)

    start = initial_layers(training.numbers.shape[1], hidden, seed)
    return descend(_loss, start, batches(), judged, parameters.descent)


def _loss(layers: Layers, numbers: Any, positive: Any, weight: Any) -> jax.Array:
    each = optax.sigmoid_binary_cross_entropy(logits(layers, numbers), positive)
    return jnp.sum(weight * each) / jnp.sum(weight)
