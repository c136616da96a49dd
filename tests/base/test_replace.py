"""`record._replace(field=value)` and `Record(field=value)` mean the same compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.base.array import Flag, Real, compiled


class Inner(NamedTuple):
    """A record inside another."""

    x: Real = 1.0
    y: Real = 2.0


class Outer(NamedTuple):
    """A record of every kind of field."""

    a: Real = 3.0
    b: Real = 4.0
    flag: Flag = True
    inner: Inner = Inner()


@compiled
def with_a(record: Outer, value: Real) -> Outer:
    return record._replace(a=value)


@compiled
def with_b(record: Outer, value: Real) -> Outer:
    return record._replace(b=value)


@compiled
def with_inner_y(record: Outer, value: Real) -> Outer:
    return record._replace(inner=record.inner._replace(y=value), flag=value > 0.0)


@compiled
def in_either_order(record: Outer, value: Real) -> tuple[Outer, Outer]:
    return record._replace(a=value, b=7), record._replace(b=7, a=value)


@compiled
def made_anew(record: Outer, value: Real) -> tuple[Outer, Outer]:
    return Outer(b=value), Outer(record.b, inner=Inner(y=value))


CHANGES = (with_a, with_b, with_inner_y, in_either_order, made_anew)
FAST = [numba.njit(change) for change in CHANGES]


@given(st.sampled_from(range(len(CHANGES))), st.floats(-1e6, 1e6))
def test_compiled_code_gives_what_python_gives(which: int, value: float) -> None:
    assert FAST[which](Outer(), value) == CHANGES[which](Outer(), value)


def test_two_fields_of_one_type_are_not_taken_for_each_other() -> None:
    def both(record: Outer, value: Real) -> tuple[Outer, Outer]:
        return with_a(record, value), with_b(record, value)

    assert numba.njit(both)(Outer(), 9.0) == (Outer(a=9.0), Outer(b=9.0))


def test_nothing_named_changes_nothing() -> None:
    assert numba.njit(lambda record: record._replace())(Outer()) == Outer()


def test_an_array_in_a_record_is_replaced_whole() -> None:
    class Window(NamedTuple):
        values: NDArray[np.float64]
        place: Real

    def refilled(window: Window) -> Window:
        return window._replace(values=window.values + 1.0)

    changed = numba.njit(refilled)(Window(np.zeros(3), 2.0))
    assert changed.values.tolist() == [1.0, 1.0, 1.0]
    assert changed.place == 2.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda record: record._replace(c=1.0), "no field c; it has a, b, flag, inner"),
        (lambda record: record._replace(inner=1.0), "Outer.inner is"),
        (lambda record: record._replace(flag=0.5), "Outer.flag is bool"),
        (lambda record: record._replace(1.0), "by name only"),
    ],
)
def test_what_python_or_mypy_refuse_is_an_error_when_compiled(
    change: Callable[[Any], Any], told: str
) -> None:
    with pytest.raises(numba.TypingError, match=told):
        numba.njit(change)(Outer())
