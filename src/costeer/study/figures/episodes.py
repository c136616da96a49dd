"""Which moments of a study are shown: chosen by a rule, never by their looks."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.methods.conditions import MANUAL
from costeer.records.record import read_record
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies
from costeer.study.people import Who

LONGEST_LEAD = 8.0
"""A trigger belongs to an inconsistency that begins within this time [s]. Source:
assumed, the longest lane change."""

LONGEST_TAIL = 15.0
"""Shown at most after the onset [s]. Source: assumed, for legibility."""

_BEFORE, _AFTER = 1.0, 2.0
"""Shown around [s]."""

MOST_TO_CHOOSE = 12
"""Participants to choose from on a page; each makes it larger."""

_Rank = tuple[bool, bool, float]
"""Without a trigger, without recovery, how far above the re-plan gain it stayed."""

_COMPLETE: _Rank = (False, False, 0.0)

_SEARCHED = ("consistent", "haptic_gain", "intention")
_SHOWN = (
    "consistent",
    "haptic_gain",
    "intention",
    "mode",
    "driver_torque",
    "instructed_torque",
    "applied_torque",
    "guidance_pseudo_work",
    "driver_pseudo_work",
    "lateral_position",
    "target_lateral_position",
)


class Episode(NamedTuple):
    """An inconsistency to show.

    Attributes:
        participant: Whose it was.
        condition: In which condition.
        onset: Time of the first inconsistent verdict [s].
        trigger: Time of the trigger before it [s]; NaN without one.
        recovery: Time at which the gain was back [s]; NaN if it did not come back.
        lowest_gain: Smallest haptic gain [-].
        threshold: δ of the trial [W].
        window: What to show [s]: from shortly before the trigger to after recovery.
        columns: The rows of at least that time.
    """

    participant: Who
    condition: str
    onset: float
    trigger: float
    recovery: float
    lowest_gain: float
    threshold: float
    window: tuple[float, float]
    columns: dict[str, NDArray[Any]]  # of several element types


def exemplary_inconsistency(
    records: dict[tuple[Who, str], Path], replan_gain: float
) -> Episode | None:
    """Return the inconsistency to show, or None if there was none.

    The first, in order of participants and conditions, that began within 8 s of a
    trigger, led to a re-plan and recovered; failing that, the one that comes nearest:
    with a trigger, then with recovery, then with the lowest gain.

    Args:
        records: Trial records by participant and condition.
        replan_gain: Gain below which the system plans anew [-].
    """
    best: tuple[_Rank, tuple[Who, str], Inconsistency] | None = None
    for key, path in records.items():
        if key[1] == MANUAL:
            continue
        for found, rank in _ranked(read_record(path, _SEARCHED).columns, replan_gain):
            if best is None or rank < best[0]:
                best = (rank, key, found)
            if rank == _COMPLETE:
                return _episode(key, path, found)
    return None if best is None else _episode(best[1], records[best[1]], best[2])


def own_inconsistencies(
    records: dict[tuple[Who, str], Path], replan_gain: float
) -> list[Episode]:
    """Return the inconsistency to show of each of the first participants who has one.

    Args:
        records: Trial records by participant and condition.
        replan_gain: Gain below which the system plans anew [-].
    """
    found = (
        exemplary_inconsistency(
            {key: path for key, path in records.items() if key[0] == who}, replan_gain
        )
        for who in to_choose(records)
    )
    return [each for each in found if each is not None]


def to_choose(records: Iterable[tuple[Who, str]]) -> list[Who]:
    """Participants whose figure a page can show: the first, in order."""
    return list(dict.fromkeys(who for who, _ in records))[:MOST_TO_CHOOSE]


def _ranked(
    columns: dict[str, NDArray[Any]], replan_gain: float
) -> list[tuple[Inconsistency, _Rank]]:
    """The inconsistencies of a trial, each with how far it is from a complete one."""
    found = find_inconsistencies(columns)
    if isinstance(found, str):
        return []
    return [
        (
            each,
            (
                bool(np.isnan(_trigger_before(columns, each.start_time))),
                not each.recovery_time <= LONGEST_TAIL,
                max(each.gain_minimum, replan_gain) - replan_gain,
            ),
        )
        for each in found
    ]


def _trigger_before(columns: dict[str, NDArray[Any]], start: float) -> float:
    """Time of the last trigger within reach before an inconsistency; NaN without."""
    triggers = columns["time"][rises(columns["intention"])]
    near = triggers[(triggers <= start) & (triggers >= start - LONGEST_LEAD)]
    return float(near[-1]) if near.size else np.nan


def rises(flags: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Rows at which a flag turns true, the first row included."""
    before = np.concatenate(([False], flags[:-1]))
    return np.flatnonzero(flags & ~before)


def falls(flags: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Last rows at which a flag is true, one for each of `rises`."""
    after = np.concatenate((flags[1:], [False]))
    return np.flatnonzero(flags & ~after)


def inconsistent_spans(columns: dict[str, NDArray[Any]]) -> list[tuple[float, float]]:
    """Start and end [s] of every stretch with an inconsistent verdict.

    Each ends at the first consistent row after it, so that a verdict of a single row
    has a width too.
    """
    time = columns["time"]
    inconsistent = ~np.ma.filled(columns["consistent"], True)
    after = np.minimum(falls(inconsistent) + 1, time.size - 1)
    starts = rises(inconsistent)
    return list(zip(time[starts].tolist(), time[after].tolist(), strict=True))


def _episode(key: tuple[Who, str], path: Path, found: Inconsistency) -> Episode:
    record = read_record(path, _SHOWN)
    time = record.columns["time"]
    trigger = _trigger_before(record.columns, found.start_time)
    recovered = found.recovery_time <= LONGEST_TAIL
    length = found.recovery_time if recovered else LONGEST_TAIL
    start = found.start_time if np.isnan(trigger) else trigger
    window = (start - _BEFORE, found.start_time + length + _AFTER)
    kept = time >= found.start_time - LONGEST_LEAD - _BEFORE
    kept &= time <= found.start_time + LONGEST_TAIL + _AFTER
    threshold = record.metadata["inconsistency_threshold"]
    return Episode(
        participant=key[0],
        condition=key[1],
        onset=found.start_time,
        trigger=trigger,
        recovery=found.start_time + length if recovered else np.nan,
        lowest_gain=found.gain_minimum,
        threshold=float(threshold) if isinstance(threshold, int | float) else np.nan,
        window=window,
        columns={name: values[kept] for name, values in record.columns.items()},
    )
