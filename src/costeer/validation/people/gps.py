"""Durations annotated from video on Dutch motorways (set `gps_lane_changes`).

Driessen, Prasad, Bazilinskyy and de Winter (2022): when sideways motion starts and
ends, as an observer saw it; only some lane changes of one trip have both.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from costeer.validation.people.findings import Values
from costeer.validation.people.folder import Columns, read_table, table_path

LONGEST = 20.0
"""Two rows have a typing error of ten minutes; longer than this is none [s]."""

_COLUMNS = Columns(numbers=("t_start", "t_end"))


def annotated_durations(folder: Path | None) -> Values:
    """Durations that were annotated, shape `(change,)` [s]; empty if absent.

    Args:
        folder: With the sets.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "gps_lane_changes")
    if path is None:
        return np.empty(0)
    table = read_table(path, _COLUMNS)
    durations = table["t_end"] - table["t_start"]
    return np.asarray(durations[np.abs(durations) < LONGEST])
