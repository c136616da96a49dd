"""How a recording was sampled, and the same recording at even steps."""

from typing import NamedTuple

import numpy as np

from costeer.records.checks import check_time
from costeer.records.times import LONGEST_STEP, check_steps
from costeer.study.definitions import Columns, Signal

EVEN_ENOUGH = 0.05
"""Steps that differ less from their mean, as a share of it, are left as they are.
Source: assumed; the reversal rate then errs by less than its sampling does."""


__all__ = ["EVEN_ENOUGH", "LONGEST_STEP", "Sampling", "evened", "sampling"]


class Sampling(NamedTuple):
    """How a recording was sampled.

    Attributes:
        rate: Mean number of samples per second [Hz].
        unevenness: Largest deviation of a step from the mean step, as a share of it.
        longest_step: Between two samples [s].
    """

    rate: float
    unevenness: float
    longest_step: float


def sampling(time: Signal) -> Sampling:
    """Rate and regularity of sample times.

    Args:
        time: Sample times [s], shape `(time,)`.

    Raises:
        ValueError: If there are fewer than two, they do not increase, or one step is
            too long to be bridged.
    """
    if time.size < 2:
        raise ValueError(f"{time.size} samples are no recording; give at least 2")
    check_time(time)
    steps = np.diff(time)
    longest, mean = float(steps.max()), float(steps.mean())
    check_steps(
        steps,
        "tell its parts apart by a column 'sequence', or, if time is in milliseconds, "
        "multiply it by 0.001 (on the command line: --scale time=0.001)",
    )
    unevenness = float(np.abs(steps / mean - 1.0).max())
    return Sampling(rate=1.0 / mean, unevenness=unevenness, longest_step=longest)


def evened(columns: Columns, found: Sampling) -> Columns:
    """The recording at even steps of its mean rate; itself if even enough.

    Numbers are interpolated linearly, flags and text take the sample before.
    """
    if found.unevenness <= EVEN_ENOUGH:
        return columns
    time = columns["time"]
    even = np.linspace(time[0], time[-1], time.size)
    before = np.searchsorted(time, even, side="right") - 1
    return {
        name: np.interp(even, time, values)
        if values.dtype.kind == "f"
        else values[before]
        for name, values in columns.items()
    } | {"time": even}
