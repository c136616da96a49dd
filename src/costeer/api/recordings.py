"""Recordings in whatever form a user has them."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from costeer.records.columns import TrialRecord
from costeer.records.record import read_recording

if TYPE_CHECKING:
    from pandas import DataFrame

File: TypeAlias = str | os.PathLike[str]
Part = TypeVar("Part")
# Any: what a mapping or a data frame holds differs from column to column.
Recorded: TypeAlias = "TrialRecord | Mapping[str, Any] | DataFrame"


def by_name(wanted: Part | os.PathLike[str]) -> Part | str:
    """What is plugged in; a path as the text that names it."""
    return os.fspath(wanted) if isinstance(wanted, os.PathLike) else wanted


def load_record(path: File) -> TrialRecord:
    """Read a trial record, or a table of your own.

    Args:
        path: Parquet, or CSV (gzipped too) with a column `time` and any of a record's.

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
    return read_recording(path)


def as_record(recording: Recorded) -> TrialRecord:
    """A recording in whatever form, as a record; one without metadata is a table.

    Raises:
        ValueError: If it is none, or its columns differ in length.
    """
    if isinstance(recording, TrialRecord):
        return recording
    if isinstance(recording, str | os.PathLike):
        return read_recording(recording)
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
    return TrialRecord({}, columns)


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
