"""Recordings as training and judging see them, from trial records or any table.

A table needs the names of spec section 6: `time`, `lane` and the six signals of
Eq. (1), at 60 Hz. `sequence` marks separate stretches, `participant` the driver,
`crossing` (-1, 0, +1) the samples of crossings; without it they follow from `lane`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    SAMPLE_RATE,
    adjacent_side,
    feature_series,
)
from costeer.loop.columns import text_told
from costeer.loop.plausible import suspicions
from costeer.loop.record import TrialRecord, read_recording
from costeer.training.labels import Labels, crossings, labels

Columns = Mapping[str, NDArray[Any]]

_NEEDED = ("time", "lane", *FEATURES)
_RATE_TOLERANCE = 0.02


class Recording(NamedTuple):
    """One uninterrupted stretch of driving.

    Attributes:
        driver: Who drove; splits and spreads go by it.
        name: Of the stretch, for messages.
        features: Signals of Eq. (1), facing right, in their units, `(time, feature)`.
        side: Side of the adjacent lane, -1 or +1, `(time,)`.
        intended: Crossings that the driver meant, -1 or +1 at the first sample in the
            new lane, else 0, `(time,)`.
        labels: Truth at each sample.
        notes: What the reader should know before trusting a judgement.
    """

    driver: str
    name: str
    features: NDArray[np.float64]
    side: NDArray[np.int8]
    intended: NDArray[np.int8]
    labels: Labels
    notes: tuple[str, ...] = ()


def recording(driver: str, name: str, columns: Columns) -> Recording:
    """One stretch from its columns.

    Raises:
        ValueError: If a column is missing or holds what it cannot, or the rate is not
            60 Hz.
    """
    _check(name, columns)
    lane = _whole(name, columns, "lane", (0, 1), "0 (right) or 1 (left)")
    side = adjacent_side(lane)
    crossing = (
        _whole(name, columns, "crossing", (-1, 0, 1), "-1 (right), 0 or +1 (left)")
        if "crossing" in columns
        else crossings(lane)
    )
    return Recording(
        driver=driver,
        name=name,
        features=feature_series(_tracked(columns), side),
        side=side,
        intended=_intended(crossing, columns),
        labels=labels(crossing, side),
        notes=tuple(
            f"{name}: {each.words}; if so, multiply it by {each.factor:.6g}"
            for each in suspicions(columns)
        ),
    )


def _whole(
    name: str, columns: Columns, column: str, allowed: tuple[int, ...], words: str
) -> NDArray[np.int8]:
    """A column of few values, each of them allowed."""
    values = np.ma.filled(columns[column].astype(np.float64), np.nan)
    wrong = np.flatnonzero(~np.isin(values, allowed))
    if wrong.size:
        raise ValueError(
            f"{name}: {column} is {values[wrong[0]]:g} in row {wrong[0]}; give {words}"
        )
    return values.astype(np.int8)


def _tracked(columns: Columns) -> dict[str, NDArray[np.float64]]:
    """The six signals; head yaw is NaN where the head was not tracked."""
    series = {name: np.array(columns[name], np.float64) for name in FEATURES}
    if "head_yaw_valid" in columns:
        lost = ~np.asarray(columns["head_yaw_valid"], bool)
        series["head_yaw"][lost] = np.nan
    return series


def _intended(crossing: NDArray[np.int8], columns: Columns) -> NDArray[np.int8]:
    """Crossings that a virtual driver meant; of people all count."""
    decided = columns.get("driver_intention")
    if decided is None:
        return crossing
    unknown = np.ma.getmaskarray(decided)
    meant = unknown | (np.ma.getdata(decided) == crossing)
    return np.where(meant, crossing, 0).astype(np.int8)


def _check(name: str, columns: Columns) -> None:
    missing = [column for column in _NEEDED if column not in columns]
    if missing:
        names = ", ".join(missing)
        inputs = [column for column in missing if column in FEATURES]
        variant = (
            f" The network needs all six signals of Eq. (1): there is no variant "
            f"without {', '.join(inputs)}."
            if inputs
            else ""
        )
        raise ValueError(
            f"{name} has no column {names}; names are those of the trial record."
            + variant
        )
    for column in (*_NEEDED, *({"crossing"} & columns.keys())):
        _check_numbers(name, column, columns[column])
    steps = np.diff(np.asarray(columns["time"], np.float64))
    wrong = np.flatnonzero(~(np.abs(steps * SAMPLE_RATE - 1.0) < _RATE_TOLERANCE))
    if wrong.size:
        raise ValueError(
            f"{name}: {steps[wrong[0]]:.6g} s lie between rows {wrong[0]} and "
            f"{wrong[0] + 1}; the network needs {SAMPLE_RATE:g} rows a second without "
            "gaps: resample, and mark separate stretches in the column 'sequence'"
        )


def _check_numbers(name: str, column: str, values: NDArray[Any]) -> None:
    if values.dtype.kind == "U":
        raise ValueError(f"{name}: {text_told(column, values)}")


def recordings_of(record: TrialRecord, name: str) -> list[Recording]:
    """The stretches of a trial record or of a table.

    Args:
        record: As `read_recording` gives it.
        name: For messages.

    Raises:
        ValueError: As `recording` does.
    """
    columns = record.columns
    if record.metadata:
        driver = f"{record.metadata['seed']}-{record.metadata['participant']}"
        return [recording(driver, name, columns)]
    if "sequence" not in columns:
        return [recording(_driver(columns, name), name, columns)]
    return [
        recording(_driver(part, f"{name}:{label}"), f"{name}:{label}", part)
        for label, part in _stretches(columns)
    ]


def _stretches(columns: Columns) -> list[tuple[str, dict[str, NDArray[Any]]]]:
    """Rows of each value of `sequence`, in the order of the file."""
    sequence = np.ma.getdata(columns["sequence"])
    _, first = np.unique(sequence, return_index=True)
    parts = []
    for label in sequence[np.sort(first)]:
        rows = sequence == label
        parts.append((str(label), {name: v[rows] for name, v in columns.items()}))
    return parts


def _driver(columns: Columns, otherwise: str) -> str:
    """The participant, if the table names one; else each stretch is its own driver."""
    if "participant" in columns:
        return str(np.ma.getdata(columns["participant"])[0])
    return otherwise


def read_recordings(paths: Sequence[Path]) -> list[Recording]:
    """Read trial records or tables (CSV, Parquet).

    Raises:
        ValueError: If a file cannot be understood or lacks columns, naming it.
        OSError: If a file cannot be read.
    """
    found = []
    for path in paths:
        found += recordings_of(read_recording(path), str(path))
    return found
