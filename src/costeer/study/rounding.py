"""The rate of a signal that is rounded to a step, as a position in centimetres."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from costeer.study.definitions import Signal

_LEAST_STEP = 1e-4  # [m]; finer steps hardly change a rate
_STILL_SHARE = 0.2  # of the samples of a rounded signal equal the one before
_STEPS = 6.0  # of rounding that a window spans at the usual rate of the signal
_LONGEST_WINDOW = 4.0  # [s]


def rounding(values: Float[Signal, " time"]) -> float:
    """The step to which a signal is rounded; 0 if it is not.

    Args:
        values: Of any unit, shape `(time,)`.
    """
    changes = np.abs(np.diff(values))
    moved = changes[changes > 1e-9]
    if not moved.size or moved.size > (1.0 - _STILL_SHARE) * changes.size:
        return 0.0
    step = float(moved.min())
    off = np.abs(moved / step - np.round(moved / step))
    return step if step >= _LEAST_STEP and off.max() < 1e-3 else 0.0


def rounded_rate(
    time: Float[Signal, " time"], values: Float[Signal, " time"], step: float
) -> Float[Signal, " time"]:
    """Rate of a rounded signal per second.

    Half way between two values the signal is known at the moment of the change; in
    between it is taken as a straight line, and the rate is the slope of a parabola of
    least squares, over as long as the signal usually needs for some steps.

    Args:
        time: Sample times, even [s], shape `(time,)`.
        values: Shape `(time,)`.
        step: To which they are rounded, in their unit.

    Returns:
        Shape `(time,)`.
    """
    from scipy.signal import savgol_filter

    rows = np.flatnonzero(np.diff(values))
    known = np.concatenate([time[:1], (time[rows] + time[rows + 1]) / 2.0, time[-1:]])
    middle = (values[rows] + values[rows + 1]) / 2.0
    level = np.concatenate([middle[:1], middle, middle[-1:]])
    smooth = np.interp(time, known, level)
    period = float(time[-1] - time[0]) / (time.size - 1)
    usual = float(np.abs(np.diff(values)).sum() / (time[-1] - time[0]))
    window = min(_STEPS * step / usual, _LONGEST_WINDOW)
    num = min(
        max(3, 2 * round(window / period / 2.0) + 1), 2 * ((time.size - 1) // 2) + 1
    )
    if num < 3:
        return np.asarray(np.gradient(values, time))
    return np.asarray(savgol_filter(smooth, num, 2, deriv=1, delta=period))
