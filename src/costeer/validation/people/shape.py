"""How a lane change runs: its shape beside the quintic of least jerk.

s(u) = 10 u³ - 15 u⁴ + 6 u⁵. A lane change is seen while its lateral speed exceeds
0.1 m/s, which cuts both ends off. Between these instants time and displacement are
normalised, and the quintic is cut at the same speed: the whole of it (duration T,
displacement D) follows from what is seen. Held against the quintic that is not cut,
even a quintic of 3.5 m in 6 s differs by 3 %; that reading is not used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from costeer.base.array import Real
from costeer.study.crossings import excursion
from costeer.study.definitions import DEFAULTS, Signal
from costeer.study.manoeuvres import speed_measures
from costeer.study.segments import LaneChange

SHAPE_POINTS = 51
"""Samples of a normalised lane change."""

LEAST_DISPLACEMENT = 2.0
"""Less than this between onset and end is no lane change [m]. Source: assumed; a
tracked vehicle that leaves the picture or is lost shows half of one."""


class ChangeMeasures(NamedTuple):
    """One lane change by its lateral speed.

    Attributes:
        duration: With the lateral speed above 0.1 m/s [s].
        onset_to_peak: From there to the largest lateral speed, which stands for the
            crossing where no line is known [s].
        peak_speed: Largest lateral speed [m/s].
        displacement: Between onset and end [m].
        shape: Normalised position at even times, shape `(point,)` [-].
        shape_error: The same minus the quintic, shape `(point,)` [-].
    """

    duration: Real
    onset_to_peak: Real
    peak_speed: Real
    displacement: Real
    shape: NDArray[np.float64]
    shape_error: NDArray[np.float64]


def quintic(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normalised position of a lane change of least jerk at a share of its time [-]."""
    return np.asarray(share**3 * (10.0 - 15.0 * share + 6.0 * share**2))


def whole_quintic(
    duration: Real, displacement: Real, threshold: Real
) -> tuple[Real, Real, Real]:
    """The quintic whose part faster than a threshold is as long and wide as given.

    Args:
        duration: Of the part [s].
        displacement: In the part [m]; on average faster than the threshold.
        threshold: Lateral speed [m/s].

    Returns:
        Share of its time that is cut off at either end [-], its whole duration [s]
        and displacement [m].
    """

    def seen(cut: Real) -> Real:
        return float(1.0 - 2.0 * quintic(np.array(cut)))

    def excess(cut: Real) -> Real:
        slope = 30.0 * cut**2 * (1.0 - cut) ** 2
        return slope * displacement * (1.0 - 2.0 * cut) / duration - threshold * seen(
            cut
        )

    # Towards the middle the excess tends to zero from above: stop short of it.
    cut = float(brentq(excess, 0.0, 0.499))
    return cut, duration / (1.0 - 2.0 * cut), displacement / seen(cut)


def change_measures(
    time: Signal, position: Signal, speed: Signal, instant: Real
) -> ChangeMeasures | None:
    """Measure a lane change by its lateral speed, as the study's measures do.

    Args:
        time: Shape `(time,)` [s].
        position: Towards the new lane, shape `(time,)` [m].
        speed: Towards the new lane, shape `(time,)` [m/s].
        instant: A time inside the lane change [s].

    Returns:
        None if the record lacks the onset or the end, or if the displacement is too
        small for a lane change.
    """
    span = excursion(time, speed, DEFAULTS.lateral_speed_threshold, instant)
    if span is None or not np.isfinite(span).all():
        return None
    inside = np.flatnonzero((time >= span[0]) & (time <= span[1]))
    at, peak = np.interp(span, time, position), inside[np.argmax(speed[inside])]
    if at[1] - at[0] < LEAST_DISPLACEMENT:
        return None
    change = LaneChange(1, 1, span[0], float(time[peak]), span[1], lane=1)
    found = speed_measures({"time": time}, speed, change)
    shape, error = _shape(time, position, span)
    return ChangeMeasures(
        duration=found["duration_by_speed"],
        onset_to_peak=found["onset_to_crossing"],
        peak_speed=found["peak_lateral_speed"],
        displacement=float(at[1] - at[0]),
        shape=shape,
        shape_error=error,
    )


def _shape(
    time: Signal, position: Signal, span: tuple[Real, Real]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Normalised position between two instants, and its distance to the quintic."""
    share = np.linspace(0.0, 1.0, SHAPE_POINTS)
    duration = span[1] - span[0]
    at = np.interp(span[0] + share * duration, time, position)
    displacement = float(at[-1] - at[0])
    shape = (at - at[0]) / displacement
    cut, _, _ = whole_quintic(duration, displacement, DEFAULTS.lateral_speed_threshold)
    ends = quintic(np.array([cut, 1.0 - cut]))
    reference = quintic(cut + share * (1.0 - 2.0 * cut)) - ends[0]
    return shape, shape - reference / (ends[1] - ends[0])


def rms(values: NDArray[np.float64]) -> Real:
    """Root mean square over all axes; NaN without values."""
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else float("nan")


def mean_shape_rms(shape_errors: NDArray[np.float64]) -> Real:
    """RMS difference of the mean shape of several changes from their quintics [-].

    Args:
        shape_errors: Shape `(change, point)`.
    """
    return rms(shape_errors.mean(axis=0)) if shape_errors.size else float("nan")
