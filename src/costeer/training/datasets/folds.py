"""Cross-validation on a set: who is judged when."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from costeer.training.recordings import Recording


def folds(
    recordings: Sequence[Recording], num: int, seed: int
) -> list[tuple[list[Recording], list[Recording]]]:
    """Deal the drivers to folds; each fold is judged once by a network of the others.

    Whole drivers are dealt, those with many samples first, each to the fold that has
    the fewest so far; the seed orders drivers of equal length.

    Args:
        recordings: Of at least as many drivers as there are folds.
        num: Of folds, at least 2.
        seed: Of the order.

    Returns:
        For each fold the recordings to train on and those to judge, in the order
        given.

    Raises:
        ValueError: If there are fewer than two folds, or fewer drivers than folds.
    """
    drivers = sorted({r.driver for r in recordings})
    if not 2 <= num <= len(drivers):
        raise ValueError(
            f"{num} folds of {len(drivers)} driver(s); give at least 2 and not more "
            "than there are drivers"
        )
    length = dict.fromkeys(drivers, 0)
    for each in recordings:
        length[each.driver] += len(each.side)
    order = np.random.default_rng([seed, 3]).permutation(len(drivers))
    place, held = {}, [0] * num
    for driver in sorted((drivers[k] for k in order), key=lambda d: -length[d]):
        place[driver] = held.index(min(held))
        held[place[driver]] += length[driver]
    return [
        (
            [r for r in recordings if place[r.driver] != fold],
            [r for r in recordings if place[r.driver] == fold],
        )
        for fold in range(num)
    ]
