"""Tables of a page, as text in cells."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import NamedTuple

_LIBRARIES = ("numpy", "scipy", "numba", "pyarrow", "pandas", "matplotlib")


class Table(NamedTuple):
    """A table of the report.

    Attributes:
        name: Anchor.
        title: Caption.
        note: What one must know to read it; may be empty.
        header: Names of the columns.
        rows: Text of the cells; a line break in a cell is shown as one.
        num_labels: Leading columns that are words, not numbers.
        prose: Whether cells may be broken into lines anywhere.
        num_words: Last columns that are words, not numbers.
    """

    name: str
    title: str
    note: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    num_labels: int = 1
    prose: bool = False
    num_words: int = 0


MOST_ROWS = 150
"""Rows of a table on the page: the 84 trials of the published study have room."""


def shortened(table: Table) -> Table:
    """Return a table that is not too long for a page; its note says what is cut."""
    more = len(table.rows) - MOST_ROWS
    if more <= 0:
        return table
    note = f"{table.note} {more} more rows stand in the CSV files of the study."
    return table._replace(rows=table.rows[:MOST_ROWS], note=note.strip())


def versions_table() -> Table:
    """Return the programs that made tables, tests, figures and this page."""
    rows = [("costeer", version("costeer")), ("Python", platform.python_version())]
    rows += [(name, version(name)) for name in _LIBRARIES]
    return Table(
        name="versions",
        title="Versions that made this report",
        note="",
        header=("Program", "Version"),
        rows=tuple(rows),
        num_labels=2,
        prose=True,
    )
