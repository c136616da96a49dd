"""What every predictor of a lane crossing is: signals in, a probability out."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import FEATURES

Probabilities: TypeAlias = Callable[
    [NDArray[np.float64], tuple[str, ...]], NDArray[np.float64]
]
"""From `features`, shape `(time, feature)`, facing right, and the names of the signals
that this recording does not have, to the crossing probability, shape `(time,)`."""


class Predictor(NamedTuple):
    """One way to tell that the car is about to cross.

    Attributes:
        name: By which it is chosen, as "gru".
        title: In tables and figures.
        source: Publication that it is built from.
        needs: Signals of Eq. (1) without which it says nothing.
        probabilities: Verdict at every sample of a stretch: NaN until 180 valid samples
            in a row are there (`features.valid_samples`), and while it lacks what it
            needs.

    Example:
        >>> import costeer, numpy as np
        >>> def turned(features, absent):
        ...     said = np.clip(5.0 * features[:, 0], 0.0, 1.0)
        ...     said[:179] = np.nan
        ...     return said
        >>> head = costeer.Predictor("turned", "Turned head", "", ("head_yaw",), turned)
        >>> record = costeer.simulate("weak-gentle", length=200, predictor=head)
        >>> record.metadata["predictor"]
        'turned'
    """

    name: str
    title: str
    source: str
    needs: tuple[str, ...]
    probabilities: Probabilities


def lacking(predictor: Predictor, absent: tuple[str, ...]) -> tuple[str, ...]:
    """Signals that a predictor needs and a recording does not have."""
    return tuple(
        name for name in FEATURES if name in predictor.needs and name in absent
    )
