"""The haptic gain fades and never jumps."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller.strength import (
    StrengthParameters,
    haptic_gain,
    initial_state,
    step,
)
from tests.controller.samples import DT

PARAMETERS = StrengthParameters()


def gains_over(steps_between_switches: list[int]) -> list[float]:
    """K_h while the verdict flips after each of these numbers of steps."""
    state, gains = initial_state(), [1.0]
    for k, num_steps in enumerate(steps_between_switches):
        for _ in range(num_steps):
            state, gain = step(PARAMETERS, state, k % 2 == 1, DT)
            gains.append(gain)
    return gains


@given(st.lists(st.integers(1, 240), min_size=1, max_size=5))
def test_gain_never_jumps(steps_between_switches: list[int]) -> None:
    # The tanh climbs at most λ/2 per second; at a switch it restarts 3.4e-4 off,
    # which Eqs. (12) and (13) call "approximately equal".
    bound = 4.0 / 2.0 * DT + (1.0 - math.tanh(4.0)) / 2.0 + 1e-12
    for before, after in itertools.pairwise(gains_over(steps_between_switches)):
        assert abs(after - before) <= bound


@given(st.lists(st.integers(1, 240), min_size=1, max_size=5))
def test_gain_stays_between_nothing_and_all(steps_between_switches: list[int]) -> None:
    assert all(0.0 <= gain <= 1.0 for gain in gains_over(steps_between_switches))


@given(st.integers(1, 200), st.integers(1, 200))
def test_gain_moves_only_towards_the_verdict(fading_out: int, fading_in: int) -> None:
    gains = gains_over([fading_out, fading_in])
    out, back = gains[: fading_out + 1], gains[fading_out:]
    assert out == sorted(out, reverse=True)
    assert back == sorted(back)


def test_a_consistent_drive_keeps_the_full_gain() -> None:
    state = initial_state()
    for _ in range(100):
        state, gain = step(PARAMETERS, state, True, DT)
        assert gain == 1.0


@pytest.mark.parametrize(("consistent", "gain"), [(True, 0.7), (False, 0.2)])
def test_half_of_the_fade_is_done_at_its_midpoint(
    consistent: bool, gain: float
) -> None:
    assert haptic_gain(PARAMETERS, consistent, 1.0, 0.4) == pytest.approx(gain)


@pytest.mark.parametrize(("consistent", "end"), [(True, 1.0), (False, 0.0)])
def test_the_fade_arrives(consistent: bool, end: float) -> None:
    # tanh(4 · 3) is 1 - 4e-11.
    assert haptic_gain(PARAMETERS, consistent, 4.0, 0.4) == pytest.approx(
        end, abs=1e-10
    )


@given(st.floats(0.0, 5.0), st.floats(0.0, 1.0))
def test_fading_in_mirrors_fading_out(time: float, gain_at_switch: float) -> None:
    fading_in = haptic_gain(PARAMETERS, True, time, gain_at_switch)
    fading_out = haptic_gain(PARAMETERS, False, time, 1.0 - gain_at_switch)
    assert fading_in == pytest.approx(1.0 - fading_out, abs=1e-15)  # rounding


def test_a_switch_captures_the_gain_and_restarts_the_time() -> None:
    state = initial_state()
    for _ in range(60):
        state, gain = step(PARAMETERS, state, False, DT)
    captured = gain
    state, _ = step(PARAMETERS, state, True, DT)
    assert state.gain_at_switch == captured
    assert state.time_in_verdict == 0.0


def test_a_batch_gives_what_its_members_give() -> None:
    times, switches = np.linspace(0.0, 3.0, 31), np.linspace(0.0, 1.0, 31)
    verdicts = np.arange(31) % 2 == 0
    batch = haptic_gain(PARAMETERS, verdicts, times, switches)
    members = [
        haptic_gain(PARAMETERS, *numbers)
        for numbers in zip(
            verdicts.tolist(), times.tolist(), switches.tolist(), strict=True
        )
    ]
    np.testing.assert_allclose(batch, members, 1e-14)  # NumPy's tanh, last place
