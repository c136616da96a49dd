"""Where recordings of people lie; their tables are read as training reads them."""

from __future__ import annotations

import os
from pathlib import Path

from costeer.training.datasets.tables import Columns, Table, groups, read_table, stored

__all__ = [
    "ENVIRONMENT",
    "FILES",
    "Columns",
    "Table",
    "data_folder",
    "groups",
    "read_table",
    "table_path",
]

ENVIRONMENT = "COSTEER_DATA"
"""Environment variable that names the folder."""

FILES = {
    "ngsim_lc": "sequences.csv.gz",
    "brain4cars_head": "frames.csv.gz",
    "leeds_steering_onset": "trials.csv.gz",
    "r3_driving": "expert.csv.gz",
    "ngsim_i80_following": "pairs.csv.gz",
    "udacity_steering": "ch2_20hz.csv.gz",
    "comma2k19_example": "can_80hz.csv.gz",
    "gps_lane_changes": "annotations.csv",
}
"""Sets that are read, one subfolder each, and the table that must be there."""


def data_folder(folder: Path | None = None) -> Path | None:
    """The folder with the recordings: the argument, else COSTEER_DATA, else none.

    Args:
        folder: As the user named it.

    Raises:
        ValueError: If the folder does not exist or holds none of the sets.
    """
    named = f"folder '{folder}'"
    if folder is None:
        text = os.environ.get(ENVIRONMENT, "")
        if not text:
            return None
        folder, named = Path(text), f"{ENVIRONMENT} '{text}'"
    if not folder.is_dir():
        raise ValueError(
            f"{named} is no folder; name the one that holds {', '.join(FILES)}, or "
            "name none to go without recordings"
        )
    if not any(table_path(folder, name) for name in FILES):
        raise ValueError(
            f"{named} holds none of the sets; it needs at least one of "
            + ", ".join(f"{name}/{file}" for name, file in FILES.items())
        )
    return folder


def table_path(folder: Path | None, name: str, file: str = "") -> Path | None:
    """Path of a set's table (or another file of it), packed or not; None if absent."""
    if folder is None:
        return None
    return stored(folder / name / (file or FILES[name]))
