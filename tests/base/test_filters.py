"""First-order filters, exact for any step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.filters import coloured_noise, decay, low_pass

TIMES = st.floats(1e-3, 10.0)
VALUES = st.floats(-10.0, 10.0)


@given(VALUES, VALUES, TIMES, TIMES, TIMES)
def test_two_steps_are_one_long_step(
    state: float, value: float, first: float, second: float, time_constant: float
) -> None:
    twice = low_pass(
        low_pass(state, value, first, time_constant), value, second, time_constant
    )
    once = low_pass(state, value, first + second, time_constant)
    assert twice == pytest.approx(once, abs=1e-14)  # rounding of numbers up to 10


def test_after_one_time_constant_a_share_of_one_over_e_is_left() -> None:
    assert decay(0.1, 0.1) == math.exp(-1.0)
    assert low_pass(0.0, 1.0, 0.1, 0.1) == pytest.approx(1.0 - math.exp(-1.0))


@given(VALUES, TIMES)
def test_what_has_settled_stays(value: float, time_constant: float) -> None:
    assert low_pass(value, value, 0.01, time_constant) == value


def test_coloured_noise_settles_to_its_deviation_at_any_step() -> None:
    generator = np.random.default_rng(3)
    for dt in (0.05, 2.0):
        state = np.zeros(20_000)
        for _ in range(int(10.0 / dt)):
            state = coloured_noise(
                state, generator.standard_normal(state.size), 0.2, dt, 1.0
            )
        # The deviation of 20,000 independent draws is known to 0.5 percent (one
        # standard error), so 2 percent is four of them.
        assert np.std(state) == pytest.approx(0.2, rel=0.02)


def test_coloured_noise_forgets_by_e_in_its_time_constant() -> None:
    assert coloured_noise(1.0, 0.0, 0.2, 3.0, 3.0) == math.exp(-1.0)


def test_a_batch_of_filters_gives_what_its_members_give() -> None:
    states, values = np.array([1.0, -2.0, 3.0]), np.array([0.0, 0.5, -1.0])
    batch = low_pass(states, values, 0.01, np.array([0.1, 0.2, 0.3]))
    members = [
        low_pass(s, v, 0.01, t)
        for s, v, t in zip(
            states.tolist(), values.tolist(), (0.1, 0.2, 0.3), strict=True
        )
    ]
    np.testing.assert_allclose(batch, members, 1e-15)  # one rounding of exp
