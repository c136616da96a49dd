"""One GRU step of four window starts: the inner kernel of the bracket.

A vector register holds neighbouring hidden units here, where that of kernel.py holds
window starts. Each unit goes through the same operations in the same order, so both
give the same bits for the same window.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from costeer.intention.gru import GATES
from costeer.intention.lanes import (
    Floats,
    Lanes,
    fused,
    host_layout,
    logistic_pair,
    tanh,
)

NUM_STARTS = 4
"""Window starts that are advanced together."""

WIDTH = host_layout().width
"""Hidden units in one vector register, a block."""

ROOM = 2
"""Place of the new states among the sets of states."""

_NUM_GATES = len(GATES)
_INDEX = ir.IntType(64)
_unpacked: Any = cgutils.unpack_tuple  # Any: Numba does not type it


def _advance_block(
    typingctx: Any,
    recurrent: Any,
    unit_weights: Any,
    ring: Any,
    states: Any,
    places: Any,
) -> Any:
    """Advance the hidden units of one vector register, for all four starts.

    Sets and slots are picked here: a view of an array costs the caller a count of
    references. All arrays are contiguous.

    Args:
        typingctx: Numba's typing context; the caller does not give it.
        recurrent: Packed recurrent matrix, `(block, hidden, gate, width)`.
        unit_weights: Bias inside the reset gate first, `(2, unit)`.
        ring: Input's part of all rows at the last samples, `(time, gate, unit)`.
        states: Two sets of hidden states and room for new ones, `(3, start, unit)`.
        places: Of the sample in the ring, of the set of states, and of the register.
    """
    signature = types.void(recurrent, unit_weights, ring, states, places)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args[:4], arguments[:4], strict=True)
        ]
        slot, which, block = (
            context.cast(builder, value, kind, types.int64)
            for value, kind in zip(
                _unpacked(builder, arguments[4]), places.types, strict=True
            )
        )
        hidden = builder.extract_value(arrays[0].shape, 1)
        units = builder.extract_value(arrays[3].shape, 2)
        pack, bias, rows, old = (Floats(builder, array.data) for array in arrays)
        size = builder.mul(units, _INDEX(NUM_STARTS))
        first = builder.mul(which, size)
        sums = _row_sums(
            builder, pack, old, builder.mul(block, hidden), (hidden, units, first)
        )
        unit = builder.mul(block, _INDEX(WIDTH))
        sample = builder.mul(slot, builder.mul(units, _INDEX(_NUM_GATES)))
        given = [
            rows.vector(_place(builder, sample, units, gate, unit), WIDTH)
            for gate in range(_NUM_GATES)
        ]
        room = builder.mul(size, _INDEX(ROOM))
        for start, each in enumerate(sums):
            place = _place(builder, first, units, start, unit)
            new = _new_states(
                each, given, bias.vector(unit, WIDTH), old.vector(place, WIDTH)
            )
            old.store(_place(builder, room, units, start, unit), new)
        return context.get_dummy_value()

    return signature, generate


advance_block: Any = intrinsic(_advance_block)  # Any: called without typing context


def _place(
    builder: ir.IRBuilder, first: ir.Value, units: ir.Value, row: int, unit: ir.Value
) -> ir.Value:
    """Flat index of a unit in a row of `units` numbers, counted from `first`."""
    ahead = builder.add(first, builder.mul(units, _INDEX(row)))
    return builder.add(ahead, unit)


def _row_sums(
    builder: ir.IRBuilder,
    recurrent: Floats,
    states: Floats,
    first: ir.Value,
    sizes: tuple[ir.Value, ir.Value, ir.Value],
) -> list[list[Lanes]]:
    """U h of the three gates of one register of units, for each start."""
    hidden, units, own = sizes
    zero = ir.Constant(ir.VectorType(ir.FloatType(), WIDTH), [0.0] * WIDTH)
    variable: Any = cgutils.alloca_once_value  # Any: Numba does not type it
    sums = [
        [variable(builder, zero) for _ in range(_NUM_GATES)] for _ in range(NUM_STARTS)
    ]
    with cgutils.for_range(builder, hidden) as loop:
        row = builder.mul(builder.add(first, loop.index), _INDEX(_NUM_GATES * WIDTH))
        weights = [
            recurrent.vector(builder.add(row, _INDEX(gate * WIDTH)), WIDTH)
            for gate in range(_NUM_GATES)
        ]
        for start, totals in enumerate(sums):
            place = _place(builder, own, units, start, loop.index)
            part = states.scalar(place, WIDTH)
            for total, weight in zip(totals, weights, strict=True):
                old = Lanes(builder, builder.load(total))
                builder.store(fused(weight, part, old).value, total)
    return [[Lanes(builder, builder.load(t)) for t in totals] for totals in sums]


def _new_states(
    sums: list[Lanes], given: list[Lanes], bias: Lanes, old: Lanes
) -> Lanes:
    """New states of one register of units, operation by operation as kernel.py."""
    reset, update = logistic_pair(sums[0] + given[0], sums[1] + given[1])
    candidate = tanh(fused(reset, sums[2] + bias, given[2]))
    return fused(update, old - candidate, candidate)
