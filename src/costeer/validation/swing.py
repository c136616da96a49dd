"""Whether a signal swings for long: how much of it is found again a period later.

A driver who lets go what is good enough moves the wheel again and again, by single
corrections, so that the size of the movement alone tells nothing. An oscillation is
what repeats: of a sustained one all is found again one period later, of a growing one
more, of a decaying one as much as its damping leaves, of corrections at random times
next to nothing. That is how loops that oscillate are found in recordings of plants:
by the decay of the autocorrelation from one of its peaks to the next (Miao and Seborg
1999, excessive from a half on).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.loop.parameters import DT

LEAST_DAMPING = 0.1
"""Damping ratio that no swing falls below [-]. Assumed: each is half of the last."""

MOST_KEPT = float(
    np.exp(-2.0 * np.pi * LEAST_DAMPING / np.sqrt(1.0 - LEAST_DAMPING**2))
)
"""Share of a swing that may be left a period later [-], 0.53: that of a damping ratio
of 0.1. Miao and Seborg (1999) call a loop oscillating from 0.5 on."""

SLOWEST_SWING = 0.5
"""Slower motion than this is drift, not a swing [rad/s]."""

_LONGEST = round(2.0 * np.pi / SLOWEST_SWING / DT)


def without_drift(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """The signal without its mean over the longest period, shorter by that [its unit].

    Args:
        signal: Of control steps, shape `(time,)`.

    Raises:
        ValueError: If it is shorter than three of the longest periods.
    """
    if len(signal) < 3 * _LONGEST:
        raise ValueError(
            f"the signal lasts {len(signal) * DT:.1f} s; give at least "
            f"{3 * _LONGEST * DT:.1f} s, three periods of the slowest swing"
        )
    mean = np.convolve(signal, np.full(_LONGEST, 1.0 / _LONGEST), "valid")
    half = _LONGEST // 2
    return np.asarray(signal[half : half + len(mean)] - mean)


def _kept(swing: NDArray[np.float64], lag: int) -> Real:
    """Correlation with itself a lag later, times the share of its size that is left."""
    before, after = swing[:-lag], swing[lag:]
    size, left = float(np.linalg.norm(before)), float(np.linalg.norm(after))
    return float(before @ after) / max(size * max(size, left), 1e-30)


def kept_after_a_period(signal: NDArray[np.float64]) -> Real:
    """Share of a signal that is found again after its period [-].

    The period is that of the largest share, of all lags from the first at which the
    signal is opposite to itself to the longest.

    Args:
        signal: Of control steps, shape `(time,)`, at least 38 s.

    Returns:
        1 for an oscillation that lasts or grows, exp(-2 pi z / sqrt(1 - z²)) for a
        swing of damping ratio z, about 0 for what does not repeat.

    Raises:
        ValueError: If it is too short.
    """
    swing = without_drift(signal)
    kept = np.array([_kept(swing, lag) for lag in range(1, _LONGEST + 1)])
    turned = np.flatnonzero(kept < 0.0)
    return float(kept[turned[0] :].max(initial=0.0)) if turned.size else 0.0
