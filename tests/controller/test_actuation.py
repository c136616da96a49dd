"""Limits between instruction and motor."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller.actuation import (
    STRONG,
    WEAK,
    ActuationParameters,
    applied_torque,
    initial_state,
    step,
)
from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import motor_torque
from tests.controller.samples import DT

PARAMETERS = ActuationParameters()
ANYTHING = st.floats()
GAINS = st.floats(0.0, 1.0)


def applied(instructed: list[float], gain: float = 1.0) -> list[float]:
    """Torques asked of the motor, one for each instruction."""
    state, torques = initial_state(), []
    for torque in instructed:
        state, asked = step(PARAMETERS, state, gain, torque, DT)
        torques.append(asked)
    return torques


@given(st.lists(ANYTHING, max_size=30), st.one_of(GAINS, st.just(math.nan)))
def test_whatever_is_instructed_the_torque_keeps_its_limit(
    instructed: list[float], gain: float
) -> None:
    assert all(abs(torque) <= 5.0 for torque in applied(instructed, gain))


@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=30), GAINS)
def test_the_torque_never_changes_faster_than_its_limit(
    instructed: list[float], gain: float
) -> None:
    # 30 N·m/s at 60 Hz are half a newton metre a step; 1e-12 is rounding.
    for before, after in itertools.pairwise([0.0, *applied(instructed, gain)]):
        assert abs(after - before) <= 30.0 * DT + 1e-12


@pytest.mark.parametrize("lost", [math.nan, math.inf, -math.inf])
def test_a_lost_instruction_is_no_torque_within_100_ms(lost: float) -> None:
    torques = applied([9.0] * 60 + [lost] * 6)
    assert torques[59] == 5.0
    assert torques[65] == 0.0  # six steps are 100 ms


def test_the_motor_too_lets_go_within_100_ms_of_a_lost_instruction() -> None:
    torques = applied([9.0] * 60 + [math.nan] * 6)
    column, given = ColumnParameters(), 5.0
    for asked in torques[60:]:
        given = motor_torque(column, given, asked, DT)
    # Its lag of 20 ms never ends; the rest is less than the wheel's friction holds.
    assert abs(given) < column.friction / 2.0


def test_a_lost_gain_is_no_torque_within_100_ms() -> None:
    state, _ = step(PARAMETERS, initial_state(), 1.0, 5.0, 1.0)
    assert state.applied_torque == 5.0
    for _ in range(6):
        state, torque = step(PARAMETERS, state, math.nan, 5.0, DT)
    assert torque == 0.0


def test_after_a_lost_sample_the_torque_comes_back() -> None:
    torques = applied([2.0] * 60 + [math.nan] + [2.0] * 10)
    assert torques[60] < 2.0
    assert torques[-1] == 2.0


@given(st.floats(-4.9, 4.9), GAINS)
def test_within_the_limits_the_torque_is_gain_times_instruction(
    instructed: float, gain: float
) -> None:
    for factor in (STRONG, WEAK):
        parameters = ActuationParameters(strength_factor=factor)
        assert applied_torque(parameters, gain, instructed) == pytest.approx(
            factor * gain * instructed
        )


@given(st.lists(ANYTHING, max_size=30), GAINS)
def test_mirrored_instructions_give_mirrored_torques(
    instructed: list[float], gain: float
) -> None:
    left = applied(instructed, gain)
    assert applied([-torque for torque in instructed], gain) == [-t for t in left]


def test_a_batch_gives_what_its_members_give() -> None:
    torques = np.array([-9.0, -1.0, 0.2, math.nan, 7.0])
    batch = applied_torque(PARAMETERS, 0.8, torques)
    members = [applied_torque(PARAMETERS, 0.8, torque) for torque in torques.tolist()]
    assert batch.tolist() == members
