"""What the network is to say: does the car cross to the adjacent side within 3 s.

A sample is positive if the next crossing of a lane boundary comes within the
prediction horizon and leads to the side of the adjacent lane. At the end of a recording
the answer is not known where no crossing follows and the horizon reaches past the last
sample; those samples are neither trained on nor judged.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, Int8
from numpy.typing import NDArray

from costeer.intention.features import SAMPLE_RATE

PREDICTION_HORIZON = 3.0
"""Within this time the car crosses, g of Eq. (2) [s]."""


class Labels(NamedTuple):
    """Truth at each sample of a recording.

    Attributes:
        positive: Whether the car crosses to the adjacent side within the horizon,
            `(time,)`.
        known: Whether that can be told, `(time,)`.
    """

    positive: NDArray[np.bool_]
    known: NDArray[np.bool_]


def crossings(
    lane: Int[NDArray[np.integer], " time"],
) -> Int8[NDArray[np.int8], " time"]:
    """Side of each crossing at the first sample in the new lane, else 0.

    Args:
        lane: Lane of the centre of gravity, counted from the right, shape `(time,)`.

    Returns:
        -1 to the right, +1 to the left, shape `(time,)`.
    """
    change = np.diff(np.asarray(lane, np.int64), prepend=lane[:1])
    return np.sign(change).astype(np.int8)


def labels(
    crossing: Int8[NDArray[np.int8], " time"],
    side: Int8[NDArray[np.int8], " time"],
    horizon: float = PREDICTION_HORIZON,
) -> Labels:
    """Truth at each sample.

    Args:
        crossing: -1 or +1 at the first sample in a new lane, else 0, `(time,)`.
        side: Side of the adjacent lane, -1 or +1, `(time,)`.
        horizon: [s].
    """
    num_samples, reach = len(crossing), round(horizon * SAMPLE_RATE)
    here = np.arange(num_samples)
    where = np.flatnonzero(crossing)
    following = np.searchsorted(where, here, side="right")
    never = num_samples + reach
    next_crossing = np.append(where, never)[following]
    direction = np.append(crossing[where], 0)[following]
    soon = next_crossing - here <= reach
    return Labels(
        positive=soon & (direction == side),
        known=soon | (here + reach < num_samples),
    )


def time_to_crossing(
    crossing: Int8[NDArray[np.int8], " time"],
    side: Int8[NDArray[np.int8], " time"],
) -> Float[NDArray[np.float64], " time"]:
    """Time until the car crosses to the adjacent side [s].

    Args:
        crossing: -1 or +1 at the first sample in a new lane, else 0, `(time,)`.
        side: Side of the adjacent lane, -1 or +1, `(time,)`.

    Returns:
        Infinite where no crossing follows or the next one leads to the other side,
        `(time,)`.
    """
    here = np.arange(len(crossing))
    where = np.flatnonzero(crossing)
    following = np.searchsorted(where, here, side="right")
    next_crossing = np.append(where.astype(np.float64), np.inf)[following]
    direction = np.append(crossing[where], 0)[following]
    time = (next_crossing - here) / SAMPLE_RATE
    return np.where(direction == side, time, np.inf)
