"""Threshold on the time to lane crossing.

Time to lane crossing is distance over the velocity towards the line, as Tsoi, Mulder
and Abbink (2010), Balancing safety and support: changing lanes with a haptic
lane-keeping support system, IEEE SMC, take it to tell that the driver wants to leave
the lane; the measure is Godthelp, Milgram and Blaauw's (1984). Our reading: constant
speed and heading, and the velocity passed through a first-order lag, because a moment's
yaw towards the line is no lane change. The probability falls with the logarithm of
that time, so that each threshold on it is a threshold on the time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    SAMPLE_RATE,
    WINDOW_LENGTH,
    full_windows,
)
from costeer.intention.gru import sigmoid
from costeer.intention.predictors.summary import line_approach, trailing_mean

NEEDS = ("longitudinal_velocity", "distance_to_adjacent_lane", "yaw_angle")

SHORTEST, LONGEST = 0.05, 60.0
"""Between these the time to lane crossing is held [s]. Source: assumed; a car that
does not approach the line has the longest."""


class LineTimeWeights(NamedTuple):
    """What is fitted.

    Attributes:
        time_constant: Of the lag on the approach velocity [s], 0 for none, `(1,)`.
        intercept: Logit at a time to lane crossing of 1 s [-], `(1,)`.
        slope: Of the logit over the natural logarithm of the time [-], `(1,)`.
    """

    time_constant: NDArray[np.float64]
    intercept: NDArray[np.float64]
    slope: NDArray[np.float64]


def expected_shapes(weights: LineTimeWeights) -> dict[str, tuple[int, ...]]:
    """Shape that each array must have."""
    return dict.fromkeys(weights._fields, (1,))


def lag(time_constant: float) -> NDArray[np.float64]:
    """Weights of a first-order lag over a window, newest sample first, `(time,)`.

    The lag's response, cut after 180 samples and made to sum to 1, so that a verdict
    depends on its window only.
    """
    age = np.arange(WINDOW_LENGTH) / SAMPLE_RATE
    weight = np.exp(-age / max(time_constant, 1e-6))
    return np.asarray(weight / weight.sum())


def time_to_lane_crossing(
    features: NDArray[np.float64], time_constant: float
) -> NDArray[np.float64]:
    """Distance to the line over the lagged velocity towards it [s].

    Args:
        features: Facing right, shape `(time, feature)`.
        time_constant: Of the lag [s].

    Returns:
        Within `SHORTEST` and `LONGEST`, shape `(time,)`.
    """
    finite = np.nan_to_num(features, posinf=0.0, neginf=0.0)
    velocity, distance, yaw = (finite[:, FEATURES.index(name)] for name in NEEDS)
    approach = trailing_mean(line_approach(velocity, yaw), lag(time_constant))
    slowest = np.maximum(distance, 0.0) / LONGEST + 1e-9
    return np.clip(distance / np.maximum(approach, slowest), SHORTEST, LONGEST)


def crossing_probabilities(
    weights: LineTimeWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Probability of a crossing within 3 s at every sample.

    Args:
        weights: As fitted.
        features: Facing right, NaN where missing, shape `(time, feature)`.
        absent: Signals that the recording does not have.

    Returns:
        Shape `(time,)`; NaN where no full window ends or a signal is absent.
    """
    if set(NEEDS) & set(absent):
        return np.full(len(features), np.nan)
    time = time_to_lane_crossing(features, float(weights.time_constant[0]))
    said = sigmoid(weights.intercept[0] + weights.slope[0] * np.log(time))
    return np.where(full_windows(features, absent), said, np.nan)
