"""The mirrored world, for tests: each column as its declaration says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from costeer.records.columns import COLUMNS_BY_NAME, Column

LANE_WIDTH = 3.5

Values = NDArray[Any]  # Any: the element type differs from column to column


def mirrored_column(column: Column, values: Values) -> Values:
    """A column as the mirrored world shows it."""
    if column.mirrored == "flipped":
        return -values
    if column.mirrored == "swapped":
        return 1 - values
    return -LANE_WIDTH - values if column.mirrored == "reflected" else values


def mirrored(columns: Mapping[str, Values]) -> dict[str, Values]:
    """The same drive with left and right swapped."""
    return {
        name: mirrored_column(COLUMNS_BY_NAME[name], values)
        for name, values in columns.items()
    }
