"""A cheaper form of the exact window: a watcher, and exact windows where it stirs.

The approximate window of sparse.py watches every sample. While its probability is below
a gate, that is the verdict. Otherwise the verdict is that of the exact window, to the
last bit, from a ring of the last 180 samples: the windows that end at this sample and
at the next ones, as many as fill a tile of the kernel, are replayed together, and then
advanced with each new sample until the last of them has ended.

So a verdict of at least 0.5 is always the exact one; what can differ is a verdict that
the watcher put below the gate. That none does is neither proven nor tested on 10,000
km: docs/bench.md says what was seen. It is an option for long batches. On a real-time
drive the exact wavefront is the better choice, because a replay takes 180 steps of a
tile in one tick.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.windows import sparse
from benchmarks.windows.sparse import STRIDE, SparseState, SparseWeights, advance_few
from costeer.base.array import compiled
from costeer.base.entry import entry
from costeer.intention import wavefront
from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH, IntentionSample
from costeer.intention.gru import NetworkWeights
from costeer.intention.kernel import TILE
from costeer.intention.wavefront import (
    WavefrontState,
    WavefrontWeights,
    advance_states,
    project,
    take,
    verdict,
)

GATE = 0.005
"""Watcher's probability from which exact windows are opened [-].

Source: a third of the least that the watcher said on 640 km where the exact window
triggered. Not tested on other drivers yet; 0.02 lost a trigger (docs/bench.md).
"""

_NUM_SEEN = 0
_FIRST = 1
_NEXT = 2


class CascadeWeights(NamedTuple):
    """The network as both of its forms take it.

    Attributes:
        exact: For the wavefront.
        watcher: For the approximate window.
        gate: Watcher's probability from which exact windows are opened [-].
        stride: Of the watcher; see sparse.py [-].
    """

    exact: WavefrontWeights
    watcher: SparseWeights
    gate: float
    stride: int


class CascadeState(NamedTuple):
    """Memory of one running cascade; `advance` writes in place.

    Attributes:
        front: One tile of exact windows, and room for the inputs.
        watcher: The approximate window.
        ring: Input's part of each row at the last samples, `(time, row)`.
        counters: Usable samples in a row; number of the sample at which the tile's
            first window starts; number of the next sample that the tile takes; `(3,)`.
    """

    front: WavefrontState
    watcher: SparseState
    ring: NDArray[np.float32]
    counters: NDArray[np.int64]


def cascade_weights(
    weights: NetworkWeights, gate: float = GATE, stride: int = STRIDE
) -> CascadeWeights:
    """Pack a network.

    Args:
        weights: Of the network.
        gate: Watcher's probability from which exact windows are opened; with 0 they
            always are [-].
        stride: Samples from one start of the watcher to the next [-].

    Raises:
        ValueError: If the gate is above 0.5, where triggers would be the watcher's, or
            the stride is too small for the watcher.
    """
    if not 0.0 <= gate <= 0.5:
        raise ValueError(f"gate is {gate}; give a probability from 0 to 0.5")
    if stride < STRIDE:
        raise ValueError(f"stride is {stride} samples; give {STRIDE} or more")
    return CascadeWeights(
        exact=wavefront.wavefront_weights(weights),
        watcher=sparse.sparse_weights(weights),
        gate=float(gate),
        stride=stride,
    )


def initial_state(
    weights: CascadeWeights, absent: tuple[str, ...] = ()
) -> CascadeState:
    """Memory before the first sample; one per driver, never shared by threads.

    Args:
        weights: Of the network that will run.
        absent: Signals that this drive does not have.

    Raises:
        ValueError: If the network was not trained to do without one of them.
    """
    state = CascadeState(
        front=wavefront.initial_state(weights.exact, absent, num_lanes=TILE),
        watcher=sparse.initial_state(weights.watcher),
        ring=np.zeros((WINDOW_LENGTH, weights.exact.bias.size), np.float32),
        counters=np.zeros(3, np.int64),
    )
    reset(state)
    return state


@compiled
def reset(state: CascadeState) -> None:
    """Forget all samples."""
    state.counters[:] = 0
    state.counters[_FIRST] = -WINDOW_LENGTH


@compiled
def _catch_up(weights: CascadeWeights, state: CascadeState, newest: int) -> None:
    """Let the tile of windows take all samples up to the newest."""
    front, first = state.front, state.counters[_FIRST]
    for number in range(state.counters[_NEXT], newest + 1):
        lane = number - first
        if lane < TILE:
            front.hidden[0, :, lane] = 0.0
        front.projection[:] = state.ring[number % WINDOW_LENGTH]
        advance_states(weights.exact, front)
    state.counters[_NEXT] = newest + 1


@compiled
def _exact(weights: CascadeWeights, state: CascadeState, newest: int) -> float:
    """Verdict of the exact window that ends at the newest sample."""
    start = newest + 1 - WINDOW_LENGTH
    if start >= state.counters[_FIRST] + TILE:
        state.counters[_FIRST] = start
        state.counters[_NEXT] = start
    _catch_up(weights, state, newest)
    return verdict(weights.exact, state.front, start - state.counters[_FIRST])


@compiled
def _advance_taken(weights: CascadeWeights, state: CascadeState) -> float:
    """Verdict after the sample among the inputs; NaN of the watcher stays NaN."""
    newest = state.counters[_NUM_SEEN]
    projection = state.ring[newest % WINDOW_LENGTH]
    project(weights.exact, state.front)
    projection[:] = state.front.projection
    watched = advance_few(
        weights.watcher, state.watcher, projection, newest, weights.stride
    )
    state.counters[_NUM_SEEN] += 1
    if watched >= weights.gate:
        return _exact(weights, state, newest)
    return watched


@entry
def advance(
    weights: CascadeWeights, state: CascadeState, sample: IntentionSample
) -> float:
    """Take one 60 Hz sample; return the crossing probability.

    Args:
        weights: Packed by `cascade_weights`.
        state: Of this driver, changed in place.
        sample: Facing right (`features.facing`).

    Returns:
        In [0, 1]; NaN as `wavefront.advance` gives it.
    """
    if not take(weights.exact, state.front, sample):
        reset(state)
        return math.nan
    return _advance_taken(weights, state)


@entry
def _advance_over(
    weights: CascadeWeights,
    state: CascadeState,
    features: NDArray[np.float64],
    probabilities: NDArray[np.float64],
) -> None:
    for step in range(features.shape[0]):
        row = features[step]
        sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
        if take(weights.exact, state.front, sample):
            probabilities[step] = _advance_taken(weights, state)
        else:
            reset(state)
            probabilities[step] = math.nan


def crossing_probabilities(
    weights: CascadeWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Verdict at every sample of one recording.

    Args:
        weights: Packed by `cascade_weights`.
        features: In the signals' units, facing right, NaN where missing, shape
            `(time, feature)`.
        absent: Signals that the recording does not have.

    Returns:
        As `advance` gives them, shape `(time,)`.

    Raises:
        ValueError: If the last axis does not hold the six signals, or the network
            cannot do without an absent one.
    """
    if features.ndim != 2 or features.shape[1] != NUM_FEATURES:
        raise ValueError(
            f"features have the shape {features.shape}; they need "
            f"(time, {NUM_FEATURES}), the signals of Eq. (1) last"
        )
    probabilities = np.empty(features.shape[0])
    series = np.ascontiguousarray(features, np.float64)
    _advance_over(weights, initial_state(weights, absent), series, probabilities)
    return probabilities
