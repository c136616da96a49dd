"""Recordings of others made readable: names, units, stretches.

A recording needs `time` in seconds and any of a trial record's columns in SI units.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.checks import converted
from costeer.records.columns import COLUMNS_BY_NAME
from costeer.study.definitions import Columns


class Adaptation(NamedTuple):
    """How the columns of a foreign table become those of a trial record.

    Attributes:
        renames: Name there to name here.
        scales: Name here to the factor that gives SI units.
        sequence: Column, as named there, that tells separate stretches apart; empty
            if the table is one stretch, or has a column `sequence`.
    """

    renames: Mapping[str, str] = {}
    scales: Mapping[str, float] = {}
    sequence: str = ""


AS_IT_IS = Adaptation()


class Stretch(NamedTuple):
    """One continuous recording.

    Attributes:
        name: Value of the sequence column; empty if there is none.
        columns: Those that are known, in their own types, shape `(time,)` each.
        ignored: Names of the others.
    """

    name: str
    columns: Columns
    ignored: tuple[str, ...]


def stretches(
    columns: Columns, adaptation: Adaptation = AS_IT_IS
) -> tuple[Stretch, ...]:
    """Rename, scale and split the columns of a table.

    Args:
        columns: As read, shape `(time,)` each.
        adaptation: What to rename and scale, and how to split.

    Returns:
        The stretches in the order in which they begin.

    Raises:
        ValueError: If a name is not there, there is no `time`, or a column holds
            what it cannot.
    """
    key = adaptation.sequence or ("sequence" if "sequence" in columns else "")
    if key and key not in columns:
        raise ValueError(_no_column("--sequence", key, columns))
    renamed = _scaled(_renamed(columns, adaptation.renames), adaptation.scales)
    known = {k: _as_kind(k, v) for k, v in renamed.items() if k in COLUMNS_BY_NAME}
    if "time" not in known:
        raise ValueError(_no_time(columns))
    ignored = tuple(name for name in renamed if name not in known and name != key)
    if not key:
        return (Stretch(name="", columns=known, ignored=ignored),)
    return tuple(
        Stretch(
            name=str(value),
            columns={name: values[rows] for name, values in known.items()},
            ignored=ignored,
        )
        for value, rows in _groups(columns[key])
    )


# Any, here and below: the element type differs from column to column.
def _groups(keys: NDArray[Any]) -> list[tuple[Any, NDArray[np.intp]]]:
    values, firsts, codes = np.unique(keys, return_index=True, return_inverse=True)
    return [(values[i], np.flatnonzero(codes == i)) for i in np.argsort(firsts)]


def _renamed(columns: Columns, renames: Mapping[str, str]) -> dict[str, NDArray[Any]]:
    for old, new in renames.items():
        if old not in columns:
            raise ValueError(_no_column("--rename", old, columns))
        if new not in COLUMNS_BY_NAME:
            raise ValueError(
                f"--rename {old}={new}: {new!r} is no column of a trial record; "
                f"choose from {', '.join(COLUMNS_BY_NAME)}"
            )
    kept = {k: v for k, v in columns.items() if k not in renames.values()}
    return {renames.get(name, name): values for name, values in kept.items()}


def _scaled(columns: Columns, scales: Mapping[str, float]) -> dict[str, NDArray[Any]]:
    scaled = dict(columns)
    for name, factor in scales.items():
        if name not in columns:
            raise ValueError(_no_column("--scale", name, columns))
        if not np.isfinite(factor) or factor == 0.0:
            raise ValueError(
                f"--scale {name}={factor:g}: the factor must be finite and not 0"
            )
        if columns[name].dtype.kind not in "fiu":
            raise ValueError(f"--scale {name}: the column holds no numbers")
        scaled[name] = columns[name] * factor
    return scaled


def _no_column(option: str, name: str, columns: Columns) -> str:
    return f"{option} {name}: there is no such column; there are {', '.join(columns)}"


def _no_time(columns: Columns) -> str:
    return (
        "there is no column 'time' [s]; rename yours (on the command line, for "
        "example, --rename t=time); "
        f"there are {', '.join(columns)}"
    )


def _as_kind(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """A column in the type of its kind; whole numbers do for flags and floats.

    Infinity is no value of anything that is measured: such a sample is undefined.
    """
    column = COLUMNS_BY_NAME[name]
    if column.kind == "float64" and values.dtype.kind in "iu":
        values = values.astype(np.float64)
    if column.kind in ("int8", "bool") and values.dtype.kind in "fiu":
        values = _whole(name, values, np.bool_ if column.kind == "bool" else np.int8)
    if column.kind == "bool" and not column.nullable:
        values = np.ma.filled(values, False)
    if values.dtype.kind == "f" and name != "time":
        values = np.where(np.isinf(values), np.nan, values)
    return converted(column, values)


def _whole(name: str, values: NDArray[Any], dtype: type[np.generic]) -> NDArray[Any]:
    data = np.ma.getdata(values)
    undefined = np.ma.getmaskarray(values) | np.isnan(data)
    plain = np.where(undefined, 0, data)
    whole: NDArray[Any] = plain.astype(dtype)
    if (whole != plain).any():
        row = int(np.flatnonzero(whole != plain)[0])
        raise ValueError(
            f"column {name!r} is {plain[row]:g} in row {row}; expected "
            f"{'0 or 1' if dtype is np.bool_ else 'a whole number from -128 to 127'}"
        )
    return np.ma.MaskedArray(whole, mask=undefined) if undefined.any() else whole
