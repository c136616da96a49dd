"""One GRU step of many window starts: the inner kernel of the wavefront.

Two hidden units at a time: their six rows of U h (reset, update, candidate; twice)
for a few vectors of window starts are summed in registers while one loop runs over
the old hidden units, then the gates are closed and the new states stored. Eq. (2);
gru.py says the same in NumPy.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from costeer.intention.lanes import (
    Floats,
    Lanes,
    fused,
    host_layout,
    logistic_pair,
    tanh,
)

LAYOUT = host_layout()
TILE = LAYOUT.width * LAYOUT.vectors
"""Window starts that one call of `advance_pair` advances."""

ROWS = 6
"""Rows of the recurrent matrix in a tile: two hidden units, three gates."""

_INDEX = ir.IntType(64)


def _advance_pair(
    typingctx: Any,
    recurrent: Any,
    candidate_bias: Any,
    projection: Any,
    states: Any,
    new_states: Any,
    pair: Any,
) -> Any:
    """Advance hidden units 2·pair and 2·pair + 1 of one tile of window starts.

    Args:
        typingctx: Numba's typing context; the caller does not give it.
        recurrent: Packed recurrent matrix, shape `(pair, hidden, row)`, contiguous.
        candidate_bias: Bias inside the reset gate, shape `(hidden,)`.
        projection: Input's part of all rows, shape `(pair, row)`.
        states: Old hidden states of the tile, shape `(hidden, lane)`, contiguous.
        new_states: Where the new ones go, same shape.
        pair: Which two units.
    """
    signature = types.void(
        recurrent, candidate_bias, projection, states, new_states, pair
    )

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args[:5], arguments[:5], strict=True)
        ]
        hidden = builder.extract_value(arrays[3].shape, 0)
        floats = [Floats(builder, array.data) for array in arrays]
        index = context.cast(builder, arguments[5], signature.args[5], types.int64)
        sums = _row_sums(builder, floats[0], floats[3], index, hidden)
        for unit in range(2):
            _close_gates(builder, floats, sums[3 * unit : 3 * unit + 3], index, unit)
        return context.get_dummy_value()

    return signature, generate


advance_pair: Any = intrinsic(_advance_pair)  # Any: called without typing context


def _row_sums(
    builder: ir.IRBuilder,
    recurrent: Floats,
    states: Floats,
    pair: ir.Value,
    hidden: ir.Value,
) -> list[list[Lanes]]:
    """U h of the six rows, each as `LAYOUT.vectors` vectors."""
    width, vectors = LAYOUT.width, LAYOUT.vectors
    zero = ir.Constant(ir.VectorType(ir.FloatType(), width), [0.0] * width)
    variable: Any = cgutils.alloca_once_value  # Any: Numba does not type it
    sums = [[variable(builder, zero) for _ in range(vectors)] for _ in range(ROWS)]
    first = builder.mul(pair, hidden)
    with cgutils.for_range(builder, hidden) as loop:
        row = builder.mul(builder.add(first, loop.index), _INDEX(ROWS))
        column = builder.mul(loop.index, _INDEX(TILE))
        parts = [
            states.vector(builder.add(column, _INDEX(v * width)), width)
            for v in range(vectors)
        ]
        for r, totals in enumerate(sums):
            weight = recurrent.scalar(builder.add(row, _INDEX(r)), width)
            for total, part in zip(totals, parts, strict=True):
                old = Lanes(builder, builder.load(total))
                builder.store(fused(weight, part, old).value, total)
    return [[Lanes(builder, builder.load(t)) for t in totals] for totals in sums]


def _close_gates(
    builder: ir.IRBuilder,
    floats: list[Floats],
    sums: list[list[Lanes]],
    pair: ir.Value,
    unit: int,
) -> None:
    """New states of one hidden unit from the sums of its three rows."""
    _, candidate_bias, projection, states, new_states = floats
    width = LAYOUT.width
    own = builder.add(builder.mul(pair, _INDEX(2)), _INDEX(unit))
    row = builder.mul(own, _INDEX(3))
    reset_input, update_input, candidate_input = (
        projection.scalar(builder.add(row, _INDEX(gate)), width) for gate in range(3)
    )
    bias = candidate_bias.scalar(own, width)
    column = builder.mul(own, _INDEX(TILE))
    for v in range(LAYOUT.vectors):
        place = builder.add(column, _INDEX(v * width))
        old = states.vector(place, width)
        reset, update = logistic_pair(
            sums[0][v] + reset_input, sums[1][v] + update_input
        )
        candidate = tanh(fused(reset, sums[2][v] + bias, candidate_input))
        new_states.store(place, fused(update, old - candidate, candidate))
