"""The verdicts of the exact window from four states, but where these do not agree.

The exact verdict depends on the sample at which its window starts, and no single other
start tells it: the exact window may say 0.6 where one begun 20 samples earlier says
0.001. So the same network is run from four starts, 60 samples apart, and the exact one
lies between two of them. Of the three older states, of 60 to 239 samples:

- all are below the band: the verdict is no, and its number that of the oldest;
- all are above it, and the last exact verdicts were yes: yes, in the same way;
- else the exact window is replayed from a ring of what the last 180 samples add to each
  row, four windows that end one after another at a time.

With an open band every verdict is exact, to the last bit. That the others have the
right sign is no theorem, but tested for each network (`training.bracket_check`);
one that is not tested runs with the open band (docs/decisions/0018-bracket.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import inlined
from costeer.base.entry import entry
from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH, IntentionSample
from costeer.intention.starts import (
    CONFIRMED,
    NEXT,
    NUM_SEEN,
    BracketState,
    BracketWeights,
    exact_logit,
    initial_state,
    reset,
    three,
    watch,
)
from costeer.intention.taking import take

CONFIRMATIONS = 3
"""Exact verdicts of yes in a row before states above the band are believed [-]: a
trigger begins with exact windows. Source: paper's reading, 3 samples are a trigger."""


@inlined
def _decided(
    weights: BracketWeights,
    state: BracketState,
    number: int,
    logits: tuple[float, float, float],
) -> float:
    """Logit of the verdict on the newest sample, see the top of this file."""
    counters = state.counters
    least, most = min(logits), max(logits)
    if most < weights.low:
        counters[CONFIRMED] = 0
        return logits[0]
    if least > weights.high and counters[CONFIRMED] >= CONFIRMATIONS:
        return logits[0]
    exact = exact_logit(weights, state, number)
    counters[CONFIRMED] = counters[CONFIRMED] + 1 if exact >= 0.0 else 0
    return exact


@entry
def advance(
    weights: BracketWeights, state: BracketState, sample: IntentionSample
) -> float:
    """Take one 60 Hz sample; return the crossing probability.

    Args:
        weights: Packed by `bracket_weights`.
        state: Of this driver, changed in place.
        sample: Facing right (`features.facing`).

    Returns:
        In [0, 1], on the side of 0.5 on which the exact window is; NaN as
        `wavefront.advance` gives it.
    """
    if not take(weights.scaling, state.absent, state.inputs, sample):
        reset(state)
        return math.nan
    number = state.counters[NUM_SEEN]
    watch(weights, state, number)
    if number + 1 < WINDOW_LENGTH:
        return math.nan
    logits = three(weights, state, number)
    return 1.0 / (1.0 + math.exp(-_decided(weights, state, number, logits)))


@entry
def _advance_over(
    weights: BracketWeights,
    state: BracketState,
    features: NDArray[np.float64],
    told: NDArray[np.float64],
) -> None:
    for step in range(features.shape[0]):
        row = features[step]
        sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
        told[step, 0] = advance(weights, state, sample)
        number = state.counters[NUM_SEEN] - 1
        told[step, 1] = told[step, 2] = math.nan
        told[step, 3] = 0.0
        if number + 1 >= WINDOW_LENGTH:
            logits = three(weights, state, number)
            told[step, 1], told[step, 2] = min(logits), max(logits)
            told[step, 3] = state.counters[NEXT] == state.counters[NUM_SEEN]


class Watched(NamedTuple):
    """What was said of one recording.

    Attributes:
        probability: As `advance` gives it, `(time,)`.
        least: Lowest logit of the three older states, NaN without a verdict, `(time,)`.
        most: Highest, `(time,)`.
        exact: Whether the exact window was asked, `(time,)`.
    """

    probability: NDArray[np.float64]
    least: NDArray[np.float64]
    most: NDArray[np.float64]
    exact: NDArray[np.bool_]


def watched(
    weights: BracketWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> Watched:
    """Verdict at every sample of one recording, and what the states said.

    Args:
        weights: Packed by `bracket_weights`.
        features: In the signals' units, facing right, NaN where missing, shape
            `(time, feature)`.
        absent: Signals that the recording does not have.

    Raises:
        ValueError: If the last axis does not hold the six signals, or the network
            cannot do without an absent one.
    """
    if features.ndim != 2 or features.shape[1] != NUM_FEATURES:
        raise ValueError(
            f"features have the shape {features.shape}; they need "
            f"(time, {NUM_FEATURES}), the signals of Eq. (1) last"
        )
    told = np.empty((len(features), 4))
    series = np.ascontiguousarray(features, np.float64)
    _advance_over(weights, initial_state(weights, absent), series, told)
    probability, least, most, exact = told.T
    return Watched(probability, least, most, exact > 0.5)
