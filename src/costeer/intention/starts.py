"""Four starts of the network, and exact windows replayed from a ring.

The four that watch begin 60 samples apart, so that the states of three of them have
seen 60 to 239 samples. What each sample adds to the rows of the network is kept for 180
samples; from that ring the exact window is replayed, four windows that end one after
another at a time (bracket.py says when). It is that of wavefront.py to the last bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import compiled, inlined
from costeer.intention.features import NUM_INPUTS, WINDOW_LENGTH
from costeer.intention.four_starts import NUM_STARTS, ROOM, WIDTH, advance_block
from costeer.intention.gru import GATES, NetworkWeights, without
from costeer.intention.taking import absent_flags, scaling_of
from costeer.intention.wavefront import aligned

STRIDE = 60
"""Samples from one start to the next: the least for which four states are enough."""

_WATCHING, _REPLAYING = 0, 1
_OUTPUT = 1

NUM_SEEN = 0
FIRST_END = 1
NEXT = 2
CONFIRMED = 3
"""Places among the counters."""

_NEVER = -WINDOW_LENGTH


class Band(NamedTuple):
    """Where the states' verdicts are not believed.

    Attributes:
        low: All states below this probability mean no [-].
        high: All states above this probability mean yes [-].
    """

    low: float
    high: float


OPEN = Band(low=0.0, high=1.0)
"""Every verdict is exact."""


class BracketWeights(NamedTuple):
    """The network's weights in the order in which the kernel reads them.

    Rows of reset and update are halved as in `wavefront.WavefrontWeights`, units padded
    to whole vector registers. Few arrays, because compiled code counts references.

    Attributes:
        scaling: Of the signals, see `taking.scaling_of`, `(3, 7)`.
        from_inputs: What each input adds to a row, and the bias last,
            `(input + 1, gate, unit)`.
        recurrent: `(block, hidden, gate, width)`.
        units: Bias inside the reset gate, and weights to the logit, `(2, unit)`.
        output_bias: Of the logit.
        low: Logit below which states mean no.
        high: Logit above which they mean yes.
    """

    scaling: NDArray[np.float64]
    from_inputs: NDArray[np.float32]
    recurrent: NDArray[np.float32]
    units: NDArray[np.float32]
    output_bias: np.float32
    low: float
    high: float


class BracketState(NamedTuple):
    """Memory of one running network; `advance` writes in place.

    Attributes:
        hidden: States that watch, states that replay, and room for new ones,
            `(3, start, unit)`.
        ring: What the inputs add to each row at the last samples, `(time, gate, unit)`.
        inputs: Room for the network's inputs, `(input,)`.
        absent: Signals that this drive does not have, `(feature,)`.
        counters: Usable samples in a row; number of the sample at which the first
            replayed window ends; number of the next sample that the replay takes; exact
            verdicts of yes in a row; `(4,)`.
    """

    hidden: NDArray[np.float32]
    ring: NDArray[np.float32]
    inputs: NDArray[np.float32]
    absent: NDArray[np.bool_]
    counters: NDArray[np.int64]


def logit(probability: float) -> float:
    """Logarithm of the odds; infinite at 0 and 1."""
    if probability <= 0.0:
        return -math.inf
    return math.inf if probability >= 1.0 else math.log(probability / (1 - probability))


def bracket_weights(weights: NetworkWeights, band: Band = OPEN) -> BracketWeights:
    """Pack a network.

    Args:
        weights: Of the network.
        band: Where its states are not believed.

    Raises:
        ValueError: If the band does not hold 0.5.
    """
    if not band.low < 0.5 < band.high:
        raise ValueError(f"the band {band.low:g} to {band.high:g} does not hold 0.5")
    size = weights.output_weights.size
    extra = (0, -size % WIDTH)
    halves = np.array([0.5, 0.5, 1.0], np.float32)[:, None]
    outside = np.array([1.0, 1.0, 0.0], np.float32)[:, None]
    bias = (weights.input_bias + outside * weights.hidden_bias) * halves
    inputs = (weights.input_weights * halves[..., None]).transpose(2, 0, 1)
    rows = np.pad(weights.hidden_weights * halves[..., None], ((0, 0), extra, (0, 0)))
    blocks = rows.reshape(len(GATES), -1, WIDTH, size).transpose(1, 3, 0, 2)
    units = np.stack([weights.hidden_bias[2], weights.output_weights])
    given = np.pad(np.concatenate([inputs, bias[None]]), ((0, 0), (0, 0), extra))
    return BracketWeights(
        scaling=scaling_of(weights),
        from_inputs=aligned(given.astype(np.float32)),
        recurrent=aligned(np.ascontiguousarray(blocks, np.float32)),
        units=aligned(np.pad(units, ((0, 0), extra)).astype(np.float32)),
        output_bias=np.float32(weights.output_bias[0]),
        low=logit(band.low),
        high=logit(band.high),
    )


def initial_state(
    weights: BracketWeights, absent: tuple[str, ...] = ()
) -> BracketState:
    """Memory before the first sample; one per driver, never shared by threads.

    Args:
        weights: Of the network that will run.
        absent: Signals that this drive does not have.

    Raises:
        ValueError: If the network was not trained to do without one of them.
    """
    without(weights.scaling[2] > 0.5, absent)
    size = weights.units.shape[1]
    state = BracketState(
        hidden=aligned(np.zeros((ROOM + 1, NUM_STARTS, size), np.float32)),
        ring=aligned(np.zeros((WINDOW_LENGTH, len(GATES), size), np.float32)),
        inputs=np.zeros(NUM_INPUTS, np.float32),
        absent=absent_flags(absent),
        counters=np.zeros(4, np.int64),
    )
    reset(state)
    return state


@compiled
def reset(state: BracketState) -> None:
    """Forget all samples."""
    state.counters[:] = 0
    state.counters[FIRST_END] = _NEVER


@inlined
def _project(weights: BracketWeights, state: BracketState, slot: int) -> None:
    """What the inputs add to every row, in the order of `wavefront.project`."""
    given, ring, inputs = weights.from_inputs, state.ring, state.inputs
    for gate in range(ring.shape[1]):
        for unit in range(ring.shape[2]):
            total = given[NUM_INPUTS, gate, unit]
            for index in range(NUM_INPUTS):
                total += given[index, gate, unit] * inputs[index]
            ring[slot, gate, unit] = total


@inlined
def _step(weights: BracketWeights, state: BracketState, slot: int, which: int) -> None:
    """One GRU step of a set of four states, by the sample in a slot of the ring."""
    hidden = state.hidden
    for block in range(weights.recurrent.shape[0]):
        places = (slot, which, block)
        advance_block(weights.recurrent, weights.units, state.ring, hidden, places)
    for start in range(NUM_STARTS):
        for unit in range(hidden.shape[2]):
            hidden[which, start, unit] = hidden[ROOM, start, unit]


@inlined
def _open(state: BracketState, which: int, start: int) -> None:
    """Let a state begin anew."""
    for unit in range(state.hidden.shape[2]):
        state.hidden[which, start, unit] = 0.0


@inlined
def _logit(weights: BracketWeights, state: BracketState, which: int, at: int) -> float:
    """Logit of one state."""
    total = float(weights.output_bias)
    for unit in range(state.hidden.shape[2]):
        total += weights.units[_OUTPUT, unit] * state.hidden[which, at, unit]
    return total


@compiled
def exact_logit(weights: BracketWeights, state: BracketState, newest: int) -> float:
    """Logit of the exact window that ends at the newest sample."""
    counters = state.counters
    if newest >= counters[FIRST_END] + NUM_STARTS:
        counters[FIRST_END] = newest
        counters[NEXT] = newest + 1 - WINDOW_LENGTH
    start = counters[FIRST_END] + 1 - WINDOW_LENGTH
    for number in range(counters[NEXT], newest + 1):
        if number - start < NUM_STARTS:
            _open(state, _REPLAYING, number - start)
        _step(weights, state, number % WINDOW_LENGTH, _REPLAYING)
    counters[NEXT] = newest + 1
    return _logit(weights, state, _REPLAYING, newest - counters[FIRST_END])


@inlined
def watch(weights: BracketWeights, state: BracketState, number: int) -> None:
    """Let the four states take the sample that was taken."""
    slot = number % WINDOW_LENGTH
    _project(weights, state, slot)
    if number % STRIDE == 0:
        _open(state, _WATCHING, number // STRIDE % NUM_STARTS)
    _step(weights, state, slot, _WATCHING)
    state.counters[NUM_SEEN] = number + 1


@inlined
def three(
    weights: BracketWeights, state: BracketState, number: int
) -> tuple[float, float, float]:
    """Logits of the three older states, oldest first."""
    first = (number + 1 - WINDOW_LENGTH) // STRIDE
    return (
        _logit(weights, state, _WATCHING, first % NUM_STARTS),
        _logit(weights, state, _WATCHING, (first + 1) % NUM_STARTS),
        _logit(weights, state, _WATCHING, (first + 2) % NUM_STARTS),
    )
