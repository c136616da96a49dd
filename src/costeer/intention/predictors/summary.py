"""A window in few numbers, for predictors that have no memory of their own.

Channels are the signals of Eq. (1) and what follows from them by plain geometry: the
velocity towards the line, where the car would be after a while if it went on like that,
the inverse of the time to the line, and the turning that the wheel asks for. Each is
summarised by its last value, means over 0.5, 1 and 3 s, extremes of the window and
slope of the last second. Every number is a function of the last 180 samples only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from costeer.intention.features import (
    FEATURES,
    SAMPLE_RATE,
    WINDOW_LENGTH,
    approach_velocity,
    scaled,
)

Signals = dict[str, NDArray[np.float64]]

NEAREST_LINE = 0.3
"""Distance that the inverse time to the line is never computed with less of [m].
Source: assumed, keeps it bounded at the crossing."""

STATISTICS = ("last", "mean_half", "mean_one", "mean", "lowest", "highest", "slope")


class Channel(NamedTuple):
    """A signal, or what follows from several at the same sample.

    Attributes:
        needs: Signals of Eq. (1).
        value: From these by name, shape `(time,)` each.
    """

    needs: tuple[str, ...]
    value: Callable[[Signals], NDArray[np.float64]]


def line_approach(
    velocity: NDArray[np.float64], yaw: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Velocity towards the line at each sample [m/s], facing right."""
    towards: Any = approach_velocity(cast("Any", velocity), cast("Any", yaw))
    return np.asarray(towards)  # Any: an equation of scalars, given arrays


def _approach(signals: Signals) -> NDArray[np.float64]:
    return line_approach(signals["longitudinal_velocity"], signals["yaw_angle"])


def _signal(name: str) -> Channel:
    return Channel((name,), lambda signals: signals[name])


def _distance_after(seconds: float) -> Callable[[Signals], NDArray[np.float64]]:
    return lambda s: s["distance_to_adjacent_lane"] - seconds * _approach(s)


def _inverse_time(signals: Signals) -> NDArray[np.float64]:
    distance = np.maximum(signals["distance_to_adjacent_lane"], NEAREST_LINE)
    return np.asarray(np.maximum(_approach(signals), 0.0) / distance)


_MOTION = ("longitudinal_velocity", "yaw_angle")
_PLACE = (*_MOTION, "distance_to_adjacent_lane")

CHANNELS: dict[str, Channel] = {
    **{name: _signal(name) for name in FEATURES},
    "approach_velocity": Channel(_MOTION, _approach),
    "distance_after_one_and_a_half": Channel(_PLACE, _distance_after(1.5)),
    "distance_after_three": Channel(_PLACE, _distance_after(3.0)),
    "inverse_line_time": Channel(_PLACE, _inverse_time),
    "turning": Channel(
        ("longitudinal_velocity", "steering_wheel_angle"),
        lambda s: s["longitudinal_velocity"] * s["steering_wheel_angle"],
    ),
}


def channels_of(signals: tuple[str, ...]) -> tuple[str, ...]:
    """Channels that follow from these signals."""
    return tuple(n for n, c in CHANNELS.items() if set(c.needs) <= set(signals))


def summary_names(signals: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the columns of `summary`, as "yaw_angle slope"."""
    return tuple(f"{c} {s}" for c in channels_of(signals) for s in STATISTICS)


def bounded(
    features: NDArray[np.float64],
    mean: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Features held within ±10 standard deviations; the mean where one is missing.

    Args:
        features: Shape `(time, feature)`.
        mean: Of the training set, shape `(feature,)`.
        scale: Standard deviations of the training set, shape `(feature,)`.
    """
    return np.asarray(mean + scale * np.nan_to_num(scaled(features, mean, scale)))


def trailing_mean(
    values: NDArray[np.float64], weight: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Weighted mean over the last samples, along the first axis.

    Args:
        values: Shape `(time,)`.
        weight: Of the newest sample first, shape `(length,)`; sums to what it should.
    """
    return np.convolve(values, weight)[: len(values)]


def _statistics(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """The columns of `STATISTICS` of one channel, shape `(time,)` each."""
    second = round(SAMPLE_RATE)
    newest = (WINDOW_LENGTH - 1) // 2
    age = np.arange(second) - (second - 1) / 2.0
    slope = -age / (age @ age) * SAMPLE_RATE
    return [
        values,
        *(trailing_mean(values, np.full(n, 1.0 / n)) for n in (second // 2, second)),
        trailing_mean(values, np.full(WINDOW_LENGTH, 1.0 / WINDOW_LENGTH)),
        minimum_filter1d(values, WINDOW_LENGTH, origin=newest),
        maximum_filter1d(values, WINDOW_LENGTH, origin=newest),
        trailing_mean(values, slope),
    ]


def summary(
    features: NDArray[np.float64], signals: tuple[str, ...]
) -> NDArray[np.float64]:
    """What the windows that end at each sample look like.

    Args:
        features: All finite, facing right, shape `(time, feature)`.
        signals: Those that may be looked at.

    Returns:
        In the units of the channels, shape `(time, summary)`, columns as
        `summary_names` has them; the first 179 rows look back over the start and mean
        nothing.
    """
    by_name = {name: features[:, FEATURES.index(name)] for name in signals}
    columns = [
        column
        for name in channels_of(signals)
        for column in _statistics(CHANNELS[name].value(by_name))
    ]
    return np.stack(columns, axis=-1)
