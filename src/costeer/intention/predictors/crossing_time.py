"""Time to crossing by an LSTM, after Dang et al. (2017).

Dang, Zheng, Wang, Zhao, Li, Time-to-lane-change prediction with deep learning, IEEE
Intelligent Transportation Systems Conference 2017: a network of long short-term memory
estimates the time until the car crosses the line, and a lane change is expected when it
falls below a horizon. Our reading:

- *Inputs*: what is known of driver and car, the signals of Eq. (1) with the velocity
  towards the line, over the same window of 3 s. Three samples are averaged to one,
  20 Hz: a third of the steps, and every sample still has its own window.
- *Target*: the time to the crossing, at most a horizon; a car that does not cross has
  the horizon.
- *Probability*: a logistic function of the estimated time, so that each threshold on it
  is a threshold on the time.

Gates of the LSTM are stacked in the order input, forget, cell, output:

    c' = sigmoid(f) c + sigmoid(i) tanh(g)        h' = sigmoid(o) tanh(c')
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    WINDOW_LENGTH,
)
from costeer.intention.gru import sigmoid
from costeer.intention.predictors.summary import bounded, line_approach, trailing_mean
from costeer.intention.predictors.variants import by_variant

Singles = NDArray[np.float32]

NEEDS = (
    "longitudinal_acceleration",
    "longitudinal_velocity",
    "distance_to_adjacent_lane",
    "yaw_angle",
)
"""Signals of the variant "motion"; with head and wheel the full one speaks."""

SAMPLES_PER_STEP = 3
NUM_STEPS = WINDOW_LENGTH // SAMPLES_PER_STEP

BLOCK = 2048
"""Windows that are advanced at a time, so that their states stay in the cache [-]."""


class CrossingTimeWeights(NamedTuple):
    """A network and what its answer means.

    Attributes:
        feature_mean: Of the training set, in the signals' units, `(feature,)`.
        feature_scale: Standard deviations of the training set, `(feature,)`.
        input_mean: Of the inputs on the training set, in their units, `(input,)`.
        input_scale: Standard deviations of the inputs, `(input,)`.
        input_weights: Gates side by side [-], `(input, 4 * hidden)`.
        bias: `(4 * hidden,)` [-].
        hidden_weights: `(hidden, 4 * hidden)` [-].
        output_weights: From the last hidden state to the logit of the share of the
            horizon that is left [-], `(hidden,)`.
        output_bias: Of that logit [-], `(1,)`.
        horizon: Longest time that it estimates [s], `(1,)`.
        logistic: Intercept [-] and slope [1/s] of the crossing's logit over the
            estimated time, `(2,)`.
    """

    feature_mean: NDArray[np.float64]
    feature_scale: NDArray[np.float64]
    input_mean: NDArray[np.float64]
    input_scale: NDArray[np.float64]
    input_weights: Singles
    bias: Singles
    hidden_weights: Singles
    output_weights: Singles
    output_bias: Singles
    horizon: NDArray[np.float64]
    logistic: NDArray[np.float64]


def expected_shapes(weights: CrossingTimeWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    hidden, inputs = weights.output_weights.size, weights.input_mean.size
    return {
        "feature_mean": (NUM_FEATURES,),
        "feature_scale": (NUM_FEATURES,),
        "input_mean": (inputs,),
        "input_scale": (inputs,),
        "input_weights": (inputs, 4 * hidden),
        "bias": (4 * hidden,),
        "hidden_weights": (hidden, 4 * hidden),
        "output_weights": (hidden,),
        "output_bias": (1,),
        "horizon": (1,),
        "logistic": (2,),
    }


def raw_inputs(
    features: NDArray[np.float64], signals: tuple[str, ...]
) -> NDArray[np.float64]:
    """Signals and velocity towards the line, averaged over three samples.

    Args:
        features: All finite, facing right, shape `(time, feature)`.
        signals: Those that the network takes, velocity and yaw among them.

    Returns:
        In the signals' units, shape `(time, input)`.
    """
    columns = [features[:, FEATURES.index(name)] for name in signals]
    velocity, yaw = (
        features[:, FEATURES.index(n)] for n in ("longitudinal_velocity", "yaw_angle")
    )
    columns.append(line_approach(velocity, yaw))
    share = np.full(SAMPLES_PER_STEP, 1.0 / SAMPLES_PER_STEP)
    return np.stack([trailing_mean(values, share) for values in columns], axis=-1)


def step_rows(ends: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rows of `raw_inputs` that the windows ending at `ends` take, `(window, step)`."""
    back = np.arange(1 - NUM_STEPS, 1) * SAMPLES_PER_STEP
    return ends[:, None] + back


def _advance(gates: Singles, cell: Singles) -> tuple[Singles, Singles]:
    """New hidden state and cell from the gates' inputs, `(window, hidden)` each."""
    hidden = cell.shape[1]
    entering, kept, shown = (
        sigmoid(gates[:, g * hidden : (g + 1) * hidden]) for g in (0, 1, 3)
    )
    new_cell = kept * cell + entering * np.tanh(gates[:, 2 * hidden : 3 * hidden])
    return np.asarray(shown * np.tanh(new_cell)), np.asarray(new_cell)


def estimated_times(
    weights: CrossingTimeWeights,
    inputs: NDArray[np.float64],
    ends: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Time to the crossing of the windows that end at `ends` [s].

    Args:
        weights: Of the network.
        inputs: `raw_inputs`, shape `(time, input)`.
        ends: Rows, each at least 179, shape `(window,)`.

    Returns:
        Up to the horizon, shape `(window,)`.
    """
    scaled = ((inputs - weights.input_mean) / weights.input_scale).astype(np.float32)
    projected = scaled @ weights.input_weights + weights.bias
    share = np.empty(len(ends))
    for start in range(0, len(ends), BLOCK):
        rows = step_rows(ends[start : start + BLOCK]).T
        hidden = np.zeros((rows.shape[1], weights.output_weights.size), np.float32)
        cell = np.zeros_like(hidden)
        for step in rows:
            gates = projected[step] + hidden @ weights.hidden_weights
            hidden, cell = _advance(gates, cell)
        logit = hidden @ weights.output_weights + weights.output_bias[0]
        share[start : start + BLOCK] = sigmoid(logit)
    return np.asarray(weights.horizon[0] * share)


def _verdict(
    weights: CrossingTimeWeights,
    signals: tuple[str, ...],
    features: NDArray[np.float64],
) -> NDArray[np.float64]:
    held = bounded(features, weights.feature_mean, weights.feature_scale)
    ends = np.arange(WINDOW_LENGTH - 1, len(features))
    said = np.full(len(features), np.nan)
    time = estimated_times(weights, raw_inputs(held, signals), ends)
    said[ends] = sigmoid(weights.logistic[0] + weights.logistic[1] * time)
    return said


crossing_probabilities = by_variant(_verdict)
"""Probability of a crossing within 3 s at every sample, from weights by variant."""
