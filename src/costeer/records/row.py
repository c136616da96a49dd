"""A sample of the loop as one flat row of numbers, and rows as columns of a record.

The functions that fill a row are written out once from the declared columns, so that no
list of them is kept by hand and compiled code has nothing to look up.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import compiled
from costeer.records.columns import COLUMN_NAMES, COLUMNS, Column

ROW_COLUMNS = COLUMN_NAMES
"""Names of the numbers of a row; those of a method's own columns follow."""


class RowWriter(NamedTuple):
    """The row of a sample, written out from a list of columns.

    Attributes:
        columns: The numbers of the row, in order.
        fill: `fill(out, sample)` writes them into an array; for Numba and Python.
        values: `values(sample)` gives them as a tuple; for JAX.
    """

    columns: tuple[Column, ...]
    # Any: the sample of a method is of the method's own type, in any engine.
    fill: Callable[[NDArray[np.float64], Any], None]
    values: Callable[[Any], tuple[Any, ...]]


def row_writer(columns: Sequence[Column], like: Any) -> RowWriter:  # Any: as above
    """Write out the functions that make a row of a sample.

    Args:
        columns: Of the record, with those of the method.
        like: A sample; what it holds is what a column can be taken from.

    Raises:
        ValueError: If a column's place is not in the sample or is no single number,
            saying what there is.
    """
    places = [f"sample.{_checked(column, like)}" for column in columns]
    filled = "".join(f"    out[{k}] = {place}\n" for k, place in enumerate(places))
    source = (
        f"def fill(out, sample):\n{filled}\n"
        f"def values(sample):\n    return ({', '.join(places)},)\n"
    )
    names: dict[str, Any] = {"__name__": __name__}
    exec(source, names)  # no other way to write out the places
    # Numba tells functions of one name and signature apart by a count that starts
    # anew in each process, so what its cache keeps needs a name of its own.
    mark = hashlib.sha256(source.encode()).hexdigest()[:8]
    for name in ("fill", "values"):
        names[name].__name__ = names[name].__qualname__ = f"{name}_{mark}"
    return RowWriter(tuple(columns), compiled(names["fill"]), compiled(names["values"]))


def _checked(column: Column, like: Any) -> str:  # Any: as above
    """The place of a column, which is a number in a sample like this.

    Raises:
        ValueError: If it is not.
    """
    value, reached = like, "the sample"
    for part in column.source.split("."):
        fields = getattr(value, "_fields", ())
        if part not in fields:
            there = ", ".join(fields) if fields else "a number and no more"
            raise ValueError(
                f"column {column.name!r}: there is no {column.source!r} in the sample; "
                f"{reached} has no {part!r}, it is {there}"
            )
        value, reached = getattr(value, part), repr(part)
    if isinstance(value, tuple) or np.ndim(value) > 0:
        there = ", ".join(getattr(value, "_fields", ())) or "an array"
        raise ValueError(
            f"column {column.name!r}: {column.source!r} is no number, it is {there}; "
            "a column is one number at a time"
        )
    return column.source


def record_columns(
    rows: NDArray[np.float64],
    assisted: bool | NDArray[np.bool_],
    columns: Sequence[Column] = COLUMNS,
) -> dict[str, NDArray[Any]]:
    """Rows of the loop as the columns of a record.

    Args:
        rows: A number for each column, shape `(time, column)`. Columns may be views of
            it if its numbers lie column after column.
        assisted: Without assistance some columns are empty, `assisted_only`; for all
            rows, or one flag for each, shape `(time,)`.
        columns: Of the record, with those of the method.

    Raises:
        ValueError: If a number has no word, or does not fit in an int8.
    """
    helped = np.broadcast_to(assisted, len(rows))
    places = {column.name: place for place, column in enumerate(columns)}
    judged = helped
    if _GAIN in places:
        judged = helped & ~np.isnan(rows[:, places[_GAIN]])
    across = np.ascontiguousarray(rows.T)
    return {
        column.name: _as_kind(
            column,
            across[place],
            judged if column.name == _VERDICT else helped,
        )
        for place, column in enumerate(columns)
    }


_GAIN, _VERDICT = "haptic_gain", "consistent"
"""A method without a haptic gain has no verdict either."""


# Any: the element type differs from column to column.
def _as_kind(
    column: Column, values: NDArray[np.float64], helped: NDArray[np.bool_]
) -> NDArray[Any]:
    """One column in the type that the record keeps it in; NaN becomes a null."""
    if column.assisted_only:
        values = np.where(helped, values, 0.0 if column.labels else np.nan)
    if column.labels:
        return _labelled(column, values)
    if column.kind == "float64":
        return values
    missing = np.isnan(values)
    if column.kind == "int8":
        _check_fits(column, values)
    whole = np.where(missing, 0.0, values).astype(column.kind)
    return np.ma.MaskedArray(whole, mask=missing) if column.nullable else whole


def _check_fits(column: Column, values: NDArray[np.float64]) -> None:
    """Refuse what a small whole number cannot hold.

    Raises:
        ValueError: Naming the first row at fault.
    """
    wrong = np.flatnonzero((values < -128.0) | (values > 127.0))
    if wrong.size:
        raise ValueError(
            f"column {column.name!r} is {values[wrong[0]]:g} in row {wrong[0]}; int8 "
            "holds -128 to 127: declare it as float64"
        )


def _labelled(column: Column, codes: NDArray[np.float64]) -> NDArray[np.str_]:
    """The words of a column of texts.

    Raises:
        ValueError: If a number has no word.
    """
    last = len(column.labels) - 1
    wrong = np.flatnonzero(~((codes >= 0.0) & (codes <= last)))
    if wrong.size:
        raise ValueError(
            f"column {column.name!r} is {codes[wrong[0]]} in row {wrong[0]}; its "
            f"labels are numbered 0 to {last}"
        )
    words: NDArray[np.str_] = np.array(column.labels)
    return np.asarray(words[codes.astype(int)])
