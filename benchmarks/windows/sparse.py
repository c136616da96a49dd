"""An approximate window: started only every 60th sample, so of 180 to 239 samples.

Four states are enough for that, where the exact window needs 180 (wavefront.py). The
verdict is that of the youngest window that has seen at least 180 samples. With a stride
that never ends it is a carried state, begun at the first sample and never again.

A vector register holds neighbouring hidden units here, where that of kernel.py holds
window starts. Each unit goes through the same operations in the same order, so both
give the same bits for the same window.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from costeer.base.array import compiled
from costeer.intention.features import WINDOW_LENGTH
from costeer.intention.gru import GATES, NetworkWeights
from costeer.intention.lanes import (
    Floats,
    Lanes,
    fused,
    host_layout,
    logistic_pair,
    tanh,
)

NUM_STATES = 4
"""Window starts that are advanced together."""

STRIDE = 60
"""Samples from one start to the next: the least for which four states are enough."""

NEVER = 2**62
"""Stride of a carried state."""

_WIDTH = host_layout().width
_NUM_GATES = len(GATES)
_INDEX = ir.IntType(64)


class SparseWeights(NamedTuple):
    """The recurrent part of the network, units padded to whole vector registers.

    Rows of reset and update are halved as in `wavefront.WavefrontWeights`.

    Attributes:
        recurrent: `(block, hidden, gate, width)`.
        candidate_bias: Inside the reset gate, `(unit,)`.
        output_weights: `(unit,)`.
        output_bias: `(1,)`.
    """

    recurrent: NDArray[np.float32]
    candidate_bias: NDArray[np.float32]
    output_weights: NDArray[np.float32]
    output_bias: NDArray[np.float32]


class SparseState(NamedTuple):
    """Memory, changed in place.

    Attributes:
        hidden: `(start, unit)`.
        new_hidden: Room for the new ones, `(start, unit)`.
        projection: Room for the input's part of each row, `(gate, unit)`.
    """

    hidden: NDArray[np.float32]
    new_hidden: NDArray[np.float32]
    projection: NDArray[np.float32]


def sparse_weights(weights: NetworkWeights) -> SparseWeights:
    """Pack a network."""
    size = weights.output_weights.size
    extra = -size % _WIDTH
    halves = np.array([0.5, 0.5, 1.0], np.float32)
    rows = weights.hidden_weights * halves[:, None, None]
    padded = np.pad(rows, [(0, 0), (0, extra), (0, 0)])
    blocks = padded.reshape(_NUM_GATES, -1, _WIDTH, size).transpose(1, 3, 0, 2)
    return SparseWeights(
        recurrent=np.ascontiguousarray(blocks, np.float32),
        candidate_bias=np.pad(weights.hidden_bias[2], (0, extra)).astype(np.float32),
        output_weights=np.pad(weights.output_weights, (0, extra)).astype(np.float32),
        output_bias=weights.output_bias.astype(np.float32),
    )


def initial_state(weights: SparseWeights) -> SparseState:
    """Memory before the first sample."""
    units = weights.candidate_bias.size
    return SparseState(
        hidden=np.zeros((NUM_STATES, units), np.float32),
        new_hidden=np.zeros((NUM_STATES, units), np.float32),
        projection=np.zeros((_NUM_GATES, units), np.float32),
    )


@compiled
def advance_few(
    weights: SparseWeights,
    state: SparseState,
    projection: NDArray[np.float32],
    number: int,
    stride: int,
) -> float:
    """Take one usable sample; return the crossing probability, NaN before 180 samples.

    Args:
        weights: Packed by `sparse_weights`.
        state: Changed in place.
        projection: Input's part of each row as `wavefront.project` makes it, `(row,)`.
        number: Usable samples in a row before this one.
        stride: Samples from one start to the next, at least `STRIDE`.
    """
    if number % stride == 0:
        state.hidden[(number // stride) % NUM_STATES] = 0.0
    for row in range(projection.shape[0]):
        state.projection[row % _NUM_GATES, row // _NUM_GATES] = projection[row]
    _advance_blocks(weights, state)
    if number + 1 < WINDOW_LENGTH:
        return math.nan
    youngest = ((number + 1 - WINDOW_LENGTH) // stride) % NUM_STATES
    logit = float(weights.output_bias[0])
    for unit in range(weights.output_weights.shape[0]):
        logit += weights.output_weights[unit] * state.hidden[youngest, unit]
    return 1.0 / (1.0 + math.exp(-logit))


@compiled
def _advance_blocks(weights: SparseWeights, state: SparseState) -> None:
    """One GRU step of all starts."""
    for block in range(weights.recurrent.shape[0]):
        advance_block(
            weights.recurrent,
            weights.candidate_bias,
            state.projection,
            state.hidden,
            state.new_hidden,
            block,
        )
    state.hidden[:, :] = state.new_hidden


def _advance_block(
    typingctx: Any,
    recurrent: Any,
    candidate_bias: Any,
    projection: Any,
    states: Any,
    new_states: Any,
    block: Any,
) -> Any:
    """Advance the hidden units of one vector register, for all starts.

    Args:
        typingctx: Numba's typing context; the caller does not give it.
        recurrent: Packed recurrent matrix, `(block, hidden, gate, width)`, contiguous.
        candidate_bias: Bias inside the reset gate, `(unit,)`.
        projection: Input's part of all rows, `(gate, unit)`, contiguous.
        states: Old hidden states, `(start, unit)`, contiguous.
        new_states: Where the new ones go, same shape.
        block: Which register.
    """
    signature = types.void(
        recurrent, candidate_bias, projection, states, new_states, block
    )

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args[:5], arguments[:5], strict=True)
        ]
        hidden = builder.extract_value(arrays[0].shape, 1)
        units = builder.extract_value(arrays[3].shape, 1)
        floats = [Floats(builder, array.data) for array in arrays]
        index = context.cast(builder, arguments[5], signature.args[5], types.int64)
        first = builder.mul(index, hidden)
        sums = _row_sums(builder, floats[0], floats[3], first, (hidden, units))
        place = builder.mul(index, _INDEX(_WIDTH))
        for start, rows in enumerate(sums):
            _close_gates(builder, floats, rows, (place, units), start)
        return context.get_dummy_value()

    return signature, generate


advance_block: Any = intrinsic(_advance_block)  # Any: called without typing context


def _row_sums(
    builder: ir.IRBuilder,
    recurrent: Floats,
    states: Floats,
    first: ir.Value,
    sizes: tuple[ir.Value, ir.Value],
) -> list[list[Lanes]]:
    """U h of the three gates of one register of units, for each start."""
    hidden, units = sizes
    zero = ir.Constant(ir.VectorType(ir.FloatType(), _WIDTH), [0.0] * _WIDTH)
    variable: Any = cgutils.alloca_once_value  # Any: Numba does not type it
    sums = [
        [variable(builder, zero) for _ in range(_NUM_GATES)] for _ in range(NUM_STATES)
    ]
    with cgutils.for_range(builder, hidden) as loop:
        row = builder.mul(builder.add(first, loop.index), _INDEX(_NUM_GATES * _WIDTH))
        weights = [
            recurrent.vector(builder.add(row, _INDEX(gate * _WIDTH)), _WIDTH)
            for gate in range(_NUM_GATES)
        ]
        for start, totals in enumerate(sums):
            place = builder.add(builder.mul(units, _INDEX(start)), loop.index)
            part = states.scalar(place, _WIDTH)
            for total, weight in zip(totals, weights, strict=True):
                old = Lanes(builder, builder.load(total))
                builder.store(fused(weight, part, old).value, total)
    return [[Lanes(builder, builder.load(t)) for t in totals] for totals in sums]


def _close_gates(
    builder: ir.IRBuilder,
    floats: list[Floats],
    sums: list[Lanes],
    places: tuple[ir.Value, ir.Value],
    start: int,
) -> None:
    """New states of one register of units, operation by operation as kernel.py."""
    _, candidate_bias, projection, states, new_states = floats
    unit, units = places
    reset_input, update_input, candidate_input = (
        projection.vector(builder.add(unit, builder.mul(units, _INDEX(gate))), _WIDTH)
        for gate in range(_NUM_GATES)
    )
    bias = candidate_bias.vector(unit, _WIDTH)
    place = builder.add(unit, builder.mul(units, _INDEX(start)))
    old = states.vector(place, _WIDTH)
    reset, update = logistic_pair(sums[0] + reset_input, sums[1] + update_input)
    candidate = tanh(fused(reset, sums[2] + bias, candidate_input))
    new_states.store(place, fused(update, old - candidate, candidate))
