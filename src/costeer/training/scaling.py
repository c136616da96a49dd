"""What is known of the signals before a network is trained: means and deviations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    NUM_SCALED,
    approach_series,
    hide,
)
from costeer.training.recordings import Recording


class Scaling(NamedTuple):
    """What is known of the signals before the training.

    Attributes:
        mean: Of the signals and the approach velocity, in their units, `(7,)`.
        scale: Their standard deviations, `(7,)`.
        dispensable: 1 for signals that the network learns to do without,
            `(feature,)`.
    """

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    dispensable: NDArray[np.float64]


def scaling(
    recordings: Sequence[Recording], dispensable: NDArray[np.float64]
) -> Scaling:
    """Mean and standard deviation of each signal over the samples that have it.

    Args:
        recordings: To train on.
        dispensable: Signals that the network learns to do without, `(feature,)`.

    Raises:
        ValueError: If a signal never changes or is never there, and the network cannot
            do without it.
    """
    rows = np.concatenate([hide(r.features, r.absent) for r in recordings])
    rows[~np.isfinite(rows)] = np.nan
    rows = np.column_stack([rows, approach_series(rows)])
    there = np.isfinite(rows).any(axis=0)
    mean, scale = np.zeros(NUM_SCALED), np.ones(NUM_SCALED)
    mean[there] = np.nanmean(rows[:, there], axis=0)
    scale[there] = np.nanstd(rows[:, there], axis=0)
    for place, name in enumerate(FEATURES):
        if there[place] and scale[place] > 0.0:
            continue
        if dispensable[place]:
            scale[place] = 1.0
            continue
        raise ValueError(
            f"{name} never changes in the training recordings; a network needs signals "
            "that do"
        )
    scale[scale == 0.0] = 1.0
    return Scaling(mean=mean, scale=scale, dispensable=dispensable)
