"""The kernel's step against NumPy, and the bookkeeping around it in plain Python."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

from costeer.intention import wavefront
from costeer.intention.features import IntentionSample
from costeer.intention.gru import random_weights
from costeer.intention.kernel import ROWS, TILE, advance_pair

Floats = NDArray[np.float32]


def pair_in_numpy(
    recurrent: Floats,
    candidate_bias: Floats,
    projection: Floats,
    states: Floats,
    new_states: Floats,
    pair: int,
) -> None:
    """What `advance_pair` does, in the order of its rows."""
    sums = recurrent[pair].T @ states
    for unit in range(2):
        own = 2 * pair + unit
        inputs = projection[3 * own : 3 * own + 3]
        rows = sums[3 * unit : 3 * unit + 3]
        reset = 0.5 + 0.5 * np.tanh(rows[0] + inputs[0])
        update = 0.5 + 0.5 * np.tanh(rows[1] + inputs[1])
        candidate = np.tanh(inputs[2] + reset * (rows[2] + candidate_bias[own]))
        new_states[own] = candidate + update * (states[own] - candidate)


@njit
def pair_compiled(
    recurrent: Floats,
    candidate_bias: Floats,
    projection: Floats,
    states: Floats,
    new_states: Floats,
    pair: int,
) -> None:
    advance_pair(recurrent, candidate_bias, projection, states, new_states, pair)


@pytest.mark.parametrize("hidden", [2, 8, 34])
def test_a_pair_of_units_advances_as_in_numpy(hidden: int) -> None:
    rng = np.random.default_rng(hidden)

    def draw(*shape: int) -> Floats:
        return rng.normal(size=shape).astype(np.float32)

    recurrent = draw(hidden // 2, hidden, ROWS)
    arguments = (recurrent, draw(hidden), draw(3 * hidden), draw(hidden, TILE))
    for pair in range(hidden // 2):
        compiled = np.full((hidden, TILE), np.nan, np.float32)
        expected = compiled.copy()
        pair_compiled(*arguments, compiled, pair)
        pair_in_numpy(*arguments, expected, pair)
        # Sums of up to 34 terms of size 1 in float32, and tanh within 4e-7.
        np.testing.assert_allclose(compiled, expected, rtol=0, atol=1e-5)
        touched = np.flatnonzero(np.isfinite(compiled).all(axis=1))
        np.testing.assert_array_equal(touched, [2 * pair, 2 * pair + 1])


def in_python(entry: Any) -> Any:
    """The Python function that Numba compiles."""
    return entry.py_func


@pytest.mark.slow
@pytest.mark.parametrize(
    "absent", [pytest.param((), marks=pytest.mark.slow), ("head_yaw", "yaw_angle")]
)
def test_the_bookkeeping_in_plain_python_gives_the_same_verdicts(
    absent: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    packed = wavefront.wavefront_weights(random_weights(4, 1))
    plain, compiled = (wavefront.initial_state(packed, absent) for _ in range(2))
    rows = np.random.default_rng(0).normal(size=(420, 6))
    rows[150, 5] = np.inf
    rows[200, 4] = np.nan
    rows[385:395, 0] = np.nan  # a lost head
    expected = [wavefront.advance(packed, compiled, IntentionSample(*r)) for r in rows]
    monkeypatch.setattr(wavefront, "advance_pair", pair_in_numpy)
    step = in_python(wavefront.advance)
    found = [step(packed, plain, IntentionSample(*row)) for row in rows]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)
    assert np.isfinite(found[200 + 180 :]).all()
    at_once = np.empty(len(rows))
    state = wavefront.initial_state(packed, absent)
    in_python(wavefront._advance_over)(packed, state, rows, at_once)
    np.testing.assert_array_equal(at_once, found)
