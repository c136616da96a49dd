"""Lane changes on US-101 and I-80, smoothed by their author (set `ngsim_lc`).

One vehicle a sequence, 10 Hz. No lane line is known: the distance is absent, and the
time of the largest lateral speed to the labelled side stands for the crossing. Both
runs of every sequence exist, for no lane can be told to be the last.

Left out are sequences that hardly moved to the side of their label, that moved two
lanes (the label tells one crossing), and that repeat another: some lane changes are in
the source twice or thrice, cut differently.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.training.datasets.stretches import Crossing, Stretch, both_runs
from costeer.training.datasets.tables import Columns, Table, groups, table_of
from costeer.training.recordings import Recording

FILES = ("sequences.csv.gz",)

_COLUMNS = Columns(
    numbers=("t", "v", "vlat", "a", "psi", "y"), texts=("seq", "site", "label")
)
_SIDES = {"L": 1, "R": -1, "K": 0}


class NgsimChangeParameters(NamedTuple):
    """Which sequences are lane changes.

    Attributes:
        least_displacement: To the labelled side between first and last row [m].
            Source: assumed; a car that moved less has not changed lanes in view.
        most_displacement: Above it there were two lane changes [m]. Source: assumed,
            between one and two lanes of 3.66 m.
        most_common_rows: With more rows in common two sequences are one [-]. Source:
            assumed, 1 s; sequences with any in common have at least 1.3 s.
    """

    least_displacement: float = 1.0
    most_displacement: float = 5.0
    most_common_rows: int = 10


PARAMETERS = NgsimChangeParameters()


def read(folder: Path) -> list[Recording]:
    """Recordings of the set.

    Args:
        folder: With `sequences.csv.gz`.

    Raises:
        ValueError: If the table cannot be read or has an unknown label.
    """
    table = table_of(folder, FILES[0], _COLUMNS)
    every = list(groups(table["seq"]))
    first = _without_repeats(table, every)
    chosen = [rows for rows in first if _is_clear(table, rows)]
    notes = (
        f"{len(every) - len(first)} sequences left out because they repeat another, "
        f"{len(first) - len(chosen)} because their label does not fit their motion",
        "no lane line: the largest lateral speed stands for the crossing",
        "the source smoothed its signals, most likely with a look ahead",
        "sequences of lane keeping count as known to go on so for 3 s",
    )
    stretches = [_stretch(table, rows, notes) for rows in chosen]
    return [run for stretch in stretches for run in both_runs(stretch)]


def change_side(table: Table, rows: NDArray[np.intp]) -> int:
    """Side of the labelled lane change, 0 for lane keeping.

    Raises:
        ValueError: If the label is another.
    """
    label = str(table["label"][rows[0]])
    if label not in _SIDES:
        raise ValueError(
            f"sequence {table['seq'][rows[0]]} has the label '{label}'; give L, R "
            "(lane changes) or K (lane keeping)"
        )
    return _SIDES[label]


def peak_row(table: Table, rows: NDArray[np.intp]) -> int:
    """Row of the sequence with the largest lateral speed to the labelled side."""
    return int(np.argmax(change_side(table, rows) * table["vlat"][rows]))


def _stretch(table: Table, rows: NDArray[np.intp], notes: tuple[str, ...]) -> Stretch:
    side = change_side(table, rows)
    time = table["t"][rows]
    name = f"ngsim_lc:{table['seq'][rows[0]]}"
    return Stretch(
        driver=name,
        name=name,
        time=time,
        signals={
            "longitudinal_acceleration": table["a"][rows],
            "longitudinal_velocity": table["v"][rows],
            "yaw_angle": table["psi"][rows],
        },
        crossings=[Crossing(float(time[peak_row(table, rows)]), side)] if side else [],
        keeps_lane=side == 0,
        notes=notes,
    )


def _is_clear(table: Table, rows: NDArray[np.intp]) -> bool:
    """Whether the label fits the motion."""
    side = change_side(table, rows)
    moved = side * (table["y"][rows[-1]] - table["y"][rows[0]])
    return side == 0 or bool(
        PARAMETERS.least_displacement <= moved <= PARAMETERS.most_displacement
    )


def _without_repeats(
    table: Table, every: list[NDArray[np.intp]]
) -> list[NDArray[np.intp]]:
    """Sequences in order; of those with rows in common the longest."""
    seen: set[tuple[float, ...]] = set()
    kept = []
    for rows in sorted(every, key=len, reverse=True):
        motion = {
            tuple(row)
            for row in np.stack([table[key][rows] for key in ("v", "vlat", "a")], 1)
        }
        if len(motion & seen) <= PARAMETERS.most_common_rows:
            kept.append(rows)
            seen |= motion
    return sorted(kept, key=lambda rows: int(rows[0]))
