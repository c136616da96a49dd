"""The window of last samples: pure in Python, in place when compiled, one answer."""

from __future__ import annotations

from collections import deque

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.base.array import compiled
from costeer.base.window import Window, empty_window, full, mean, push

SAMPLES = st.lists(st.floats(-1e3, 1e3), max_size=30)


@compiled
def filled(values: NDArray[np.float64], length: int) -> Window:
    """A window that has seen all of `values`."""
    window = empty_window(length)
    for value in values:
        window = push(window, value)
    return window


compiled_filled = numba.njit(lambda values, length: filled(values, length))


@given(SAMPLES, st.integers(1, 7))
def test_the_window_holds_the_last_samples(values: list[float], length: int) -> None:
    window = filled(np.array(values), length)
    last = deque(values, maxlen=length)
    assert window.num_samples == len(last)
    assert full(window) is (len(values) >= length)
    kept = np.roll(window.values, -window.next_index)[length - len(last) :]
    assert kept.tolist() == list(last)


@given(SAMPLES.filter(lambda values: len(values) >= 7))
def test_the_mean_is_that_of_the_last_samples(values: list[float]) -> None:
    # Rounding of a sum of seven numbers up to 1000.
    assert mean(filled(np.array(values), 7)) == pytest.approx(
        np.mean(values[-7:]), abs=1e-12
    )


@given(SAMPLES, st.integers(1, 7))
def test_compiled_in_place_equals_the_pure_reference(
    values: list[float], length: int
) -> None:
    pure = filled(np.array(values), length)
    in_place = compiled_filled(np.array(values), length)
    assert in_place.values.tolist() == pure.values.tolist()
    assert in_place[1:] == pure[1:]


def test_pushing_leaves_the_old_window_as_it_was() -> None:
    before = filled(np.array([1.0, 2.0]), 3)
    push(before, 9.0)
    assert before.values.tolist() == [1.0, 2.0, 0.0]


def test_a_constant_signal_leaves_no_rounding_however_long_it_lasts() -> None:
    window = filled(np.concatenate([[1e9] * 60, [0.5] * 600]), 60)
    assert mean(window) == 0.5  # a running sum would keep a rest of the 1e9


def test_a_batch_of_signals_has_the_means_of_its_members() -> None:
    signals = np.random.default_rng(0).normal(size=(10, 4))
    batch = empty_window(6)
    for row in signals:
        batch = push(batch, row)
    members = [mean(filled(signal, 6)) for signal in signals.T]
    assert np.asarray(mean(batch)).tolist() == members
    assert full(batch)
