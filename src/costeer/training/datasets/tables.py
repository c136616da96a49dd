"""Reading the tables of a set: CSV, packed by gzip or not."""

from __future__ import annotations

import csv
import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Table = dict[str, NDArray[Any]]  # Any: text columns beside numbers


class Columns(NamedTuple):
    """Which columns of a table are read.

    Attributes:
        numbers: Columns of numbers; an empty cell is NaN.
        texts: Columns of text.
    """

    numbers: tuple[str, ...]
    texts: tuple[str, ...] = ()


def stored(path: Path) -> Path | None:
    """The file, or the same without `.gz`; None if neither is there."""
    plain = path.with_suffix("") if path.suffix == ".gz" else path
    return next((each for each in (path, plain) if each.is_file()), None)


def table_of(folder: Path, file: str, columns: Columns) -> Table:
    """Read a table that must be in a folder, packed or not.

    Args:
        folder: Of the set.
        file: Its name; without `.gz` it is found too.
        columns: Which.

    Raises:
        ValueError: If it is not there, or as `read_table` says.
    """
    path = stored(folder / file)
    if path is None:
        raise ValueError(
            f"'{folder}' holds no {file}; name the folder that does, packed or not"
        )
    return read_table(path, columns)


def read_table(path: Path, columns: Columns) -> Table:
    """Read some columns of a CSV, packed by gzip or not.

    Args:
        path: Of the file; `.gz` is unpacked.
        columns: Which.

    Returns:
        Arrays of equal length by column name.

    Raises:
        ValueError: If the file cannot be read, lacks a column or a cell is no number.
    """
    try:
        rows = list(_rows(path))
    except (OSError, EOFError, zlib.error, UnicodeDecodeError, csv.Error) as fault:
        raise ValueError(
            f"{path} cannot be read ({fault}); fetch the file anew"
        ) from None
    header, body = (rows[0], rows[1:]) if rows else ([], [])
    places = _places(path, header, columns.numbers + columns.texts)
    cut = next((k for k, row in enumerate(body) if len(row) != len(header)), None)
    if cut is not None:
        raise ValueError(
            f"{path} has {len(body[cut])} cells in row {cut + 2} and {len(header)} "
            "column names; fetch the file anew"
        )
    cells = {name: [row[place] for row in body] for name, place in places.items()}
    numbers = {name: _numbers(path, name, cells[name]) for name in columns.numbers}
    return numbers | {name: np.array(cells[name], str) for name in columns.texts}


def _rows(path: Path) -> Iterator[list[str]]:
    """Rows of a CSV without the empty ones."""
    if path.suffix == ".gz":
        with gzip.open(path, "rt", encoding="utf-8", newline="") as packed:
            yield from (row for row in csv.reader(packed) if row)
    else:
        with path.open(encoding="utf-8", newline="") as plain:
            yield from (row for row in csv.reader(plain) if row)


def _places(path: Path, header: list[str], names: tuple[str, ...]) -> dict[str, int]:
    missing = [name for name in names if name not in header]
    if missing:
        raise ValueError(
            f"{path} has no column {', '.join(missing)}; it has "
            f"{', '.join(header) or 'none'}"
        )
    return {name: header.index(name) for name in names}


def _numbers(path: Path, name: str, cells: list[str]) -> NDArray[np.float64]:
    """A column of numbers; empty cells are NaN."""
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        try:
            values[row] = float(cell or "nan")
        except ValueError:
            raise ValueError(
                f"{path} holds '{cell}' as {name} in row {row + 2}; give a number or "
                "leave the cell empty"
            ) from None
    return values


def groups(keys: NDArray[Any]) -> Iterator[NDArray[np.intp]]:
    """Rows of each key, in the order in which the keys first appear.

    Args:
        keys: Shape `(row,)`.
    """
    _, first, place = np.unique(keys, return_index=True, return_inverse=True)
    ordered = np.argsort(place, kind="stable")
    parts = np.split(ordered, np.flatnonzero(np.diff(place[ordered])) + 1)
    if keys.size:
        yield from (parts[key] for key in np.argsort(first))
