"""Fit of the LSTM that estimates the time to crossing; needs JAX and Optax."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import SAMPLE_RATE
from costeer.intention.predictors.crossing_time import (
    CrossingTimeWeights,
    estimated_times,
    raw_inputs,
    step_rows,
)
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.summary import bounded
from costeer.intention.predictors.variants import held_head, signals_of
from costeer.training.dataset import DatasetParameters, Split
from costeer.training.labels import time_to_crossing
from costeer.training.predictors.descent import (
    Descent,
    DescentParameters,
    batch_rows,
    descend,
)
from costeer.training.predictors.logit import fit_logit, logit_loss
from costeer.training.predictors.samples import (
    Answers,
    FeatureScaling,
    chosen_rows,
    joined,
    number_scaling,
)
from costeer.training.recordings import Recording


class CrossingTimeParameters(NamedTuple):
    """What is fitted and what the validation drivers choose from.

    Attributes:
        variants: Keys of `features.VARIANTS` [-]. Source: assumed, with driver and
            without.
        hidden_size: Units of the LSTM [-]. Source: assumed, small enough for a
            verdict at every sample of a long recording.
        horizons: Longest times that are estimated [s]. Source: assumed; a short one
            spends the network on the decision at 3 s.
        descent: How long and how fast to learn.
    """

    variants: tuple[str, ...] = ("full", "motion")
    hidden_size: int = 16
    horizons: tuple[float, ...] = (5.0, 10.0)
    descent: DescentParameters = DescentParameters()


DEFAULTS = CrossingTimeParameters()


class Cells(NamedTuple):
    """Weights as the descent changes them; fields as in `CrossingTimeWeights`."""

    input_weights: Any
    bias: Any
    hidden_weights: Any
    output_weights: Any
    output_bias: Any


class Windows(NamedTuple):
    """Windows of several recordings.

    Attributes:
        inputs: `raw_inputs` of all recordings, one after another, `(time, input)`.
        ends: Row of each window's last sample, `(window,)`.
        time: To the crossing [s], infinite where there is none, `(window,)`.
        answers: Of the windows.
    """

    inputs: NDArray[np.float64]
    ends: NDArray[np.int64]
    time: NDArray[np.float64]
    answers: Answers


def crossing_windows(
    recordings: Sequence[Recording],
    signals: tuple[str, ...],
    scaling: FeatureScaling,
    dataset: DatasetParameters,
    horizon: float,
) -> Windows:
    """Windows whose time to crossing is known up to the horizon.

    Raises:
        ValueError: If no recording has the signals.
    """
    parts, offset = [], 0
    for one in recordings:
        if set(signals) & set(one.absent):
            continue
        parts.append(_windows_of(one, signals, scaling, dataset, horizon))
        parts[-1] = parts[-1]._replace(ends=parts[-1].ends + offset)
        offset += len(one.features)
    if not parts:
        raise ValueError(f"no recording has all of {', '.join(signals)}")
    return Windows(
        inputs=np.concatenate([part.inputs for part in parts]),
        ends=np.concatenate([part.ends for part in parts]),
        time=np.concatenate([part.time for part in parts]),
        answers=joined([part.answers for part in parts]),
    )


def _windows_of(
    recording: Recording,
    signals: tuple[str, ...],
    scaling: FeatureScaling,
    dataset: DatasetParameters,
    horizon: float,
) -> Windows:
    held, seen = held_head(recording.features)
    time = time_to_crossing(recording.crossing, recording.side)
    rows, answers = chosen_rows(recording, dataset)
    ahead = (len(time) - rows) / SAMPLE_RATE
    known = np.isfinite(time[rows]) | (ahead > horizon)
    known &= seen[rows] | ("head_yaw" not in signals)
    return Windows(
        inputs=raw_inputs(bounded(held, *scaling), signals),
        ends=rows[known],
        time=time[rows[known]],
        answers=Answers(answers.positive[known], answers.weight[known]),
    )


def share_logits(cells: Cells, windows: jax.Array) -> jax.Array:
    """Logit of the share of the horizon that is left.

    Args:
        cells: Of the network.
        windows: Scaled inputs, shape `(window, step, input)`.

    Returns:
        Shape `(window,)`.
    """
    hidden_size = cells.output_weights.shape[0]

    @jax.checkpoint
    def step(state: Any, inputs: jax.Array) -> Any:
        hidden, cell = state
        gates = (
            inputs @ cells.input_weights + cells.bias + hidden @ cells.hidden_weights
        )
        entering, kept, new, shown = jnp.split(gates, 4, axis=1)
        cell = jax.nn.sigmoid(kept) * cell + jax.nn.sigmoid(entering) * jnp.tanh(new)
        return (jax.nn.sigmoid(shown) * jnp.tanh(cell), cell), None

    rest = jnp.zeros((windows.shape[0], hidden_size), windows.dtype)
    (hidden, _), _ = jax.lax.scan(step, (rest, rest), jnp.swapaxes(windows, 0, 1))
    logit: jax.Array = hidden @ cells.output_weights + cells.output_bias[0]
    return logit


def initial_cells(num_inputs: int, hidden: int, seed: int) -> Cells:
    """Uniform weights within ±1/√hidden; the gates that keep start open."""
    rng = np.random.default_rng([seed, 5, hidden])
    bound = 1.0 / np.sqrt(hidden)

    def draw(*shape: int) -> jax.Array:
        return jnp.asarray(rng.uniform(-bound, bound, shape), jnp.float32)

    return Cells(
        input_weights=draw(num_inputs, 4 * hidden),
        bias=jnp.asarray(np.repeat([0.0, 1.0, 0.0, 0.0], hidden), jnp.float32),
        hidden_weights=draw(hidden, 4 * hidden),
        output_weights=draw(hidden),
        output_bias=jnp.ones(1),
    )


def fit_crossing_time(
    split: Split,
    scaling: FeatureScaling,
    dataset: DatasetParameters,
    seed: int,
    parameters: CrossingTimeParameters = DEFAULTS,
) -> Baseline:
    """Fit all variants that the recordings have the signals for.

    Args:
        split: Training drivers to learn from, validation drivers to choose by.
        scaling: Of the signals.
        dataset: Which windows are used.
        seed: Of the first weights and the order of windows.
        parameters: What to choose from.

    Raises:
        ValueError: If no recording has the signals of a variant.
    """
    variants, facts = {}, {}
    for variant in parameters.variants:
        signals = signals_of(variant)
        fits, losses = {}, {}
        for horizon in parameters.horizons:
            training, validation = (
                crossing_windows(part, signals, scaling, dataset, horizon)
                for part in (split.training, split.validation)
            )
            fits[horizon], losses[horizon] = _fit(
                training, validation, scaling, horizon, seed, parameters
            )
        best = min(losses, key=lambda horizon: losses[horizon])
        variants[variant] = fits[best]
        facts[variant] = {f"horizon {h:g} s": loss for h, loss in losses.items()}
    return Baseline(variants, {"validation_log_loss": facts})


def _fit(
    training: Windows,
    validation: Windows,
    scaling: FeatureScaling,
    horizon: float,
    seed: int,
    parameters: CrossingTimeParameters,
) -> tuple[CrossingTimeWeights, float]:
    """One network with the logistic over its answers, and its validation log loss."""
    mean, scale = number_scaling(training.inputs, np.ones(len(training.inputs)))
    seen, unseen = (
        part._replace(inputs=(part.inputs - mean) / scale)
        for part in (training, validation)
    )
    descent = descended(seen, unseen, horizon, seed, parameters)
    weights = CrossingTimeWeights(
        feature_mean=scaling.mean,
        feature_scale=scaling.scale,
        input_mean=mean,
        input_scale=scale,
        **{n: np.asarray(v, np.float32) for n, v in descent.weights._asdict().items()},
        horizon=np.array([horizon]),
        logistic=np.array([0.0, -1.0]),
    )
    time = estimated_times(weights, training.inputs, training.ends)
    fit = fit_logit(time[:, None], training.answers)
    logistic = np.array([fit.intercept, *fit.coefficients])
    time = estimated_times(weights, validation.inputs, validation.ends)
    loss = logit_loss(logistic[0] + logistic[1] * time, validation.answers)
    return CrossingTimeWeights(**{**weights._asdict(), "logistic": logistic}), loss


def descended(
    training: Windows,
    validation: Windows,
    horizon: float,
    seed: int,
    parameters: CrossingTimeParameters,
) -> Descent:
    """Cells of one network, from scaled inputs; loss: squared error of the share."""

    def parts(data: Windows, chosen: NDArray[np.int64]) -> tuple[Any, ...]:
        share = np.minimum(data.time[chosen] / horizon, 1.0)
        windows = data.inputs[step_rows(data.ends[chosen])].astype(np.float32)
        return windows, share.astype(np.float32), data.answers.weight[chosen]

    def batches() -> Iterator[tuple[Any, ...]]:
        size = parameters.descent.batch_size
        for chosen in batch_rows(len(training.ends), size, seed):
            yield parts(training, chosen)

    checked = parts(validation, np.arange(len(validation.ends)))
    loss = jax.jit(_loss)
    start = initial_cells(training.inputs.shape[1], parameters.hidden_size, seed)
    return descend(
        _loss,
        start,
        batches(),
        lambda cells: float(loss(cells, *checked)),
        parameters.descent,
    )


def _loss(cells: Cells, windows: Any, share: Any, weight: Any) -> jax.Array:
    error = jax.nn.sigmoid(share_logits(cells, windows)) - share
    return jnp.sum(weight * error**2) / jnp.sum(weight)
