"""Who is left out when an adapted network is judged: a driver, or a block of time.

Drivers are left out if at least two of them change lanes. Else the drive is cut half
way between its lane changes and blocks are left out: what is found then holds for this
driver, and for others it is too good.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import SAMPLE_RATE, full_windows
from costeer.training.datasets.folds import folds
from costeer.training.labels import Labels
from costeer.training.recordings import Recording
from costeer.training.triggers import announced

DRIVERS, BLOCKS = "drivers", "blocks"
MOST_BLOCKS = 4

_SIDE = re.compile(r"(:(right|left)(/\d+)?| to the (right|left))$")
"""What the name of a run says beside that of its drive."""


class Parts(NamedTuple):
    """Recordings as they are dealt.

    Attributes:
        kind: What is never split, `DRIVERS` or `BLOCKS`.
        recordings: With its name as their driver.
    """

    kind: str
    recordings: list[Recording]

    @property
    def names(self) -> list[str]:
        """Of what is never split, in order."""
        return sorted({each.driver for each in self.recordings})


def num_changes(recording: Recording) -> int:
    """Lane changes that a trigger could announce: with a full window just before."""
    running = full_windows(recording.features, recording.absent)
    return announced(recording, running).num_crossings


def minutes(recordings: Sequence[Recording]) -> float:
    """Driving that verdicts can be given on [min]; two runs of a drive count once."""
    full = (
        max(int(full_windows(each.features, each.absent).sum()) for each in stretch)
        for stretch in _stretches(recordings)
    )
    return sum(full) / (60.0 * SAMPLE_RATE)


def parts(recordings: Sequence[Recording]) -> Parts:
    """Drivers if at least two of them change lanes, else blocks of time."""
    changing = {each.driver for each in recordings if num_changes(each)}
    if len(changing) >= 2:
        return Parts(DRIVERS, list(recordings))
    return Parts(BLOCKS, _blocks(recordings))


def dealt(
    whole: Parts, most: int, seed: int
) -> list[tuple[list[Recording], list[Recording]]]:
    """Recordings to learn from and to judge on, each part judged once.

    Args:
        whole: At least two parts.
        most: Folds; with as many parts or fewer each is left out by itself.
        seed: Of the order in which parts of equal length are dealt.
    """
    names = whole.names
    if len(names) > most:
        return folds(whole.recordings, most, seed)
    return [
        (
            [each for each in whole.recordings if each.driver != name],
            [each for each in whole.recordings if each.driver == name],
        )
        for name in names
    ]


def _blocks(recordings: Sequence[Recording]) -> list[Recording]:
    """All recordings in pieces, named by their block; equal times are in one block."""
    pieces = [piece for stretch in _stretches(recordings) for piece in _cut(stretch)]
    changes = [sum(map(num_changes, piece)) for piece in pieces]
    before = np.concatenate([[0], np.cumsum(changes)[:-1]])
    total = max(sum(changes), 1)
    num = min(MOST_BLOCKS, max(1, sum(each > 0 for each in changes)))
    return [
        each._replace(driver=f"block {1 + min(int(k) * num // total, num - 1)}")
        for piece, k in zip(pieces, before, strict=True)
        for each in piece
    ]


def _stretches(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Runs of the same drive together: the view to the right and that to the left."""
    found: dict[tuple[str, str], list[Recording]] = {}
    for each in recordings:
        found.setdefault((each.driver, _SIDE.sub("", each.name)), []).append(each)
    return list(found.values())


def _cut(stretch: list[Recording]) -> list[list[Recording]]:
    """A stretch in pieces with a lane change each, if its runs are equally long."""
    if len({len(each.side) for each in stretch}) > 1:
        return [stretch]
    crossed = np.flatnonzero(np.any([each.intended for each in stretch], axis=0))
    edges = [0, *_half_way(crossed), len(stretch[0].side)]
    return [
        [_sliced(each, slice(start, stop)) for each in stretch]
        for start, stop in itertools.pairwise(edges)
    ]


def _half_way(rows: NDArray[np.int64]) -> list[int]:
    return [int(each) for each in (rows[:-1] + rows[1:]) // 2]


def _sliced(whole: Recording, rows: slice) -> Recording:
    return whole._replace(
        features=whole.features[rows],
        side=whole.side[rows],
        crossing=whole.crossing[rows],
        intended=whole.intended[rows],
        labels=Labels(*(each[rows] for each in whole.labels)),
    )
