"""A trial record as a MAT file (version 5), which MATLAB and Octave load."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import replacing
from costeer.export.mcap import finite
from costeer.records.columns import COLUMNS, TrialRecord

_HEADER = b"MATLAB 5.0 MAT-file, written by costeer".ljust(116)
"""A MAT file's text for people, where others put the date."""

_LONGEST_NAME = 63


def write_matlab(record: TrialRecord, path: str | os.PathLike[str]) -> None:
    """Write a record as MAT file, whole or not at all; the same record, the same bytes.

    The file holds `columns`, a struct with a vector for each column; `units`, a struct
    of texts; `labels`, a struct with the words of columns that are texts, which are
    numbers from 0 in `columns`; `metadata`, the description of the trial as JSON for
    `jsondecode`. Numbers are doubles, NaN where they are undefined; flags are logical,
    but doubles where they may be undefined.

    Args:
        record: The trial.
        path: File to write or replace.

    Raises:
        ValueError: If a name is too long for a field of a struct.
        OSError: If the file cannot be written; then nothing is left of it.
    """
    from scipy.io import savemat

    declared = {each.name: each for each in (*COLUMNS, *record.method_columns)}
    labels = {
        name: list(each.labels)
        for name, each in declared.items()
        if each.labels and name in record.columns
    }
    content: dict[str, Any] = {  # Any: as MATLAB has it
        "columns": {n: _plain(v, labels.get(n)) for n, v in record.columns.items()},
        "units": {n: declared[n].unit if n in declared else "" for n in record.columns},
        "labels": {n: np.array(words, dtype=object) for n, words in labels.items()},
        "metadata": json.dumps(finite(record.metadata), sort_keys=True),
    }
    _check_names(record)
    with replacing(Path(path)) as partial:
        savemat(
            str(partial),
            content,
            appendmat=False,
            do_compression=True,
            long_field_names=True,
            oned_as="column",
        )
        with partial.open("r+b") as file:
            file.write(_HEADER)


def _check_names(record: TrialRecord) -> None:
    for name in record.columns:
        if not name.isidentifier() or name.startswith("_") or len(name) > _LONGEST_NAME:
            raise ValueError(
                f"column {name!r} cannot be a field of a struct; MATLAB takes up to "
                f"{_LONGEST_NAME} letters, digits and underscores, a letter first"
            )


# Any: the element type differs from column to column.
def _plain(values: NDArray[Any], labels: list[str] | None) -> NDArray[Any]:
    """A column as MATLAB has it: doubles or logicals."""
    if labels is not None:
        return coded(values, labels)
    if values.dtype.kind == "b" and not isinstance(values, np.ma.MaskedArray):
        return values
    if values.dtype.kind in "US":
        return np.array(values.astype(str).tolist(), dtype=object)
    numbers = np.ma.getdata(values).astype(np.float64)
    numbers[np.ma.getmaskarray(values)] = np.nan
    return numbers


def coded(values: NDArray[Any], labels: list[str]) -> NDArray[np.float64]:
    """Texts as numbers from 0, in the order of their labels; NaN for others."""
    numbers = np.full(values.size, np.nan)
    for place, label in enumerate(labels):
        numbers[values == label] = place
    return numbers
