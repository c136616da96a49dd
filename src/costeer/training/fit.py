"""Fit the network by gradient descent; the best weights on unseen drivers win.

Needs JAX and Optax (extra `train`). Loss: weighted log loss. Every so many steps the
exact window runs over the validation drivers' whole recordings, as it will in the loop,
in every variant that is trained for; the weights with the lowest mean log loss there
are kept, and the training stops when it has not fallen for a while.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

from costeer.intention.features import VARIANTS
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.gru import our_probabilities
from costeer.training.augmentation import AugmentationParameters, shares
from costeer.training.dataset import Windows, batches
from costeer.training.evaluate import judged_samples, sample_scores, verdicts
from costeer.training.network import (
    TrainedWeights,
    initial_weights,
    logits,
    network_weights,
)
from costeer.training.optimiser import optimiser
from costeer.training.recordings import Recording, lacking
from costeer.training.scaling import Scaling


class FitParameters(NamedTuple):
    """How long and how fast to learn.

    Attributes:
        batch_size: Windows per step [-]. Source: assumed.
        learning_rate: Of Adam at its highest [-]. Source: assumed; half of it learns
            slower, twice as much is unsteady.
        weight_decay: Of Adam [-]. Source: assumed.
        largest_gradient: Norm at which a gradient is cut [-]. Source: assumed.
        num_steps: At most; the rate falls to a hundredth along a cosine [-]. Source:
            assumed.
        steps_per_check: Between two looks at the validation drivers [-]. Source:
            assumed.
        patience: Looks without a better log loss before it stops [-]. Source: assumed.
        augmentation: In which variants windows are shown.
    """

    batch_size: int = 256
    learning_rate: float = 5e-3
    weight_decay: float = 1e-4
    largest_gradient: float = 1.0
    num_steps: int = 5000
    steps_per_check: int = 500
    patience: int = 5
    augmentation: AugmentationParameters = AugmentationParameters()


DEFAULTS = FitParameters()

_ONE_IN = 2
"""One in so many validation recordings is looked at, to save time."""

_FEW = 12
"""The same for those from which signals are taken away."""


class CurvePoint(NamedTuple):
    """One look at the validation drivers.

    Attributes:
        step: Of the training.
        training_loss: Mean since the last look [nat].
        validation_log_loss: All samples, mean over the variants [nat].
        validation_pr_auc: All samples with all signals [-].
        pr_auc: Of each variant [-].
    """

    step: int
    training_loss: float
    validation_log_loss: float
    validation_pr_auc: float
    pr_auc: dict[str, float]


class Fit(NamedTuple):
    """A fitted network.

    Attributes:
        weights: The best on the validation drivers.
        best: Where they stood.
        curve: All looks.
    """

    weights: NetworkWeights
    best: CurvePoint
    curve: list[CurvePoint]


def weighted_loss(
    weights: TrainedWeights, windows: jax.Array, positive: jax.Array, weight: jax.Array
) -> jax.Array:
    """Log loss [nat], each window by its weight."""
    each = optax.sigmoid_binary_cross_entropy(logits(weights, windows), positive)
    return jnp.sum(weight * each) / jnp.sum(weight)


@cache
def _rule(parameters: FitParameters) -> tuple[optax.GradientTransformation, Any]:
    """How weights go down the slope, and a compiled step; fits alike share it."""
    rule = optimiser(parameters)

    @jax.jit
    def update(weights: TrainedWeights, memory: Any, batch: Any) -> Any:
        loss, slope = jax.value_and_grad(weighted_loss)(weights, *batch)
        change, memory = rule.update(slope, memory, weights)
        return optax.apply_updates(weights, change), memory, loss

    return rule, update


def descend(
    weights: TrainedWeights,
    data: Windows,
    scale: Scaling,
    seed: int,
    parameters: FitParameters,
) -> Iterator[tuple[TrainedWeights, jax.Array]]:
    """Weights and loss after each step."""
    rule, update = _rule(parameters)
    memory = rule.init(weights)
    drawn = batches(data, scale, parameters.batch_size, seed, parameters.augmentation)
    for batch in drawn:
        weights, memory, loss = update(weights, memory, tuple(batch))
        yield weights, loss


def look(
    weights: NetworkWeights,
    recordings: Sequence[Recording],
    variants: Sequence[str],
    step: int,
    training_loss: float,
) -> CurvePoint:
    """Judge weights on whole recordings, in each variant.

    Args:
        weights: To judge.
        recordings: Of drivers who do not train.
        variants: Names of `features.VARIANTS`, the one with most signals first.
        step: Of the training.
        training_loss: Mean since the last look [nat].
    """
    predict = partial(our_probabilities, weights)
    found = {}
    for variant in variants:
        chosen = recordings[:: _ONE_IN if variant == variants[0] else _FEW]
        seen = [lacking(one, VARIANTS[variant]) for one in chosen]
        found[variant] = sample_scores(*judged_samples(verdicts(predict, seen)), 0.5)
    return CurvePoint(
        step=step,
        training_loss=training_loss,
        validation_log_loss=float(np.mean([s["log_loss"] for s in found.values()])),
        validation_pr_auc=found[variants[0]]["pr_auc"],
        pr_auc={variant: scores["pr_auc"] for variant, scores in found.items()},
    )


def fit(
    data: Windows,
    scaling: Scaling,
    validation: Sequence[Recording],
    hidden: int,
    seed: int,
    parameters: FitParameters = DEFAULTS,
    progress: Callable[[int], None] | None = None,
) -> Fit:
    """Train one network.

    Args:
        data: Training windows.
        scaling: Of their signals.
        validation: Recordings of other drivers.
        hidden: Size of the hidden state.
        seed: Of the first weights and the order of the windows.
        parameters: How long and how fast.
        progress: Told after each look how many steps were done.
    """
    prevalence = float(np.average(data.positive, weights=data.weight))
    variants = trained_variants(parameters.augmentation)
    start = initial_weights(hidden, prevalence, seed)
    curve: list[CurvePoint] = []
    best: Fit | None = None
    losses: list[jax.Array] = []
    steps = descend(start, data, scaling, seed, parameters)
    for step, (weights, loss) in enumerate(steps, 1):
        losses.append(loss)
        if step % parameters.steps_per_check and step < parameters.num_steps:
            continue
        network = network_weights(weights, scaling)
        mean_loss = float(np.mean(jax.device_get(losses)))
        curve.append(look(network, validation, variants, step, mean_loss))
        if best is None or _loss(curve[-1]) < _loss(best.best):
            best = Fit(weights=network, best=curve[-1], curve=curve)
        if progress:
            progress(len(losses))
        losses = []
        if step >= parameters.num_steps or _stalled(curve, parameters.patience):
            break
    assert best is not None  # the first look is always the best so far
    return best


def trained_variants(augmentation: AugmentationParameters) -> list[str]:
    """Names of the variants that windows are shown in."""
    each = zip(VARIANTS, shares(augmentation), strict=True)
    return [variant for variant, share in each if share > 0.0]


def _loss(point: CurvePoint) -> float:
    return point.validation_log_loss


def _stalled(curve: Sequence[CurvePoint], patience: int) -> bool:
    """Whether the last looks brought nothing better."""
    place = int(np.argmin([_loss(point) for point in curve]))
    return len(curve) - 1 - place >= patience
