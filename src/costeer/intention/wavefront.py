"""The exact window at every tick: 180 hidden states advanced together.

The window of Eq. (1) ends at every sample anew, and the network starts each from zero:
180 GRU steps a tick if done afresh. But all windows that are open now take the same
newest sample as their next input. So one hidden state per window start is kept, all
are advanced by each sample in one matrix product, and the one that has seen 180
samples gives the verdict: the same numbers, since no state ever depends on another.

States lie hidden-major, `(tile, hidden, lane)`, one lane per window start, so that a
vector register holds neighbouring starts (kernel.py). Arithmetic is float32.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import compiled
from costeer.base.entry import entry
from costeer.intention.features import (
    NUM_FEATURES,
    NUM_INPUTS,
    WINDOW_LENGTH,
    IntentionSample,
)
from costeer.intention.gru import NetworkWeights, without
from costeer.intention.kernel import ROWS, TILE, advance_pair
from costeer.intention.taking import absent_flags, scaling_of, take

_CACHE_LINE = 64


class WavefrontWeights(NamedTuple):
    """The network's weights in the order in which the kernel reads them.

    A row is (unit, gate) with the gates reset, update, candidate; six rows, two units,
    make a pair. The rows of reset and update are halved: sigmoid(a) is
    (1 + tanh(a/2))/2, and halving is exact.

    Attributes:
        scaling: Of the signals, see `taking.scaling_of`, `(3, 7)`.
        input_weights: `(input, row)`.
        bias: Of input and, except for the candidate, of the state, `(row,)`.
        recurrent: `(pair, hidden, 6)`.
        candidate_bias: Inside the reset gate, `(hidden,)`.
        output_weights: `(hidden,)`.
        output_bias: `(1,)`.
    """

    scaling: NDArray[np.float64]
    input_weights: NDArray[np.float32]
    bias: NDArray[np.float32]
    recurrent: NDArray[np.float32]
    candidate_bias: NDArray[np.float32]
    output_weights: NDArray[np.float32]
    output_bias: NDArray[np.float32]


class WavefrontState(NamedTuple):
    """Memory of one running network; `advance` writes in place.

    Attributes:
        hidden: One hidden state per window start, `(tile, hidden, lane)`.
        new_hidden: Room for one tile's new states, `(hidden, lane)`.
        projection: Room for the input's part of each row, `(row,)`.
        inputs: Room for the network's inputs, `(input,)`.
        absent: Signals that this drive does not have, `(feature,)`.
        counters: Lane of the next window start, valid samples in a row, `(2,)`.
    """

    hidden: NDArray[np.float32]
    new_hidden: NDArray[np.float32]
    projection: NDArray[np.float32]
    inputs: NDArray[np.float32]
    absent: NDArray[np.bool_]
    counters: NDArray[np.int64]


def aligned(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """A copy that starts at a cache line, so that no vector straddles two."""
    raw = np.zeros(values.nbytes + _CACHE_LINE, np.uint8)
    start = -raw.ctypes.data % _CACHE_LINE
    flat = raw[start : start + values.nbytes].view(np.float32)
    flat[:] = values.ravel()
    return flat.reshape(values.shape)


def _padded(values: NDArray[np.float32], *axes: int) -> NDArray[np.float32]:
    """One more unit of zeros along `axes` if their length is odd: it stays at rest."""
    extra = [(0, values.shape[a] % 2 if a in axes else 0) for a in range(values.ndim)]
    return np.pad(values, extra)


def wavefront_weights(weights: NetworkWeights) -> WavefrontWeights:
    """Pack a network for the kernel."""
    halves = np.array([0.5, 0.5, 1.0], np.float32)
    inputs = _padded(weights.input_weights, 1) * halves[:, None, None]
    recurrent = _padded(weights.hidden_weights, 1, 2) * halves[:, None, None]
    hidden_bias = _padded(weights.hidden_bias, 1)
    outside = np.array([1.0, 1.0, 0.0], np.float32)[:, None]
    bias = (_padded(weights.input_bias, 1) + outside * hidden_bias) * halves[:, None]
    size = hidden_bias.shape[1]
    by_pair = recurrent.transpose(1, 0, 2).reshape(size // 2, ROWS, size)
    return WavefrontWeights(
        scaling=scaling_of(weights),
        input_weights=aligned(inputs.transpose(2, 1, 0).reshape(NUM_INPUTS, -1)),
        bias=aligned(bias.T.ravel()),
        recurrent=aligned(by_pair.transpose(0, 2, 1)),
        candidate_bias=aligned(hidden_bias[2]),
        output_weights=aligned(_padded(weights.output_weights, 0)),
        output_bias=weights.output_bias.astype(np.float32),
    )


def initial_state(
    weights: WavefrontWeights,
    absent: tuple[str, ...] = (),
) -> WavefrontState:
    """Memory before the first sample; one per driver, never shared by threads.

    Args:
        weights: Of the network that will run.
        absent: Signals that this drive does not have; what is given for them is not
            looked at.

    Raises:
        ValueError: If the network was not trained to do without one of them.
    """
    hidden = weights.candidate_bias.shape[0]
    num_tiles = -(-WINDOW_LENGTH // TILE)
    without(weights.scaling[2] > 0.5, absent)
    return WavefrontState(
        hidden=aligned(np.zeros((num_tiles, hidden, TILE), np.float32)),
        new_hidden=aligned(np.zeros((hidden, TILE), np.float32)),
        projection=aligned(np.zeros(3 * hidden, np.float32)),
        inputs=np.zeros(NUM_INPUTS, np.float32),
        absent=absent_flags(absent),
        counters=np.zeros(2, np.int64),
    )


@compiled
def reset(state: WavefrontState) -> None:
    """Forget all samples."""
    state.counters[:] = 0


@compiled
def project(weights: WavefrontWeights, state: WavefrontState) -> None:
    """The input's part of every row: once per sample, the same for all starts.

    All inputs of a row at once: a loop over rows inside one over inputs is slower.
    """
    for row in range(state.projection.shape[0]):
        total = weights.bias[row]
        for index in range(NUM_INPUTS):
            total += weights.input_weights[index, row] * state.inputs[index]
        state.projection[row] = total


@compiled
def advance_states(weights: WavefrontWeights, state: WavefrontState) -> None:
    """One GRU step of all window starts."""
    for tile in range(state.hidden.shape[0]):
        hidden = state.hidden[tile]
        for pair in range(weights.recurrent.shape[0]):
            advance_pair(
                weights.recurrent,
                weights.candidate_bias,
                state.projection,
                hidden,
                state.new_hidden,
                pair,
            )
        # Not `hidden[:, :] = ...`: its check of shapes takes seconds to compile.
        for unit in range(hidden.shape[0]):
            for column in range(hidden.shape[1]):
                hidden[unit, column] = state.new_hidden[unit, column]


@compiled
def verdict(weights: WavefrontWeights, state: WavefrontState, lane: int) -> float:
    """Sigmoid of the hidden state in one lane."""
    tile, column = lane // TILE, lane % TILE
    logit = float(weights.output_bias[0])
    for unit in range(weights.output_weights.shape[0]):
        logit += weights.output_weights[unit] * state.hidden[tile, unit, column]
    return 1.0 / (1.0 + math.exp(-logit))


@compiled
def _advance_scaled(weights: WavefrontWeights, state: WavefrontState) -> float:
    """Open a window at the sample in `state.inputs`, advance all, close the oldest."""
    lane = state.counters[0]
    for unit in range(state.hidden.shape[1]):
        state.hidden[lane // TILE, unit, lane % TILE] = 0.0
    project(weights, state)
    advance_states(weights, state)
    oldest = (lane + 1) % WINDOW_LENGTH
    state.counters[0] = oldest
    state.counters[1] += 1
    if state.counters[1] < WINDOW_LENGTH:
        return math.nan
    return verdict(weights, state, oldest)


@entry
def advance(
    weights: WavefrontWeights, state: WavefrontState, sample: IntentionSample
) -> float:
    """Take one 60 Hz sample; return the crossing probability of the window it ends.

    Callable from Python and from compiled code; it releases the interpreter's lock.

    Args:
        weights: Packed by `wavefront_weights`.
        state: Of this driver, changed in place.
        sample: Facing right (`features.facing`).

    Returns:
        In [0, 1]; NaN until the window holds 180 usable samples in a row: finite, but
        for signals that are absent and a head that is lost, if the network was trained
        for it.
    """
    if not take(weights.scaling, state.absent, state.inputs, sample):
        state.counters[1] = 0
        return math.nan
    return _advance_scaled(weights, state)


@entry
def _advance_over(
    weights: WavefrontWeights,
    state: WavefrontState,
    features: NDArray[np.float64],
    probabilities: NDArray[np.float64],
) -> None:
    for step in range(features.shape[0]):
        row = features[step]
        sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
        if take(weights.scaling, state.absent, state.inputs, sample):
            probabilities[step] = _advance_scaled(weights, state)
        else:
            state.counters[1] = 0
            probabilities[step] = math.nan


def crossing_probabilities(
    weights: NetworkWeights,
    features: NDArray[np.float64],
    absent: tuple[str, ...] = (),
) -> NDArray[np.float64]:
    """Verdict at every sample of one recording.

    Args:
        weights: The network.
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
    packed = wavefront_weights(weights)
    probabilities = np.empty(features.shape[0])
    series = np.ascontiguousarray(features, np.float64)
    _advance_over(packed, initial_state(packed, absent), series, probabilities)
    return probabilities
