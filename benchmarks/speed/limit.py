"""What one core of this machine can do at most, measured, not looked up.

Arithmetic: fused multiply-adds on float32 vectors that never leave the registers, in
the layout of the network's kernel and in as many independent sums as its tile has.
Nothing that multiplies and adds can be faster. Bandwidth: sums over arrays that stay in
the first or the second cache.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from benchmarks.speed.timing import Effort, Figure, figure, seconds_of
from costeer.base.entry import entry
from costeer.intention.kernel import LAYOUT, ROWS
from costeer.intention.lanes import Floats, Lanes, fused
from costeer.intention.wavefront import aligned

Float32 = NDArray[np.float32]

NUM_SUMS = ROWS * LAYOUT.vectors
"""Vectors that are summed side by side, as in a tile of the kernel."""

GROUP = "limit of one core"
ARITHMETIC = "fused multiply-add"
CACHES = {"first cache, 16 kB": 16 * 1024, "second cache, 192 kB": 192 * 1024}
"""Arrays that are read, by name [byte]."""

_STEPS = 200_000
_READ = 64 * 1024 * 1024
_INDEX = ir.IntType(64)


def _repeated(body: Callable[[Any, Floats, list[Lanes], ir.Value], list[Lanes]]) -> Any:
    """Compiled loop around `body`, which takes and returns the sums.

    It is called as `(values, sums, count)`: `values` are read, the `sums`, shape
    `(sum, width)`, are taken at the start and written at the end.
    """

    def repeat(typingctx: Any, values: Any, sums: Any, count: Any) -> Any:
        return types.void(values, sums, count), lambda *given: _loop(body, *given)

    return intrinsic(repeat)


def _loop(
    body: Any, context: Any, builder: Any, signature: Any, arguments: Any
) -> ir.Value:
    """Sums in registers while the body runs a number of times."""
    values, totals = (
        Floats(builder, context.make_array(kind)(context, builder, value).data)
        for kind, value in zip(signature.args[:2], arguments[:2], strict=True)
    )
    count = context.cast(builder, arguments[2], signature.args[2], types.int64)
    width = LAYOUT.width
    places = [_INDEX(width * i) for i in range(NUM_SUMS)]
    variable: Any = cgutils.alloca_once_value  # Any: Numba does not type it
    kept = [variable(builder, totals.vector(place, width).value) for place in places]
    with cgutils.for_range(builder, count) as loop:
        old = [Lanes(builder, builder.load(place)) for place in kept]
        for place, new in zip(
            kept, body(builder, values, old, loop.index), strict=True
        ):
            builder.store(new.value, place)
    for place, total in zip(places, kept, strict=True):
        totals.store(place, Lanes(builder, builder.load(total)))
    return context.get_dummy_value()


def _multiply_add(
    builder: Any, values: Floats, sums: list[Lanes], index: ir.Value
) -> list[Lanes]:
    """Each sum halved, plus a half: it stays near 1, far from zero and infinity."""
    factor, term = (values.scalar(_INDEX(i), LAYOUT.width) for i in range(2))
    return [fused(total, factor, term) for total in sums]


def _add_next(
    builder: Any, values: Floats, sums: list[Lanes], index: ir.Value
) -> list[Lanes]:
    """The next vectors of the array, one on each sum."""
    first = builder.mul(index, _INDEX(NUM_SUMS * LAYOUT.width))
    return [
        total
        + values.vector(builder.add(first, _INDEX(i * LAYOUT.width)), LAYOUT.width)
        for i, total in enumerate(sums)
    ]


multiply_add = _repeated(_multiply_add)
add_next = _repeated(_add_next)


@entry
def run_arithmetic(values: Float32, sums: Float32, steps: int) -> None:
    """`steps` fused multiply-adds on each of `NUM_SUMS` vectors."""
    multiply_add(values, sums, steps)


@entry
def run_reading(values: Float32, sums: Float32, steps: int, rounds: int) -> None:
    """Read the array a number of times."""
    for _ in range(rounds):
        add_next(values, sums, steps)


def arithmetic_limit(rounds: int) -> NDArray[np.float64]:
    """Float32 operations per second of one core in some rounds, `(round,)` [1/s]."""
    values = np.array([0.5, 0.5], np.float32)
    sums = np.ones((NUM_SUMS, LAYOUT.width), np.float32)
    run_arithmetic(values, sums, 10)
    times = seconds_of(lambda: run_arithmetic(values, sums, _STEPS), rounds)
    return 2.0 * sums.size * _STEPS / times


def read_limit(size: int, rounds: int) -> NDArray[np.float64]:
    """Bytes per second that one core reads of an array, `(round,)` [byte/s].

    Args:
        size: Of the array [byte].
        rounds: How often it is measured.
    """
    sums = np.zeros((NUM_SUMS, LAYOUT.width), np.float32)
    steps = size // sums.nbytes
    values = aligned(np.zeros(steps * sums.size, np.float32))
    again = max(_READ // values.nbytes, 1)
    run_reading(values, sums, steps, 1)
    times = seconds_of(lambda: run_reading(values, sums, steps, again), rounds)
    return values.nbytes * again / times


def measure_limit(effort: Effort) -> list[Figure]:
    """Arithmetic and bandwidth of one core."""
    rounds = 4 * effort.rounds
    layout = f"{NUM_SUMS} vectors of {LAYOUT.width} float32 in registers"
    return [
        figure(GROUP, ARITHMETIC, "GFLOP/s", arithmetic_limit(rounds) / 1e9, layout),
        *(
            figure(GROUP, f"read, {name}", "GB/s", read_limit(size, rounds) / 1e9)
            for name, size in CACHES.items()
        ),
    ]
