"""Named tuples are handed on whole in compiled code, and it computes the same."""

from __future__ import annotations

import sys
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target
from numpy.typing import NDArray

from costeer.base.array import compiled


class Pair(NamedTuple):
    """Members of one type."""

    x: float
    y: float


class Held(NamedTuple):
    """Members of every kind, one with memory whose references are counted."""

    flag: bool
    count: int
    pair: Pair
    values: NDArray[np.float64]


class Foreign(NamedTuple):
    """Somebody else's."""

    x: float
    flag: bool


Pair.__module__ = Held.__module__ = "costeer.example"


@compiled
def turned(held: Held, foreign: Foreign) -> tuple[Held, Foreign]:
    pair = Pair(held.pair.y, held.pair.x + foreign.x)
    other = Held(not held.flag, held.count + 1, pair, held.values)
    return other, Foreign(-foreign.x, held.flag)


@numba.njit
def turned_twice(held: Held, foreign: Foreign) -> tuple[Held, Foreign]:
    once, other = turned(held, foreign)
    return turned(once, other)


@numba.njit
def turned_often(held: Held, foreign: Foreign, times: int) -> float:
    for _ in range(times):
        held, foreign = turned(held, foreign)
    return held.pair.x + held.values[0]


def model_of(value: Any) -> Any:
    """How compiled code holds a value."""
    return cpu_target.target_context.data_model_manager[numba.typeof(value)]


@pytest.mark.parametrize("flag", [True, False])
def test_compiled_code_gives_what_python_gives(flag: bool) -> None:
    values = np.array([3.0, 4.0])
    held, foreign = Held(flag, 5, Pair(0.25, -2.0), values), Foreign(1.5, True)
    got, other = turned_twice(held, foreign)
    assert got[:2] == (flag, 7)
    assert type(got.flag) is bool
    assert got.pair == Pair(0.25 + 1.5, -2.0 - 1.5)
    assert got.values is values or np.shares_memory(got.values, values)
    assert other == Foreign(1.5, not flag)


def test_no_reference_is_lost_or_kept() -> None:
    values = np.array([3.0])
    held, foreign = Held(True, 0, Pair(0.0, 0.0), values), Foreign(0.0, True)
    assert turned_often(held, foreign, 3) == 3.0
    before = sys.getrefcount(values)
    for _ in range(50):
        turned_often(held, foreign, 7)
    assert sys.getrefcount(values) == before
    turned_twice(held, foreign)
    assert sys.getrefcount(values) == before
    del held
    assert values.tolist() == [3.0]


def test_a_tuple_of_ours_is_one_argument_and_one_of_others_is_taken_apart() -> None:
    held, foreign = Held(True, 0, Pair(0.0, 0.0), np.zeros(1)), Foreign(0.0, True)
    assert not isinstance(model_of(held).get_argument_type(), tuple)
    assert not isinstance(model_of(held.pair).get_argument_type(), tuple)
    assert isinstance(model_of(foreign).get_argument_type(), tuple)


def test_only_members_with_references_are_looked_into() -> None:
    held = Held(True, 0, Pair(0.0, 0.0), np.zeros(1))
    inside = [kind for kind, _ in model_of(held).traverse(None)]
    assert inside == [numba.typeof(held.values)]
    assert model_of(held.pair).traverse(None) == []
