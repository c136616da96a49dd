"""First-order filters, exact for any step, and the all-pass delay."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.base.filters import coloured_noise, decay, low_pass, pade_delay

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


STEPS = (1.0 / 60.0, 1.0 / 480.0)
"""Of control and of the plant [s]."""
DELAY = 0.04


def delayed(values: NDArray[np.float64], dt: float, state: float = 0.0) -> list[float]:
    """The values through a delay of 40 ms."""
    answers = []
    for value in values.tolist():
        state, answer = pade_delay(state, value, DELAY, dt)
        answers.append(answer)
    return answers


def delay_gain(frequency: float, dt: float) -> complex:
    """Transfer function at a frequency [Hz], from the answer to a single 1.

    The memory shrinks by (T - dt) / (T + dt) a step: after 10 s nothing is left.
    """
    single = np.zeros(round(10.0 / dt))
    single[0] = 1.0
    turns = np.exp(-2j * math.pi * frequency * dt * np.arange(single.size))
    return complex(np.array(delayed(single, dt)) @ turns)


@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("share", [0.0, 0.01, 0.1, 0.3, 0.7, 1.0])
def test_a_delay_changes_no_amplitude_up_to_half_the_sampling_rate(
    dt: float, share: float
) -> None:
    # Sums of 600 to 4800 products of numbers up to 1: rounding.
    assert abs(delay_gain(share / 2.0 / dt, dt)) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("dt", STEPS)
def test_slow_signals_come_out_exactly_the_delay_later(dt: float) -> None:
    # The phase is -2 atan(T tan(w dt / 2) / dt): w T up to (w T)^3 / 12, 5e-8 of it.
    frequency = 3e-3
    phase = cmath.phase(delay_gain(frequency, dt))
    assert -phase / (2.0 * math.pi * frequency) == pytest.approx(DELAY, rel=1e-6)


@pytest.mark.parametrize("dt", STEPS)
def test_a_ramp_comes_out_as_the_ramp_of_the_delay_before(dt: float) -> None:
    ramp = 3.0 * dt * np.arange(round(2.0 / dt))
    # After 2 s, 50 delays, the start has been forgotten.
    assert delayed(ramp, dt)[-1] == pytest.approx(ramp[-1] - 3.0 * DELAY, abs=1e-12)


@pytest.mark.parametrize("dt", STEPS)
def test_a_delay_settles_to_what_goes_in(dt: float) -> None:
    assert delayed(np.full(round(2.0 / dt), 1.5), dt)[-1] == pytest.approx(1.5)


@given(VALUES, TIMES, TIMES)
def test_a_delay_that_rests_at_a_value_stays_there(
    value: float, delay: float, dt: float
) -> None:
    rest = 2.0 * value * delay / (delay + dt)
    state, answer = pade_delay(rest, value, delay, dt)
    # One rounding of numbers up to 20 in each of a few operations.
    assert answer == pytest.approx(value, abs=1e-13)
    assert state == pytest.approx(rest, abs=1e-13)
