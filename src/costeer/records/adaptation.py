"""Tables of others made readable: names, units, stretches, repeated times.

Every command that reads a table of others reads it through here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import COLUMNS_BY_NAME
from costeer.records.contradictions import PAPERS, Lanes, joined
from costeer.records.times import seconds, without_repeated

Columns = Mapping[str, NDArray[Any]]  # Any: of any type

EXTRA_NAMES = ("sequence", "participant", "crossing", "adjacent_side")
"""Columns of a table that a trial record does not have."""


class Adaptation(NamedTuple):
    """How the columns of a foreign table become those of a trial record.

    Attributes:
        renames: Name there to name here.
        scales: Name here to the factor that gives SI units.
        sequence: Column, as named there, that tells separate stretches apart; empty
            if the table is one stretch, or has a column `sequence`, or several
            participants.
        drop_repeated: Whether of rows with the same time only the first is kept.
        join_lanes: Whether the lateral position is from the centre of the lane driven
            in, and jumps at each crossing.
    """

    renames: Mapping[str, str] = {}
    scales: Mapping[str, float] = {}
    sequence: str = ""
    drop_repeated: bool = False
    join_lanes: bool = False


AS_IT_IS = Adaptation()


def adapted(
    columns: Columns, adaptation: Adaptation = AS_IT_IS
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Columns of a table under their names here, in SI units, and notes on them.

    Args:
        columns: As read, shape `(time,)` each.
        adaptation: What to rename and scale.

    Returns:
        The column that tells stretches apart, if one is named, is called `sequence`.

    Raises:
        ValueError: If a name is not there, or a factor is none.
    """
    known = _scaled(_renamed(columns, adaptation.renames), adaptation.scales)
    if adaptation.sequence:
        if adaptation.sequence not in columns:
            raise ValueError(_no_column("--sequence", adaptation.sequence, columns))
        if adaptation.sequence not in COLUMNS_BY_NAME:
            known.pop(adaptation.sequence, None)
        known["sequence"] = columns[adaptation.sequence]
    told = ""
    if "time" in known:
        known["time"], told = seconds(known["time"])
    return known, [told] if told else []


def cleaned(
    columns: Columns, adaptation: Adaptation, lanes: Lanes = PAPERS
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """One stretch as the user wants it: without repeated times, lanes joined.

    Args:
        columns: Of the stretch, shape `(time,)` each.
        adaptation: What is wanted.
        lanes: Of its road.
    """
    found, told = dict(columns), list[str]()
    if adaptation.drop_repeated:
        found, told = without_repeated(found)
    if adaptation.join_lanes and "lateral_position" in found:
        found = joined(found, lanes)
    return found, told


def _renamed(columns: Columns, renames: Mapping[str, str]) -> dict[str, NDArray[Any]]:
    allowed = (*COLUMNS_BY_NAME, *EXTRA_NAMES)
    for old, new in renames.items():
        if old not in columns:
            raise ValueError(_no_column("--rename", old, columns))
        if new not in allowed:
            raise ValueError(
                f"--rename {old}={new}: {new!r} is no column of a trial record; "
                f"choose from {', '.join(allowed)}"
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
