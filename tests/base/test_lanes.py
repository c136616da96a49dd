"""Eight numbers at a time are eight numbers: every lane to the last bit."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from costeer.base import array as xp
from costeer.base import lanes
from costeer.base.array import compiled
from costeer.base.lookup import interval
from costeer.base.packing import packed, unpack_lanes

SPECIAL = [0.0, -0.0, 1.0, -1.0, math.inf, -math.inf, math.nan, 5e-324]


def numbers(seed: int) -> np.ndarray:
    """Eight of each: special ones, small ones, large ones; `(eight, lane)`."""
    random = np.random.default_rng(seed)
    drawn = random.standard_normal((40, lanes.WIDTH)) * 10.0 ** random.integers(-9, 9)
    return np.vstack([SPECIAL, random.permutation(SPECIAL), drawn])


def both_ways(function: Any) -> Any:
    """A function of two numbers, eight at a time and one at a time."""
    inner = compiled(function)

    @numba.njit(error_model="numpy")
    def together(a: Any, b: Any, out: Any) -> None:
        for k in range(len(out)):
            out[k] = lanes.spread(inner(lanes.load(a, k), lanes.load(b, k)))

    @numba.njit(error_model="numpy")
    def alone(a: Any, b: Any, out: Any) -> None:
        for k in range(a.shape[0]):
            for lane in range(a.shape[1]):
                out[k, lane] = inner(a[k, lane], b[k, lane])

    return together, alone


def plus(a: Any, b: Any) -> Any:
    return (a + b) - 2.0 * (a - b)


def ratio(a: Any, b: Any) -> Any:
    return -(a * b) / (1 + b * b) - a / b


def augmented(a: Any, b: Any) -> Any:
    total = a
    total += b
    total *= 3
    total -= a
    total /= b
    return total


def ordered(a: Any, b: Any) -> Any:
    return xp.select((a < b) | (a == 0.0), a, b) + xp.select(a >= b, 1.0, 2.0)


def unequal(a: Any, b: Any) -> Any:
    flag = xp.logical_not((a <= b) & (b > 0.5)) != (a != a)
    return xp.select(flag, a, xp.select((a > b) == flag, 3, b))


def limited(a: Any, b: Any) -> Any:
    return xp.clip(a, -1.0, b) + xp.minimum(a, b) - xp.maximum(a, 0.25)


def rooted(a: Any, b: Any) -> Any:
    return xp.sqrt(xp.absolute(a)) + xp.floor(b) + xp.absolute(b)


def finite(a: Any, b: Any) -> Any:
    return xp.select(xp.isfinite(a), b, -1.0)


def curved(a: Any, b: Any) -> Any:
    angle = xp.clip(a, -50.0, 50.0)
    swept = xp.sin(angle) + xp.cos(b) * xp.tan(angle) + xp.atan(a)
    return swept + xp.tanh(b) + xp.exp(-xp.absolute(a))


def powered(a: Any, b: Any) -> Any:
    return (1.0 + a * a) ** 1.5 + xp.log(1.0 + xp.absolute(b))


@pytest.mark.parametrize(
    "function",
    [
        plus,
        ratio,
        augmented,
        ordered,
        unequal,
        limited,
        rooted,
        finite,
        curved,
        powered,
    ],
)
def test_every_lane_is_what_the_number_alone_is(function: Any) -> None:
    a, b = numbers(1), numbers(2)
    together, alone = both_ways(function)
    found, wanted = np.full_like(a, 7.0), np.full_like(a, 8.0)
    together(a, b, found)
    alone(a, b, wanted)
    same = (found.view(np.int64) == wanted.view(np.int64)) | (
        np.isnan(found) & np.isnan(wanted)
    )
    assert same.all(), (a[~same], b[~same], found[~same], wanted[~same])


class Inner(NamedTuple):
    """A record of one number and one flag."""

    value: float
    flag: bool


class Outer(NamedTuple):
    """One inside another, a whole number, and a window."""

    inner: Inner
    count: int
    window: Any
    nothing: Any


def test_a_record_of_eight_is_read_number_by_number() -> None:
    like = Outer(Inner(0.0, False), 3, np.zeros(2), None)
    rows = np.arange(5.0 * lanes.WIDTH).reshape(5, lanes.WIDTH)
    rows[1] = np.arange(lanes.WIDTH) % 2

    @numba.njit
    def read(rows: Any, out: Any) -> int:
        given = unpack_lanes(like, rows)
        out[0] = given.inner.value
        out[1] = given.inner.flag
        for k in range(2):
            out[2 + k] = lanes.load(given.window, k)
        return given.count

    assert len(packed(like)) == 5
    out = np.empty((4, lanes.WIDTH))
    assert read(rows, out) == rows[2, 0]
    np.testing.assert_array_equal(out, rows[[0, 1, 3, 4]])


def test_a_tuple_is_chosen_and_taken_apart_lane_by_lane() -> None:
    @numba.njit
    def chosen(a: Any, b: Any, out: Any) -> None:
        first, second = lanes.load(a, 0), lanes.load(b, 0)
        record = Inner(first, first < second)
        moved = xp.select(record.flag, record._replace(value=1.0), Inner(second, True))
        for lane in range(lanes.WIDTH):
            own = lanes.of_lane(moved, lane)
            out[0, lane] = own.value
            out[1, lane] = 1.0 if own.flag else 0.0

    a, b = np.arange(8.0)[None], np.full((1, 8), 4.0)
    out = np.empty((2, lanes.WIDTH))
    chosen(a, b, out)
    np.testing.assert_array_equal(out[0], [1, 1, 1, 1, 4, 4, 4, 4])
    np.testing.assert_array_equal(out[1], np.ones(8))


@compiled
def counted(calls: Any, value: Any) -> Any:
    """Twice the value; counts that it was called."""
    calls[0] += 1
    return 2.0 * value


@pytest.mark.parametrize(("limit", "calls"), [(-1.0, 0), (3.0, 1), (9.0, 1)])
def test_a_function_that_no_lane_needs_is_not_called(limit: float, calls: int) -> None:
    @numba.njit
    def run(a: Any, limit: float, made: Any, out: Any) -> None:
        value = lanes.load(a, 0)
        given = made, value
        out[0] = lanes.spread(xp.when(value < limit, counted, given, value))

    made, out = np.zeros(1), np.empty((1, lanes.WIDTH))
    eight = np.arange(8.0)
    run(eight[None], limit, made, out)
    assert made[0] == calls
    np.testing.assert_array_equal(out[0], np.where(eight < limit, 2 * eight, eight))


def test_without_a_condition_a_function_is_not_even_compiled() -> None:
    @compiled
    def impossible(value: Any) -> Any:
        return value.no_such_field

    @numba.njit
    def run(value: float) -> float:
        return xp.when(None, impossible, (value,), value)

    assert run(3.0) == 3.0
    assert xp.when(None, impossible, (3.0,), 3.0) == 3.0


def test_each_lane_finds_its_own_row_of_a_table() -> None:
    table = np.array([0.0, 10.0, 20.0, 30.0, math.inf])
    places = np.array([[-5.0, 0.0, 9.9, 10.0, 25.0, 31.0, 1e9, math.nan]])

    @numba.njit
    def find(table: Any, places: Any, out: Any) -> None:
        out[0] = interval(table, 1, 4.0, lanes.load(places, 0))

    @numba.njit
    def find_alone(table: Any, place: float) -> int:
        return interval(table, 1, 4.0, place)

    out = np.empty((1, lanes.WIDTH))
    find(table, places, out)
    np.testing.assert_array_equal(out[0], [find_alone(table, p) for p in places[0]])
    np.testing.assert_array_equal(out[0, :7], [0, 0, 0, 1, 2, 3, 3])
