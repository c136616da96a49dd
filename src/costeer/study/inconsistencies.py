"""Episodes in which driver and guidance wanted different paths, and how they ended.

An inconsistency begins when the verdict of Table III turns inconsistent and ends when
the verdict is consistent and the haptic gain has come back. Verdicts that flip in
between belong to it, because each restarts the fade of Eqs. (10) and (11).
"""

from math import nan
from typing import NamedTuple

import numpy as np

from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    Flags,
    MeasureParameters,
    Signal,
    incomplete,
    missing,
    under_assistance,
)


class Inconsistency(NamedTuple):
    """One inconsistency.

    Attributes:
        start_time: The verdict turns inconsistent [s].
        duration: Time with an inconsistent verdict in it [s].
        gain_minimum: Least haptic gain in it [-].
        recovery_time: From the start until the verdict is consistent and the gain is
            back [s]; NaN if the record ends before.
        num_flips: Changes of the verdict between the first and the last.
        frozen_time: Time in it with the gain half-way and nearly constant [s].
    """

    start_time: float
    duration: float
    gain_minimum: float
    recovery_time: float
    num_flips: int
    frozen_time: float


def find_inconsistencies(
    columns: Columns, parameters: MeasureParameters = DEFAULTS, method: str = ""
) -> tuple[Inconsistency, ...] | str:
    """All inconsistencies of a trial.

    Args:
        columns: `time`, `consistent`, `haptic_gain`, `mode`; shape `(time,)` each.
        parameters: Gains and rate.
        method: Name of the guidance, for the reason.

    Returns:
        Them in order, or the reason why they cannot be told.
    """
    reason = _no_verdict(columns, method)
    reason = reason or incomplete(columns, "time", "consistent", "haptic_gain")
    if reason:
        return reason
    inconsistent = ~np.ma.getdata(columns["consistent"]).astype(bool)
    recovered = ~inconsistent & (columns["haptic_gain"] >= parameters.recovery_gain)
    frozen = _frozen(columns, parameters)
    return tuple(
        _described(columns, inconsistent, frozen, rows)
        for rows in _episodes(inconsistent, recovered)
    )


def _no_verdict(columns: Columns, method: str) -> str:
    """That a guidance has no haptic gain, so that no verdict fades it; else empty."""
    if not under_assistance(columns) or "haptic_gain" not in columns:
        return ""
    if not missing(columns, "haptic_gain"):
        return ""
    name = " ".join(["the method", method]).strip()
    return f"{name} has no haptic gain and gives no verdict"


def _episodes(inconsistent: Flags, recovered: Flags) -> list[slice]:
    """Rows from each first inconsistent verdict up to recovery, that row excluded."""
    begins = np.flatnonzero(inconsistent)
    ends = np.append(np.flatnonzero(recovered), inconsistent.size)
    found: list[slice] = []
    place = 0
    while place < begins.size:
        first = int(begins[place])
        last = int(ends[np.searchsorted(ends, first)])
        found.append(slice(first, last))
        place = int(np.searchsorted(begins, last))
    return found


def _frozen(columns: Columns, parameters: MeasureParameters) -> Flags:
    """Samples at which the gain is half-way and nearly constant, shape `(time,)`.

    Half-way is above twice the re-plan gain, because an undisturbed fade turns back
    just below that gain and is slow there.
    """
    gain = columns["haptic_gain"]
    if gain.size < 2:
        return np.zeros(gain.size, dtype=bool)
    rate = np.gradient(gain, columns["time"])
    half_way = gain > 2.0 * parameters.replan_gain
    half_way &= gain < parameters.recovery_gain
    return np.asarray(half_way & (np.abs(rate) < parameters.frozen_gain_rate))


def _described(
    columns: Columns, inconsistent: Flags, frozen: Flags, rows: slice
) -> Inconsistency:
    time: Signal = columns["time"]
    is_over = rows.stop < time.size
    steps = np.diff(time[rows.start : rows.stop + 1])
    flags = inconsistent[rows][: steps.size]
    num_changes = int(np.count_nonzero(np.diff(inconsistent[rows])))
    last_is_return = not inconsistent[rows.stop - 1]
    return Inconsistency(
        start_time=float(time[rows.start]),
        duration=float(steps[flags].sum()),
        gain_minimum=float(np.min(columns["haptic_gain"][rows])),
        recovery_time=float(time[rows.stop] - time[rows.start]) if is_over else nan,
        num_flips=num_changes - int(last_is_return),
        frozen_time=float(steps[frozen[rows][: steps.size]].sum()),
    )
