"""From the rate of a source to 60 Hz without a look ahead.

A sample at time t may use only rows of the source at or before t. Between two rows the
truth is not known until the second has come, so values are interpolated in a straight
line one source period late. The other way, to hold the last row, is as late on average
by half a period, and turns a ramp into stairs, which no steering wheel and no camera
at 60 Hz would show. Nothing is smoothed: a network must cope with the noise. What must
be differentiated is the slope of a straight line through the latest rows.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import SAMPLE_RATE

Series = NDArray[np.float64]

_TINY = 1e-6  # of a sample: times in a table are rounded
_EVEN = 0.05  # of a period


class Grid(NamedTuple):
    """60 Hz samples of a stretch, and the rows of the source that they use.

    Attributes:
        start: Time of the first sample, at least one source period after the first
            row; the last sample is at the last row [s].
        period: Of the source [s].
        earlier: Row at or before the sample's time minus one period, `(time,)`.
        share: From there towards the next row, in [0, 1), `(time,)` [-].
        latest: Last row at or before the sample, `(time,)`.
    """

    start: float
    period: float
    earlier: NDArray[np.int64]
    share: Series
    latest: NDArray[np.int64]


def grid(name: str, time: Series) -> Grid:
    """The 60 Hz samples that a stretch of even rows allows.

    Args:
        name: Of the stretch, for messages.
        time: Of the rows, `(row,)` [s]; at least two.

    Raises:
        ValueError: If the rows are not evenly spaced.
    """
    steps = np.diff(time)
    period = float(np.median(steps))
    uneven = np.flatnonzero(~(np.abs(steps - period) < _EVEN * period))
    if uneven.size:
        raise ValueError(
            f"{name}: {steps[uneven[0]]:.6g} s lie between rows {uneven[0]} and "
            f"{uneven[0] + 1}, elsewhere {period:.6g} s; cut the stretch there"
        )
    period = float(time[-1] - time[0]) / len(steps)
    rate = period * SAMPLE_RATE
    num = int((len(steps) - 1) * rate + _TINY)
    place = np.maximum(len(steps) - 1 - np.arange(num, -1, -1) / rate, 0.0) + _TINY
    earlier = place.astype(np.int64)
    share = np.where(place - earlier < 2.0 * _TINY, 0.0, place - earlier - _TINY)
    return Grid(
        start=float(time[-1]) - num / SAMPLE_RATE,
        period=period,
        earlier=earlier,
        share=share,
        latest=earlier + 1,
    )


def delayed(grid: Grid, values: Series, jumps: NDArray[np.bool_]) -> Series:
    """Values one source period late, straight lines from row to row.

    Args:
        grid: Samples and rows.
        values: In the source, `(row,)`.
        jumps: Rows whose value has no common origin with that of the row before; the
            row before is held until then, `(row,)`.

    Returns:
        Shape `(time,)`; NaN where a row that is needed is.
    """
    share = np.where(jumps[grid.latest], 0.0, grid.share)
    before, after = values[grid.earlier], values[grid.latest]
    line = before + share * (after - before)
    return np.asarray(np.where(share == 0.0, before, line))


def held(grid: Grid, values: NDArray[Any]) -> NDArray[Any]:  # Any: of any type
    """The latest row at each sample, `(time,)`."""
    return values[grid.latest]


def sample_at(grid: Grid, instant: float) -> int:
    """First sample at or after an instant; negative before the first sample."""
    return int(np.ceil((instant - grid.start) * SAMPLE_RATE - 1e-3))


def slope(time: Series, values: Series, span: float) -> Series:
    """Slope of the straight line of least squares through the latest rows.

    It is that of half the span ago.

    Args:
        time: Evenly spaced, `(row,)` [s].
        values: Without jumps, `(row,)`.
        span: From the first to the last of these rows [s].

    Returns:
        Per second, NaN until the span is full, `(row,)`.
    """
    period = float(time[-1] - time[0]) / (len(time) - 1)
    num = round(span / period) + 1
    found = np.full(len(values), np.nan)
    if len(values) >= num:
        place = (np.arange(num) - (num - 1) / 2.0) * period
        rows = np.lib.stride_tricks.sliding_window_view(values, num)
        found[num - 1 :] = rows @ (place / np.square(place).sum())
    return found
