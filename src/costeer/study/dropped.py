"""Names the data that the statistics could not use: who, which cell, why."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from costeer.study.cells import (
    CONDITION,
    STRENGTH,
    Observations,
    Roster,
    Table,
    labels,
    level_of,
    numbers,
    participant_means,
)
from costeer.study.outcome import DroppedRow
from costeer.study.rows import joined

ALL = "all"
"""In place of a participant or cell: every one of them."""


def dropped_lane_changes(table: Table, measure: str) -> Iterator[DroppedRow]:
    """Yield the lane changes that have no value of a measure.

    Args:
        table: Lane changes, with a column `index` that numbers them.
        measure: Name of the measure.
    """
    if measure not in table:
        return
    missing = np.flatnonzero(~np.isfinite(numbers(table, measure))).tolist()
    who, where = labels(table, "participant"), labels(table, CONDITION)
    which = labels(table, "index") if missing else who
    for row in missing:
        yield DroppedRow(
            measure=measure,
            participant=str(who[row]),
            cell=f"{where[row]} lane change {which[row]}",
            reason="no value for this lane change; it counts in no test",
        )


def dropped_cells(
    measure: str, by_strength: bool, observed: Observations, everyone: Roster
) -> Iterator[DroppedRow]:
    """Yield the cells of participant and condition that have no value of a measure.

    Args:
        measure: Name of the measure.
        by_strength: Whether its strengths are compared too.
        observed: Its values.
        everyone: Participants and conditions that should have one.
    """
    if observed.values.size == 0:
        yield DroppedRow(measure, ALL, ALL, "no value in the table; nothing is tested")
        return
    participants, names = everyone
    known = np.isfinite(participant_means(observed, participants, CONDITION, names))
    for column, name in enumerate(names):
        if not known[:, column].any():
            reason = "no value from anyone; the condition is left out"
            yield DroppedRow(measure, ALL, name, reason)
            continue
        for row in np.flatnonzero(~known[:, column]).tolist():
            spared = by_strength and _strength_known(known[row], names, name)
            reason = joined(_LEFT_OUT, _SPARED if spared else "")
            yield DroppedRow(measure, participants[row], name, reason)


_LEFT_OUT = (
    "no value; the participant is left out of repeated-measures tests and pairs that "
    "need it, and kept in the mixed model"
)
_SPARED = "the participant's mean of this strength is taken without it"


def _strength_known(known: NDArray[np.bool_], names: Sequence[str], name: str) -> bool:
    """Whether another condition of the same strength has a value."""
    strength = level_of(name, STRENGTH)
    return any(
        present and level_of(other, STRENGTH) == strength
        for other, present in zip(names, known.tolist(), strict=True)
    )
