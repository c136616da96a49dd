"""Recordings of others made readable: names, units, stretches.

A recording needs `time` in seconds and any of a trial record's columns in SI units.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.plant.fleet import MOST_CARS
from costeer.records.adaptation import AS_IT_IS, Adaptation, adapted, cleaned
from costeer.records.cars import car_columns
from costeer.records.checks import converted
from costeer.records.columns import COLUMNS_BY_NAME, Column
from costeer.records.contradictions import PAPERS, Lanes
from costeer.records.names import empty_told, groups
from costeer.records.times import no_time
from costeer.study.definitions import Columns


class Stretch(NamedTuple):
    """One continuous recording.

    Attributes:
        name: Value of the sequence column; empty if there is none.
        columns: Those that are known, in their own types, shape `(time,)` each.
        ignored: Names of the others.
        notes: What was made of the table's columns.
    """

    name: str
    columns: Columns
    ignored: tuple[str, ...]
    notes: tuple[str, ...] = ()


_DECLARED: dict[str, Column] = COLUMNS_BY_NAME | {
    column.name: column for column in car_columns(MOST_CARS)
}
"""Columns of a record, those of other cars among them, by name."""

_NEEDED = ("time", "lateral_position", "yaw_angle", "steering_wheel_angle")
"""Columns that the measures rest on; one that cannot be read is refused."""


def stretches(
    columns: Columns, adaptation: Adaptation = AS_IT_IS, lanes: Lanes = PAPERS
) -> tuple[Stretch, ...]:
    """Rename, scale and split the columns of a table.

    Args:
        columns: As read, shape `(time,)` each.
        adaptation: What to rename and scale, and how to split.
        lanes: Of the road.

    Returns:
        The stretches in the order in which they begin.

    Raises:
        ValueError: If a name is not there, there is no `time`, or a column holds
            what it cannot.
    """
    renamed, notes = adapted(columns, adaptation)
    key = _key(renamed)
    known, unused = _known(renamed)
    notes += unused
    if "time" not in known:
        raise ValueError(no_time(columns))
    ignored = tuple(k for k in renamed if k not in _DECLARED and k != key)
    parts = [("", known)]
    if key:
        notes += empty_told(key, renamed[key])
        parts = [
            (name, {k: values[rows] for k, values in known.items()})
            for name, rows in groups(renamed[key])
        ]
    return tuple(
        _stretch(Stretch(name, part, ignored, tuple(notes)), adaptation, lanes)
        for name, part in parts
    )


def _key(columns: Columns) -> str:
    """The column that tells stretches apart, if nobody names it."""
    if "sequence" in columns:
        return "sequence"
    several = "participant" in columns and len(groups(columns["participant"])) > 1
    return "participant" if several else ""


def _stretch(part: Stretch, adaptation: Adaptation, lanes: Lanes) -> Stretch:
    """The stretch as the user wants it: without repeated times, lanes joined."""
    columns, told = cleaned(part.columns, adaptation, lanes)
    return part._replace(columns=columns, notes=(*part.notes, *told))


def _known(columns: Columns) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Columns of a record in their own types, and notes on those that cannot be.

    Raises:
        ValueError: If a column that the measures rest on cannot be.
    """
    known: dict[str, NDArray[Any]] = {}
    notes = []
    for name in columns:
        if name not in _DECLARED:
            continue
        try:
            known[name] = _as_kind(name, columns[name])
        except ValueError as error:
            if name in _NEEDED:
                raise
            notes.append(f"{name} is not used: {error}")
    return known, notes


def _as_kind(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """A column in the type of its kind; whole numbers do for flags and floats.

    Infinity is no value of anything that is measured: such a sample is undefined.
    """
    column = _DECLARED[name]
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
