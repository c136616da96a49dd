"""Tables that compiled code reads: where a place lies, and records in rows."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from numpy.typing import NDArray

from costeer.base.lookup import element, interval, rows_of

STARTS = (0.0, 10.0, 10.5, 40.0)
TABLE = np.array([[each, -1.0] for each in (*STARTS, math.inf, math.inf)]).ravel()
FULL = np.array([[each, -1.0] for each in STARTS]).ravel()


@njit  # type: ignore[untyped-decorator]
def compiled_interval(table: Any, width: int, count: float, position: float) -> int:
    return interval(table, width, count, position)


@njit  # type: ignore[untyped-decorator]
def compiled_element(values: Any, index: int) -> float:
    return element(values, index)


ENGINES = pytest.mark.parametrize("found", [interval, compiled_interval])


@ENGINES
@pytest.mark.parametrize("table", [TABLE, FULL])
@pytest.mark.parametrize(
    ("position", "row"),
    [
        (-5.0, 0),
        (0.0, 0),
        (9.99, 0),
        (10.0, 1),
        (10.49, 1),
        (10.5, 2),
        (39.9, 2),
        (40.0, 3),
        (1e9, 3),
    ],
)
def test_a_place_lies_in_the_row_that_began_last(
    found: Any, table: NDArray[np.float64], position: float, row: int
) -> None:
    assert found(table, 2, 4.0, position) == row


@ENGINES
def test_rows_beyond_the_count_are_not_in_use(found: Any) -> None:
    assert found(FULL, 2, 2.0, 100.0) == 1
    assert found(FULL, 2, 1.0, 100.0) == 0


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30, unique=True),
    st.floats(-2e3, 2e3),
)
def test_both_engines_find_the_row_that_counting_finds(
    starts: list[float], position: float
) -> None:
    table = np.array(sorted(starts))
    counted = max(sum(start <= position for start in starts) - 1, 0)
    count = float(len(starts))
    assert interval(table, 1, count, position) == counted
    assert compiled_interval(table, 1, count, position) == counted


def test_an_element_is_a_plain_number() -> None:
    values = np.array([1.5, -2.0])
    assert type(element(values, 1)) is float
    assert element(values, 1) == compiled_element(values, 1) == -2.0


class Inner(NamedTuple):
    """A record in a record."""

    speed: float
    gap: float


class Outer(NamedTuple):
    """A record with two more in it."""

    first: float
    inner: Inner
    last: float
    second: Inner


RECORD = Outer(1.0, Inner(2.0, 3.0), 4.0, Inner(5.0, math.inf))
OTHER = Outer(-1.0, Inner(-2.0, -3.0), -4.0, Inner(-5.0, 0.25))
ROWS = rows_of(RECORD)
read, write = ROWS.read, ROWS.write


@njit  # type: ignore[untyped-decorator]
def exchanged(values: Any) -> None:
    """Exchange the first two rows."""
    one, other = read(values, 0), read(values, 1)
    write(values, 0, other)
    write(values, 1, one)


def test_records_lie_in_the_order_of_their_fields_nested_ones_in_their_places() -> None:
    values = np.zeros(3 * ROWS.width)
    assert ROWS.width == 6
    write(values, 1, RECORD)
    np.testing.assert_array_equal(values[6:12], [1.0, 2.0, 3.0, 4.0, 5.0, math.inf])
    assert not values[:6].any()
    assert not values[12:].any()


def test_what_is_written_is_read_again() -> None:
    values = np.zeros(2 * ROWS.width)
    write(values, 0, RECORD)
    write(values, 1, OTHER)
    assert read(values, 0) == RECORD
    assert read(values, 1) == OTHER
    assert isinstance(read(values, 1).second, Inner)


def test_compiled_code_reads_and_writes_the_same_rows() -> None:
    values = np.zeros(2 * ROWS.width)
    write(values, 0, RECORD)
    write(values, 1, OTHER)
    exchanged(values)
    assert (read(values, 0), read(values, 1)) == (OTHER, RECORD)


@pytest.mark.slow  # imports and traces, 5 s
def test_jax_finds_the_same_rows_and_reads_traced_places() -> None:
    jax = pytest.importorskip("jax")
    values = np.zeros(2 * ROWS.width)
    write(values, 0, RECORD)
    write(values, 1, OTHER)

    def found(position: Any) -> Any:
        row = interval(FULL, 2, 4.0, position)
        return row, read(values, interval(np.array([0.0, 10.0]), 1, 2.0, position))

    for position in (-5.0, 0.0, 10.0, 10.2, 39.0, 100.0):
        row, record = jax.jit(found)(position)
        assert int(row) == interval(FULL, 2, 4.0, position)
        wanted = RECORD if position < 10.0 else OTHER
        np.testing.assert_array_equal(np.array(record.second), wanted.second)
