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
from costeer.records.checks import check_time
from costeer.records.times import check_steps

Series = NDArray[np.float64]

_TINY = 1e-6  # of a sample: times in a table are rounded
EVEN = 0.05  # of a period


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
    """The 60 Hz samples that a stretch allows.

    Rows that are not evenly spaced, for their times are rounded or a frame was lost,
    are interpolated as late as the longest step between two of them is.

    Args:
        name: Of the stretch, for messages.
        time: Of the rows, `(row,)` [s]; at least two.

    Raises:
        ValueError: If time does not increase, or a step is too long to be bridged.
    """
    _check(name, time)
    steps = np.diff(time)
    period = float(time[-1] - time[0]) / len(steps)
    if (np.abs(steps - period) < EVEN * period).all():
        time = time[-1] - period * np.arange(len(steps), -1.0, -1.0)
    longest = float(np.diff(time).max())
    first = time[1] if longest < (1.0 + EVEN) * period else time[0] + longest
    num = int((time[-1] - first) * SAMPLE_RATE + _TINY)
    samples = time[-1] - np.arange(num, -1, -1) / SAMPLE_RATE
    slack = _TINY * period
    wanted = samples - longest + slack
    earlier = np.clip(np.searchsorted(time, wanted, "right") - 1, 0, len(steps) - 1)
    share = (wanted - time[earlier]) / np.diff(time)[earlier]
    share = np.where(share < 2.0 * _TINY, 0.0, share - _TINY)
    latest = np.searchsorted(time, samples + slack, "right") - 1
    return Grid(
        start=float(samples[0]),
        period=period,
        earlier=earlier,
        share=np.clip(share, 0.0, 1.0),
        latest=latest,
    )


def _check(name: str, time: Series) -> None:
    """Refuse what `costeer analyse` refuses too.

    Raises:
        ValueError: If time does not increase, or a step is too long.
    """
    try:
        check_time(time)
        check_steps(np.diff(time), "cut the stretch there")
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


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
    later = grid.earlier + 1
    share = np.where(jumps[later], 0.0, grid.share)
    before, after = values[grid.earlier], values[later]
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
