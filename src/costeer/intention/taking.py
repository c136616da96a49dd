"""From the six signals to the network's inputs, one sample at a time, in compiled code.

features.py says the same for whole recordings.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import compiled, inlined
from costeer.intention.features import (
    FEATURE_LIMIT,
    FEATURES,
    HEAD_YAW,
    NUM_FEATURES,
    NUM_SCALED,
    IntentionSample,
    approach_velocity,
)
from costeer.intention.gru import NetworkWeights

_MEAN, _SCALE, _DISPENSABLE = range(3)
_VELOCITY = FEATURES.index("longitudinal_velocity")
_YAW = FEATURES.index("yaw_angle")
_APPROACH = NUM_FEATURES


def scaling_of(weights: NetworkWeights) -> NDArray[np.float64]:
    """Mean, scale and whether each signal is dispensable: rows of one array, `(3, 7)`.

    One array, because compiled code counts references to each that it is given.
    """
    dispensable = np.append(weights.dispensable > 0.5, False)
    rows = (weights.feature_mean, weights.feature_scale, dispensable)
    return np.array(rows, np.float64)


def absent_flags(absent: tuple[str, ...]) -> NDArray[np.bool_]:
    """Which signals a drive does not have, `(feature,)`."""
    return np.array([name in absent for name in FEATURES])


@compiled
def _deviations(value: float, mean: float, scale: float) -> float:
    """Scale one value as features.py does; NaN is 0, its mean."""
    deviation = (value - mean) / scale
    held = min(max(deviation, -FEATURE_LIMIT), FEATURE_LIMIT)
    return held if held == held else 0.0


@compiled
def _usable(value: float, absent: bool, may_be_lost: bool) -> bool:
    """Whether a signal may enter: absent, finite, or lost where that is borne."""
    return absent or math.isfinite(value) or (may_be_lost and math.isnan(value))


@inlined
def take(
    scaling: NDArray[np.float64],
    absent: NDArray[np.bool_],
    inputs: NDArray[np.float32],
    sample: IntentionSample,
) -> bool:
    """Put signals, flags and approach velocity among the inputs; whether all may enter.

    Args:
        scaling: As `scaling_of` gives it, `(3, 7)`.
        absent: Signals that this drive does not have, `(feature,)`.
        inputs: Filled, `(input,)`.
        sample: Facing right.
    """
    signals = (
        float(sample.head_yaw),
        float(sample.longitudinal_acceleration),
        float(sample.longitudinal_velocity),
        float(sample.steering_wheel_angle),
        float(sample.distance_to_adjacent_lane),
        float(sample.yaw_angle),
    )
    valid = True
    for index in range(NUM_FEATURES):
        value = signals[index]
        missing = absent[index] or math.isnan(value)
        known = math.nan if missing else value
        mean, scale = scaling[_MEAN, index], scaling[_SCALE, index]
        inputs[index] = _deviations(known, mean, scale)
        inputs[NUM_SCALED + index] = 1.0 if missing else 0.0
        may_be_lost = index == HEAD_YAW and scaling[_DISPENSABLE, index] > 0.5
        valid &= _usable(value, absent[index], may_be_lost)
    there = not (absent[_VELOCITY] or absent[_YAW])
    velocity, yaw = signals[_VELOCITY], signals[_YAW]
    approach = approach_velocity(velocity, yaw) if there else math.nan
    mean, scale = scaling[_MEAN, _APPROACH], scaling[_SCALE, _APPROACH]
    inputs[_APPROACH] = _deviations(approach, mean, scale)
    return valid
