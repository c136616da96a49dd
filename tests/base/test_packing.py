"""Packing undone by unpacking, in Python and in compiled code."""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba.core.runtime import _nrt_python as counting
from numba.core.runtime import rtsys
from numpy.typing import NDArray

from costeer.base.array import Flag, Real
from costeer.base.packing import leaf_names, pack, packed, packed_size, unpack


class Inner(NamedTuple):
    """A number, a flag and a memory."""

    torque: Real
    held: Flag
    memory: NDArray[np.float64]


class Outer(NamedTuple):
    """A count, a tuple and a number."""

    count: int
    inner: Inner
    speed: Real


LIKE = Outer(count=0, inner=Inner(0.0, False, np.zeros(3)), speed=0.0)
NUMBERS = st.floats(allow_nan=False)
OUTERS = st.builds(
    Outer,
    st.integers(-(2**53), 2**53),
    st.builds(
        Inner,
        NUMBERS,
        st.booleans(),
        st.lists(NUMBERS, min_size=3, max_size=3).map(np.array),
    ),
    NUMBERS,
)

# Compiled code finds the types of the tuple in an argument, as the loop does.
compiled_pack = numba.njit(lambda array, value: pack(array, value))
compiled_unpack = numba.njit(lambda like, array: unpack(like, array))


def same(one: Outer, other: Outer) -> bool:
    """Whether two tuples agree in every number and type."""
    alike = packed(one).tolist() == packed(other).tolist()
    return alike and [type(part) for part in one] == [type(part) for part in other]


@given(OUTERS)
def test_unpacking_undoes_packing(value: Outer) -> None:
    again = unpack(LIKE, packed(value))
    assert same(again, value)
    assert isinstance(again.inner.held, bool)


@pytest.mark.slow
@given(OUTERS)
def test_compiled_packing_equals_packing_in_python(value: Outer) -> None:
    array = np.full(packed_size(value), math.nan)
    compiled_pack(array, value)
    assert array.tolist() == packed(value).tolist()
    assert same(compiled_unpack(LIKE, array), value)


def test_an_unpacked_memory_is_a_copy() -> None:
    array = packed(LIKE)
    for unpacked in (unpack(LIKE, array), compiled_unpack(LIKE, array)):
        unpacked.inner.memory[0] = 9.0
        assert not array.any()


def test_numbers_lie_in_the_order_of_the_fields() -> None:
    value = Outer(count=1, inner=Inner(2.0, True, np.array([3.0, 4.0, 5.0])), speed=6.0)
    assert packed(value).tolist() == [1.0, 2.0, 1.0, 3.0, 4.0, 5.0, 6.0]
    assert packed_size(value) == 7


def test_every_packed_number_has_a_dotted_name() -> None:
    assert leaf_names(LIKE) == [
        "count",
        "inner.torque",
        "inner.held",
        *["inner.memory"] * 3,
        "speed",
    ]


@pytest.mark.parametrize("room", [7, 10])
def test_packing_writes_from_the_start_and_no_further(room: int) -> None:
    array = np.full(room, 8.0)
    pack(array, LIKE)
    assert array.tolist() == [0.0] * 7 + [8.0] * (room - 7)


def test_compiled_it_takes_an_array_without_gaps_alone() -> None:
    array = np.zeros(14)
    with pytest.raises(numba.TypingError, match="no row of float64 without gaps"):
        compiled_pack(array[::2], LIKE)
    with pytest.raises(numba.TypingError, match="no row of float64 without gaps"):
        compiled_unpack(LIKE, array.astype(np.float32))


def test_unpacked_memories_are_given_back() -> None:
    """Each is a new array with one owner: no memory leaks, none is freed twice."""
    array = packed(LIKE)
    counting.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats()
        for _ in range(100):
            compiled_unpack(LIKE, array)
        after = rtsys.get_allocation_stats()
    finally:
        counting.memsys_disable_stats()
    assert after.alloc - before.alloc == after.free - before.free > 0
