"""Runge-Kutta on equations whose solution is known."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from costeer.base import array as xp
from costeer.base.array import Real
from costeer.base.integrate import rk4


class Pendulum(NamedTuple):
    """Angle and rate."""

    angle: Real
    rate: Real


def swing(state: Pendulum, stiffness: Real) -> Pendulum:
    """A linear pendulum, whose solution is a cosine."""
    return Pendulum(angle=state.rate, rate=-stiffness * state.angle)


def full_swing(state: Pendulum, stiffness: Real) -> Pendulum:
    """A real pendulum."""
    return Pendulum(angle=state.rate, rate=-stiffness * xp.sin(state.angle))


def error_after_two_seconds(num_steps: int) -> float:
    """Deviation of the linear pendulum from its closed form."""
    state = Pendulum(1.0, 0.0)
    for _ in range(num_steps):
        state = rk4(swing, state, 4.0, 2.0 / num_steps)
    return abs(state.angle - math.cos(4.0))


def test_half_the_step_leaves_a_sixteenth_of_the_error() -> None:
    ratio = error_after_two_seconds(40) / error_after_two_seconds(80)
    # Order four is 16 in the limit; the fifth-order term is some percent here.
    assert ratio == pytest.approx(16.0, rel=0.1)


def test_one_step_is_the_exponential_series_to_fourth_order() -> None:
    moved = rk4(swing, Pendulum(1.0, 0.0), 1.0, 0.1)
    # cos and sin cut off after the fourth power of the step; 1e-15 is rounding.
    assert moved.angle == pytest.approx(1.0 - 0.1**2 / 2 + 0.1**4 / 24, abs=1e-15)
    assert moved.rate == pytest.approx(-(0.1 - 0.1**3 / 6), abs=1e-15)


def test_a_pendulum_keeps_its_energy() -> None:
    state = Pendulum(1.0, 0.0)
    for _ in range(1000):
        state = rk4(full_swing, state, 1.0, 0.02)
    energy = state.rate**2 / 2.0 - math.cos(state.angle)
    # A linear one loses the share dt⁶ / 72 of its energy in each step: 4e-10 J here.
    assert energy == pytest.approx(-math.cos(1.0), abs=5e-10)


def test_a_batch_gives_what_its_members_give() -> None:
    angles = np.array([-1.0, 0.2, 2.0])
    batch = rk4(full_swing, Pendulum(angles, 0.5 * angles), 3.0, 0.1)
    for k, angle in enumerate(angles.tolist()):
        member = rk4(full_swing, Pendulum(angle, 0.5 * angle), 3.0, 0.1)
        # NumPy's sine may differ in the last place.
        assert batch.angle[k] == pytest.approx(member.angle, rel=1e-14)
        assert batch.rate[k] == pytest.approx(member.rate, rel=1e-14)
