"""The cheapest form of the network: one state, carried on from sample to sample.

It is another model than Eq. (2): the window forgets what is older than 180 samples, a
carried state does not. It serves as the watcher of cascade.py. A vector register holds
neighbouring hidden units here, where kernel.py's holds window starts; each unit goes
through the same operations in the same order, so that both give the same bits while
both have seen the same samples.
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
from costeer.intention.gru import GATES, NetworkWeights
from costeer.intention.lanes import (
    Floats,
    Lanes,
    fused,
    host_layout,
    logistic_pair,
    tanh,
)

_WIDTH = host_layout().width
_NUM_GATES = len(GATES)
_INDEX = ir.IntType(64)


class CarriedWeights(NamedTuple):
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


class CarriedState(NamedTuple):
    """Memory of one carried state, changed in place.

    Attributes:
        hidden: `(unit,)`.
        new_hidden: Room for the new one, `(unit,)`.
        projection: Room for the input's part of each row, `(gate, unit)`.
    """

    hidden: NDArray[np.float32]
    new_hidden: NDArray[np.float32]
    projection: NDArray[np.float32]


def carried_weights(weights: NetworkWeights) -> CarriedWeights:
    """Pack a network."""
    size = weights.output_weights.size
    extra = -size % _WIDTH
    halves = np.array([0.5, 0.5, 1.0], np.float32)
    rows = weights.hidden_weights * halves[:, None, None]
    padded = np.pad(rows, [(0, 0), (0, extra), (0, 0)])
    blocks = padded.reshape(_NUM_GATES, -1, _WIDTH, size).transpose(1, 3, 0, 2)
    return CarriedWeights(
        recurrent=np.ascontiguousarray(blocks, np.float32),
        candidate_bias=np.pad(weights.hidden_bias[2], (0, extra)).astype(np.float32),
        output_weights=np.pad(weights.output_weights, (0, extra)).astype(np.float32),
        output_bias=weights.output_bias.astype(np.float32),
    )


def initial_state(weights: CarriedWeights) -> CarriedState:
    """A state that has seen nothing."""
    units = weights.candidate_bias.size
    return CarriedState(
        hidden=np.zeros(units, np.float32),
        new_hidden=np.zeros(units, np.float32),
        projection=np.zeros((_NUM_GATES, units), np.float32),
    )


@compiled
def carry_on(
    weights: CarriedWeights, state: CarriedState, projection: NDArray[np.float32]
) -> float:
    """Take one sample; return the crossing probability.

    Args:
        weights: Packed by `carried_weights`.
        state: Changed in place.
        projection: Input's part of each row as `wavefront.project` makes it, `(row,)`.
    """
    for row in range(projection.shape[0]):
        state.projection[row % _NUM_GATES, row // _NUM_GATES] = projection[row]
    for block in range(weights.recurrent.shape[0]):
        advance_block(
            weights.recurrent,
            weights.candidate_bias,
            state.projection,
            state.hidden,
            state.new_hidden,
            block,
        )
    state.hidden[:] = state.new_hidden
    logit = float(weights.output_bias[0])
    for unit in range(weights.output_weights.shape[0]):
        logit += weights.output_weights[unit] * state.hidden[unit]
    return 1.0 / (1.0 + math.exp(-logit))


def _advance_block(
    typingctx: Any,
    recurrent: Any,
    candidate_bias: Any,
    projection: Any,
    state: Any,
    new_state: Any,
    block: Any,
) -> Any:
    """Advance the hidden units of one vector register.

    Args:
        typingctx: Numba's typing context; the caller does not give it.
        recurrent: Packed recurrent matrix, `(block, hidden, gate, width)`, contiguous.
        candidate_bias: Bias inside the reset gate, `(unit,)`.
        projection: Input's part of all rows, `(gate, unit)`, contiguous.
        state: Old hidden state, `(unit,)`.
        new_state: Where the new one goes, `(unit,)`.
        block: Which register.
    """
    signature = types.void(
        recurrent, candidate_bias, projection, state, new_state, block
    )

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args[:5], arguments[:5], strict=True)
        ]
        hidden = builder.extract_value(arrays[0].shape, 1)
        units = builder.extract_value(arrays[3].shape, 0)
        floats = [Floats(builder, array.data) for array in arrays]
        index = context.cast(builder, arguments[5], signature.args[5], types.int64)
        sums = _row_sums(builder, floats[0], floats[3], index, hidden)
        _close_gates(builder, floats, sums, builder.mul(index, _INDEX(_WIDTH)), units)
        return context.get_dummy_value()

    return signature, generate


advance_block: Any = intrinsic(_advance_block)  # Any: called without typing context


def _row_sums(
    builder: ir.IRBuilder, recurrent: Floats, state: Floats, block: Any, hidden: Any
) -> list[Lanes]:
    """U h of the three gates of one register of units."""
    zero = ir.Constant(ir.VectorType(ir.FloatType(), _WIDTH), [0.0] * _WIDTH)
    variable: Any = cgutils.alloca_once_value  # Any: Numba does not type it
    sums = [variable(builder, zero) for _ in range(_NUM_GATES)]
    first = builder.mul(block, hidden)
    with cgutils.for_range(builder, hidden) as loop:
        part = state.scalar(loop.index, _WIDTH)
        row = builder.mul(builder.add(first, loop.index), _INDEX(_NUM_GATES * _WIDTH))
        for gate, total in enumerate(sums):
            weight = recurrent.vector(builder.add(row, _INDEX(gate * _WIDTH)), _WIDTH)
            old = Lanes(builder, builder.load(total))
            builder.store(fused(weight, part, old).value, total)
    return [Lanes(builder, builder.load(total)) for total in sums]


def _close_gates(
    builder: ir.IRBuilder, floats: list[Floats], sums: list[Lanes], at: Any, units: Any
) -> None:
    """New states of the units from `at` on, operation by operation as kernel.py."""
    _, candidate_bias, projection, state, new_state = floats
    reset_input, update_input, candidate_input = (
        projection.vector(builder.add(at, builder.mul(units, _INDEX(gate))), _WIDTH)
        for gate in range(_NUM_GATES)
    )
    bias = candidate_bias.vector(at, _WIDTH)
    old = state.vector(at, _WIDTH)
    reset, update = logistic_pair(sums[0] + reset_input, sums[1] + update_input)
    candidate = tanh(fused(reset, sums[2] + bias, candidate_input))
    new_state.store(at, fused(update, old - candidate, candidate))
