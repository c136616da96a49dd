"""Whether a trial record is whole and its values are of the declared kinds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import (
    COLUMN_NAMES,
    METHOD_PREFIX,
    Column,
    TrialRecord,
    with_method_columns,
)
from costeer.records.metadata import check_metadata

_ACCEPTED_KINDS = {"float64": "f", "int8": "iu", "bool": "b", "string": "U"}


def validated(record: TrialRecord) -> TrialRecord:
    """The record with every column in the type of its kind, in the order of `COLUMNS`.

    Raises:
        ValueError: If a column or metadata field is missing or unknown, the lengths
            differ, a kind is wrong, a value is undefined where it may not be, or
            time is not finite and increasing.
    """
    declared = with_method_columns(record.method_columns)
    _check_names(record.columns, [column.name for column in declared])
    check_metadata(record.metadata)
    columns = {
        column.name: converted(column, record.columns[column.name])
        for column in declared
    }
    _check_lengths(columns)
    check_time(columns["time"])
    return record._replace(columns=columns)


def converted(column: Column, values: NDArray[Any]) -> NDArray[Any]:
    """One column in the type of its kind; nullable ones as masked arrays.

    Raises:
        ValueError: If the values are of another kind, out of range or undefined.
    """
    values = np.asanyarray(values)
    if values.ndim != 1:
        raise ValueError(
            f"column {column.name!r} has {values.ndim} dimensions; give one value "
            "per row"
        )
    if values.dtype.kind == "U" and column.kind != "string":
        raise ValueError(text_told(column.name, values))
    if values.dtype.kind not in _ACCEPTED_KINDS[column.kind]:
        raise ValueError(
            f"column {column.name!r} holds {values.dtype}, expected {column.kind}; "
            "undefined integers and flags are masked arrays, not NaN"
        )
    _check_range(column, values)
    return _masked_or_plain(column, values)


def text_told(name: str, values: NDArray[np.str_]) -> str:
    """Say which cell of a column of numbers holds text."""
    row = next((i for i, text in enumerate(values) if not _is_number(text)), 0)
    return (
        f"column {name!r} is {str(values[row])!r} in row {row}, expected a number with "
        "a decimal point; mend that cell, or leave it empty if nothing is known"
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _check_range(column: Column, values: NDArray[Any]) -> None:
    defined = values.compressed() if isinstance(values, np.ma.MaskedArray) else values
    if column.kind == "int8" and values.dtype != np.int8 and defined.size:
        low, high = int(defined.min()), int(defined.max())
        if low < -128 or high > 127:
            raise ValueError(
                f"column {column.name!r} ranges from {low} to {high}; int8 holds "
                "-128 to 127"
            )


def _masked_or_plain(column: Column, values: NDArray[Any]) -> NDArray[Any]:
    dtype: Any = str if column.kind == "string" else column.kind  # numpy's DTypeLike
    if column.nullable:
        return np.ma.MaskedArray(
            np.ma.getdata(values).astype(dtype), mask=np.ma.getmaskarray(values)
        )
    if np.ma.is_masked(values):
        raise ValueError(
            f"column {column.name!r} has undefined samples; it must be defined "
            "throughout"
        )
    return np.ma.getdata(values).astype(dtype, copy=False)


def check_time(time: NDArray[np.float64]) -> None:
    """Refuse times that are not finite or do not increase.

    Args:
        time: Sample times [s], shape `(time,)`.

    Raises:
        ValueError: Naming the first row at fault.
    """
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0])
        raise ValueError(f"time is {time[row]} in row {row}; every time must be finite")
    falling = np.flatnonzero(np.diff(time) <= 0)
    if falling.size:
        row = int(falling[0]) + 1
        raise ValueError(
            f"time does not increase in row {row}: {time[row - 1]} s, then "
            f"{time[row]} s; {_way_out(time, row)}"
        )


def _way_out(time: NDArray[np.float64], row: int) -> str:
    if time[row] == time[row - 1]:
        return (
            f"delete row {row}, which repeats the one before (on the command line: "
            "--drop-repeated)"
        )
    return "sort the rows or split the recording at a column 'sequence'"


def _check_lengths(columns: dict[str, NDArray[Any]]) -> None:
    num_rows = len(columns["time"])
    if num_rows == 0:
        raise ValueError("a trial record needs at least one row; it has none")
    uneven = {k: len(v) for k, v in columns.items() if len(v) != num_rows}
    if uneven:
        name, length = next(iter(uneven.items()))
        raise ValueError(
            f"column {name!r} has {length} rows, 'time' has {num_rows}; all columns "
            "of a record are equally long"
        )


def _check_names(given: Iterable[str], declared: Sequence[str]) -> None:
    missing = [name for name in declared if name not in set(given)]
    if missing:
        raise ValueError(f"missing columns: {', '.join(missing)}")
    refuse_unknown(name for name in given if name not in declared)


def refuse_unknown(names: Iterable[str]) -> None:
    """Refuse columns that no record has.

    Raises:
        ValueError: If there is one.
    """
    unknown = ", ".join(names)
    if unknown:
        raise ValueError(
            f"unknown columns: {unknown}; a trial record has "
            f"{', '.join(COLUMN_NAMES)}, and those of its method, which are declared "
            f"and begin with {METHOD_PREFIX!r}"
        )
