"""Recordings in whatever form a user has them."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from costeer.records.columns import TrialRecord
from costeer.records.record import Noted, read_noted

if TYPE_CHECKING:
    from pandas import DataFrame

File: TypeAlias = str | os.PathLike[str]
Part = TypeVar("Part")
# Any: what a mapping or a data frame holds differs from column to column.
Recorded: TypeAlias = "TrialRecord | Mapping[str, Any] | DataFrame"


class ReadingWarning(UserWarning):
    """Something in a recording looks wrong, or had to be assumed, and it was read.

    Example:
        >>> import costeer, warnings
        >>> angle = [0.0, 20.0] * 300  # no steering wheel turns by 20 rad
        >>> time = [k / 60 for k in range(600)]
        >>> table = {"time": time, "steering_wheel_angle": angle}
        >>> with warnings.catch_warnings(record=True) as told:
        ...     warnings.simplefilter("always", costeer.ReadingWarning)
        ...     found = costeer.measures(table)
        >>> str(told[0].message).split(";")[0]
        'steering_wheel_angle looks like degrees, expected rad'
    """


def warn_of(notes: Iterable[str], level: int) -> None:
    """Warn of each note, as of the caller so many frames above."""
    for each in notes:
        warnings.warn(each, ReadingWarning, stacklevel=level + 1)


def by_name(wanted: Part | os.PathLike[str]) -> Part | str:
    """What is plugged in; a path as the text that names it."""
    return os.fspath(wanted) if isinstance(wanted, os.PathLike) else wanted


def load_record(path: File) -> TrialRecord:
    """Read a trial record, or a table of your own.

    What was assumed of a file, or is damaged in it, is a `costeer.ReadingWarning`.

    Args:
        path: Parquet, Arrow or text (gzipped too), told by its content, with a column
            `time` and any of a record's.

    Raises:
        ValueError: If it cannot be understood.
        OSError: If it cannot be read.

    Example:
        >>> import costeer
        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = folder + "/a.parquet"
        ...     costeer.write_record(file, costeer.simulate("manual", length=200))
        ...     record = costeer.load_record(file)
        >>> record.metadata["condition"]
        'manual'
    """
    record, notes = read_noted(path)
    warn_of((f"{path}: {each}" for each in notes), 2)
    return record


def noted(recording: Recorded | File) -> Noted:
    """A recording in whatever form, as a record, and what was assumed of it.

    A record without metadata is a table.

    Raises:
        ValueError: If it is none, or its columns differ in length.
        OSError: If a file cannot be read.
    """
    if isinstance(recording, TrialRecord):
        return Noted(recording)
    if isinstance(recording, str | os.PathLike):
        return read_noted(recording)
    if not hasattr(recording, "items"):
        raise ValueError(
            f"{type(recording).__name__} is no recording; give a record, a data frame "
            "or a mapping of names to arrays"
        )
    columns = {str(name): _array(values) for name, values in recording.items()}
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {number}" for name, number in lengths.items())
        raise ValueError(f"columns differ in length: {told}; give one value per row")
    return Noted(TrialRecord({}, columns))


def _array(values: Any) -> np.ndarray[Any, Any]:  # Any: whatever holds a column
    """A column as an array; what pandas calls missing is NaN."""
    kind = getattr(values, "dtype", None)
    if kind is not None and hasattr(kind, "na_value") and hasattr(values, "isna"):
        if kind.kind in "iub" and values.isna().any():
            return np.asarray(values.to_numpy(np.float64, na_value=math.nan))
        return np.asarray(values.to_numpy(kind.type if kind.kind in "iubf" else str))
    found = (
        np.ma.asanyarray(values) if np.ma.isMaskedArray(values) else np.asarray(values)
    )
    return found.astype(str) if found.dtype.kind == "O" else found
