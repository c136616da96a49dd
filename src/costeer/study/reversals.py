"""Steering-wheel reversals after Markkula and Engström (2006).

The angle is low-passed, forwards and backwards, and reduced to its first sample and
its stationary points. A reversal to the left is a rise by more than the gap above the
lowest stationary point since the last one; to the right likewise, in the mirror.
Written from the publication; the counts equal those of the authors' program on the
90 cases of tests/data/swrr_reference.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.signal import butter, filtfilt

from costeer.study.definitions import (
    DEFAULTS,
    Measure,
    MeasureParameters,
    Signal,
    unknown,
)

# As many samples as the authors' program mirrors at either end of the signal.
_PADDING = 6
MINIMUM_SAMPLES = _PADDING + 1


def low_passed(
    angle: Float[Signal, " time"], rate: float, cutoff: float
) -> Float[Signal, " time"]:
    """Second-order Butterworth, run forwards and backwards, so without delay.

    Args:
        angle: Steering-wheel angle, any unit, shape `(time,)`.
        rate: Samples per second [Hz].
        cutoff: Corner frequency of one pass [Hz]; 0 leaves the angle as it is.

    Raises:
        ValueError: If the cutoff is not below half the sampling rate or the signal
            is too short.
    """
    if cutoff == 0.0:
        return angle
    if not 0.0 < cutoff < rate / 2.0:
        raise ValueError(
            f"a cutoff of {cutoff:g} Hz does not fit {rate:g} samples per second; "
            f"choose 0 or a value below {rate / 2.0:g} Hz"
        )
    if angle.size < MINIMUM_SAMPLES:
        raise ValueError(
            f"{angle.size} samples are too few to filter; give {MINIMUM_SAMPLES}"
        )
    numerator, denominator = butter(2, cutoff / (rate / 2.0))
    return np.asarray(filtfilt(numerator, denominator, angle, padlen=_PADDING))


def stationary_values(angle: Float[Signal, " time"]) -> Float[Signal, " value"]:
    """The first sample and all where the slope changes sign or is zero, in order.

    A plateau counts with every sample, as in the authors' program: on a quantised,
    unfiltered angle each step of a staircase can be a reversal of its own.
    """
    slope = np.sign(np.diff(angle))
    turning = np.flatnonzero(slope[1:] * slope[:-1] <= 0.0) + 1
    return np.concatenate([angle[:1], angle[turning]])


def count_reversals(angle: Float[Signal, " time"], gap: float) -> int:
    """Number of reversals in both directions that exceed a gap.

    Args:
        angle: Low-passed angle, any unit, shape `(time,)`.
        gap: In the same unit; strictly exceeded.
    """
    values = stationary_values(angle)
    return _rises(values.tolist(), gap) + _rises((-values).tolist(), gap)


def _rises(values: list[float], gap: float) -> int:
    count, lowest = 0, values[0] if values else 0.0
    for value in values:
        if value - lowest > gap:
            count, lowest = count + 1, value
        elif value < lowest:
            lowest = value
    return count


def steering_wheel_reversal_rate(
    stretches: Sequence[Signal],
    rate: float,
    parameters: MeasureParameters = DEFAULTS,
) -> Measure:
    """Reversals per minute over stretches that are filtered each by itself.

    Args:
        stretches: Steering-wheel angle [rad], shape `(time,)` each. Those too short
            to filter are left out.
        rate: Samples per second [Hz].
        parameters: Gap [rad] and cutoff [Hz].

    Returns:
        Sum of reversals over sum of minutes [1/min].
    """
    long_enough = [angle for angle in stretches if angle.size >= MINIMUM_SAMPLES]
    if not long_enough:
        return unknown("1/min", "no stretch of lane keeping is long enough to filter")
    if parameters.reversal_cutoff >= rate / 2.0:
        return unknown("1/min", _too_slow(rate, parameters.reversal_cutoff))
    count = sum(
        count_reversals(
            low_passed(angle, rate, parameters.reversal_cutoff),
            parameters.reversal_angle,
        )
        for angle in long_enough
    )
    seconds = sum(angle.size - 1 for angle in long_enough) / rate
    return Measure(value=60.0 * count / seconds, unit="1/min")


def _too_slow(rate: float, cutoff: float) -> str:
    return f"{rate:g} samples per second are too few for a {cutoff:g} Hz low-pass"
