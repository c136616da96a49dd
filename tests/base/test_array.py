"""One source, several engines: floats, NumPy and compiled code agree."""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base import array as xp
from costeer.base.array import Real, add_scaled, compiled, repeat

FINITE = st.floats(-50.0, 50.0)
UNARY = (xp.tanh, xp.sin, xp.cos, xp.tan, xp.atan, xp.exp, xp.floor)


class Pair(NamedTuple):
    """A state of two numbers."""

    position: Real
    velocity: Real


@compiled
def every_function(x: Real) -> tuple[Real, ...]:
    """One value of each function of the engine, of flags as 0 and 1."""
    return (
        xp.tanh(x),
        xp.sin(x),
        xp.cos(x),
        xp.tan(x),
        xp.atan(x),
        xp.sqrt(x * x),
        xp.exp(x),
        xp.floor(x),
        xp.minimum(x, 1.0),
        xp.maximum(x, 1.0),
        xp.clip(x, -1.0, 2.0),
        xp.select(xp.isfinite(x), 1.0, 0.0),
        xp.select(xp.logical_not(x < 0.0), 1.0, 0.0),
    )


@compiled
def drift(state: Pair, rate: Real) -> Pair:
    """One step of uniform acceleration."""
    return add_scaled(state, Pair(state.velocity, rate), 0.5)


@compiled
def drifted(times: int) -> Pair:
    """Several of them."""
    return repeat(drift, times, Pair(1.0, -2.0), 3.0)


compiled_functions = numba.njit(lambda x: every_function(x))
compiled_drift = numba.njit(lambda times: drifted(times))


@given(st.lists(FINITE, min_size=1, max_size=5))
def test_a_batch_gives_what_its_members_give(values: list[float]) -> None:
    batch = every_function(np.array(values))
    members = [every_function(value) for value in values]
    # The two libraries' tan and exp may differ by a few units in the last place.
    np.testing.assert_allclose(np.transpose(batch), members, 4e-15, 1e-300)


@pytest.mark.parametrize("x", [-7.0, -0.3, 0.0, 0.5, 1.9, 2.0, math.inf, math.nan])
def test_compiled_code_gives_what_python_gives(x: float) -> None:
    # The compiler's exp and tanh may differ by a few units in the last place.
    np.testing.assert_allclose(compiled_functions(x), every_function(x), 4e-15, 1e-300)


@pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf, -2.5, 3.0])
def test_floor_takes_what_is_not_finite(x: float) -> None:
    np.testing.assert_equal(xp.floor(x), float(np.floor(x)))


def test_clip_leaves_nan_a_nan_in_every_engine() -> None:
    assert math.isnan(xp.clip(math.nan, -1.0, 1.0))
    assert np.isnan(xp.clip(np.array([math.nan]), -1.0, 1.0)).all()
    assert math.isnan(compiled_functions(math.nan)[10])


@given(st.booleans(), FINITE, FINITE)
def test_a_flag_of_any_engine_selects(flag: bool, a: float, b: float) -> None:
    wanted = a if flag else b
    assert xp.select(flag, a, b) == wanted
    assert xp.select(np.bool_(flag), a, b) == wanted
    assert xp.select(np.array([flag]), a, b)[0] == wanted
    assert xp.logical_not(flag) is (not flag)


def test_whole_numbers_count_as_floats() -> None:
    for function in UNARY:
        assert function(2) == function(2.0)
        assert isinstance(function(2), float)


def test_adding_a_scaled_rate_moves_every_field() -> None:
    assert add_scaled(Pair(1.0, 2.0), Pair(10.0, -4.0), 0.5) == Pair(6.0, 0.0)


def test_repeating_is_applying_again() -> None:
    state = Pair(1.0, -2.0)
    for _ in range(4):
        state = drift(state, 3.0)
    assert drifted(4) == state
    assert drifted(0) == Pair(1.0, -2.0)
    assert compiled_drift(4) == state  # the same few additions: no rounding to allow
