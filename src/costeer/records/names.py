"""Rows that belong together by a name: stretches of a table, and its participants."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

EMPTY = "empty"
"""How rows without a name are called."""


class Group(NamedTuple):
    """Rows of one name.

    Attributes:
        name: As the table writes it, or `EMPTY`.
        rows: In the order of the table.
    """

    name: str
    rows: NDArray[np.intp]


def names_of(keys: NDArray[Any]) -> NDArray[np.str_]:  # Any: of any type
    """Keys as names; undefined ones are called `EMPTY`."""
    names = np.ma.getdata(keys).astype(str)
    undefined = np.ma.getmaskarray(keys) | np.isin(names, ("", "nan", "NaT"))
    return np.where(undefined, EMPTY, names)


def groups(keys: NDArray[Any]) -> list[Group]:  # Any: of any type
    """The rows of each name, in the order in which the names begin."""
    names = names_of(keys)
    values, firsts, codes = np.unique(names, return_index=True, return_inverse=True)
    return [
        Group(str(values[i]), np.flatnonzero(codes == i)) for i in np.argsort(firsts)
    ]


def empty_told(column: str, keys: NDArray[Any]) -> list[str]:  # Any: of any type
    """A note on rows that have no name, if there are some."""
    empty = np.flatnonzero(names_of(keys) == EMPTY)
    if not empty.size:
        return []
    return [
        f"{column} is empty in {empty.size} rows, first in row {empty[0]}: taken as "
        f"one group, named '{EMPTY}'"
    ]
