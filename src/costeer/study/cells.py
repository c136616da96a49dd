"""From tables to cells: who has which value in which condition, and what is missing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.methods.conditions import CONDITION_NAMES, condition

Column = Sequence[object] | NDArray[np.generic]
Table = Mapping[str, Column]
"""Columns by name, all of one length; a data frame passes as one."""

Labels = NDArray[np.str_]

CONDITION = "condition"
STRENGTH = "strength"
CHANGE_DURATION = "change_duration"


class Roster(NamedTuple):
    """Who and what a study has.

    Attributes:
        participants: Names, numbers in their order before other names.
        conditions: Names, in the order of Table IV.
    """

    participants: tuple[str, ...]
    conditions: tuple[str, ...]


class Observations(NamedTuple):
    """Finite values of one measure, one entry each.

    Attributes:
        participants: Who, shape (observations,).
        conditions: In which condition, shape (observations,).
        values: In the measure's unit, shape (observations,).
    """

    participants: Labels
    conditions: Labels
    values: NDArray[np.float64]


def roster(tables: Iterable[Table]) -> Roster:
    """Return all participants and conditions that occur in the tables.

    Raises:
        ValueError: If a condition is unknown or columns differ in length.
    """
    participants: set[str] = set()
    conditions: set[str] = set()
    for table in tables:
        participants.update(labels(table, "participant").tolist())
        conditions.update(labels(table, CONDITION).tolist())
        _check_lengths(table)
    for name in sorted(conditions):
        condition(name)
    return Roster(
        participants=tuple(sorted(participants, key=numbers_first)),
        conditions=tuple(name for name in CONDITION_NAMES if name in conditions),
    )


def labels(table: Table, name: str) -> Labels:
    """Return a column as text; a table without columns has no rows.

    Raises:
        ValueError: If a table with columns lacks this one.
    """
    if len(list(table)) == 0:
        return np.array([], dtype=np.str_)
    if name not in table:
        raise ValueError(f"no column {name!r}; there are {', '.join(table)}")
    return np.array([str(value) for value in table[name]], dtype=np.str_)


def numbers(table: Table, name: str) -> NDArray[np.float64]:
    """Return a column as numbers, NaN where it has none or is not there at all.

    Raises:
        ValueError: If an entry is no number.
    """
    if name not in table:
        return np.full(labels(table, CONDITION).size, np.nan)
    column = table[name]
    try:
        # A masked entry is a missing one; a plain array would show what lies beneath.
        if isinstance(column, np.ma.MaskedArray):
            return np.ma.filled(column.astype(np.float64), np.nan)
        return np.asarray(column, dtype=np.float64)
    except ValueError as error:
        raise ValueError(f"column {name!r} holds no numbers: {error}") from None


def observations(table: Table, measure: str) -> Observations:
    """Return the finite values of a measure with their participant and condition."""
    values = numbers(table, measure)
    known = np.isfinite(values)
    return Observations(
        participants=labels(table, "participant")[known],
        conditions=labels(table, CONDITION)[known],
        values=values[known],
    )


def levels(names: Sequence[str], factor: str) -> tuple[str, ...]:
    """Return the levels of `condition` or `strength` among conditions, in order."""
    return tuple(dict.fromkeys(level_of(name, factor) for name in names))


def level_of(name: str, factor: str) -> str:
    """Return the level of `condition` or `strength` that a condition has."""
    return name if factor == CONDITION else condition(name).strength


def level_indices(
    observed: Observations, factor: str, names: Sequence[str]
) -> NDArray[np.intp]:
    """Index of each observation's level in `names`, -1 if it is none of them."""
    index = {name: i for i, name in enumerate(names)}
    of_condition = {
        name: index.get(level_of(name, factor), -1)
        for name in np.unique(observed.conditions).tolist()
    }
    found = [of_condition[name] for name in observed.conditions.tolist()]
    return np.array(found, dtype=np.intp)


def participant_means(
    observed: Observations,
    participants: Sequence[str],
    factor: str,
    names: Sequence[str],
) -> NDArray[np.float64]:
    """Mean of each participant's values at each level.

    Args:
        observed: Values of one measure.
        participants: The rows to give.
        factor: `condition` or `strength`.
        names: Levels of the factor, the columns to give.

    Returns:
        Shape (participants, levels), NaN where there is no value.
    """
    columns = level_indices(observed, factor, names)
    row_of = {name: i for i, name in enumerate(participants)}
    rows = np.array([row_of[name] for name in observed.participants.tolist()], int)
    kept = columns >= 0
    cells = rows[kept] * len(names) + columns[kept]
    num_cells = len(participants) * len(names)
    counts = np.bincount(cells, minlength=num_cells)
    sums = np.bincount(cells, weights=observed.values[kept], minlength=num_cells)
    means = np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
    return means.reshape(len(participants), len(names))


def _check_lengths(table: Table) -> None:
    lengths = {name: len(table[name]) for name in table}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"columns differ in length: {lengths}")


def numbers_first(name: str) -> tuple[bool, int, str]:
    """Key that sorts numbers in their order before other names."""
    return (not name.isdecimal(), int(name) if name.isdecimal() else 0, name)
