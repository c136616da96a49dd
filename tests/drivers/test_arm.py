"""Arms: stiffness, stability on the column, guidance that does the work."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.drivers.arm import (
    ArmCommand,
    ArmParameters,
    active_torque,
    driver_torque,
    shared_torque,
    wanted_torque,
)
from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import steering_wheel_rate

PLANT_DT = 1.0 / 480.0
RELAXED = ArmCommand(
    intended_angle=0.0,
    holding_stiffness=3.0,
    stiffening=1.0,
    guidance=0.0,
    reliance=0.0,
)
TORQUES = st.floats(-10.0, 10.0)


def settled_torque(command: ArmCommand, angle: float) -> float:
    """Torque of the hands on a wheel that is held still for 3 s, 30 lags."""
    parameters, active = ArmParameters(), 0.0
    for _ in range(round(3.0 / PLANT_DT)):
        active = active_torque(parameters, active, command, angle, PLANT_DT)
    return driver_torque(parameters, active, 0.0)


def test_arms_are_a_spring_of_stiffness_k_t_around_the_intended_angle() -> None:
    # K_r K_hold θ + K_t (θ - angle), Saleh et al.; exp(-30) of the lag is left.
    command = RELAXED._replace(intended_angle=0.1)
    expected = 0.75 * 3.0 * 0.1 + 12.0 * (0.1 - 0.3)
    assert settled_torque(command, 0.3) == pytest.approx(expected, rel=1e-9)


def test_tense_arms_are_stiffer_by_the_factor_of_cocontraction() -> None:
    relaxed = settled_torque(RELAXED, 0.2)
    tense = settled_torque(RELAXED._replace(stiffening=2.2), 0.2)
    assert tense == pytest.approx(2.2 * relaxed, rel=1e-9)


def test_muscles_answer_with_their_lag() -> None:
    parameters, active = ArmParameters(), 0.0
    for _ in range(round(parameters.lag / PLANT_DT)):
        active = active_torque(parameters, active, RELAXED, -0.1, PLANT_DT)
    # One lag after a step, 1 - 1/e of 12 N·m/rad · 0.1 rad is there.
    assert active == pytest.approx(1.2 * (1.0 - math.exp(-1.0)), rel=1e-9)


def test_the_hands_resist_motion_at_once() -> None:
    assert driver_torque(ArmParameters(), 0.0, 2.0) == -1.0
    assert driver_torque(ArmParameters(hands_on=0.0), 5.0, 2.0) == 0.0


def is_stable(stiffness: float, holding_stiffness: float) -> bool:
    """Routh: wheel on its column, arm and aligning torque as springs, muscle lag."""
    column, arm = ColumnParameters(), ArmParameters()
    damping = column.damping + arm.damping
    inertia, spring, lag = column.inertia, holding_stiffness, arm.lag
    # (J s² + D s + C)(T s + 1) + K = a s³ + b s² + c s + d
    a, b = inertia * lag, inertia + damping * lag
    c, d = damping + spring * lag, spring + stiffness
    return b * c > a * d


def test_arms_of_the_whole_population_are_stable_on_the_column() -> None:
    # 8 to 20 N·m/rad, up to 3 times that when tense; wheel from free to stiff.
    for stiffness, holding in itertools.product((8.0, 20.0, 60.0), (2.0, 6.0)):
        assert is_stable(stiffness, holding)
    assert not is_stable(400.0, 2.0)  # the criterion can say no


def swing(stiffness: float) -> list[float]:
    """Largest angle in each second after the wheel is let go at 0.2 rad."""
    column = ColumnParameters(friction=0.0)
    arm = ArmParameters(stiffness=stiffness)
    angle, rate, active, peaks = 0.2, 0.0, 0.0, []
    for _ in range(3):
        peak = 0.0
        for _ in range(480):
            active = active_torque(arm, active, RELAXED, angle, PLANT_DT)
            hands = driver_torque(arm, active, rate)
            rate = steering_wheel_rate(column, angle, rate, hands, PLANT_DT)
            angle += PLANT_DT * rate
            peak = max(peak, abs(angle))
        peaks.append(peak)
    return peaks


def test_the_stiffest_arms_come_to_rest_on_the_simulated_column() -> None:
    first, second, third = swing(60.0)
    assert third < 0.5 * second < 0.25 * first


def test_arms_beyond_the_criterion_swing_on() -> None:
    first, second, third = swing(400.0)
    assert third > second > first


@given(TORQUES, TORQUES)
def test_shared_torque_is_odd(wanted: float, guidance: float) -> None:
    assert shared_torque(-wanted, -guidance) == -shared_torque(wanted, guidance)


@given(TORQUES, TORQUES, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_shared_torque_has_no_jump(w: float, g: float, dw: float, dg: float) -> None:
    # It moves at most as far as the one of the two that moves further.
    change = abs(shared_torque(w + dw, g + dg) - shared_torque(w, g))
    assert change <= max(abs(dw), abs(dg)) + 1e-12


@given(TORQUES, TORQUES)
def test_shared_torque_is_never_more_than_either(w: float, g: float) -> None:
    assert abs(shared_torque(w, g)) <= min(abs(w), abs(g))
    if min(w, g) <= 0.0 <= max(w, g):
        assert shared_torque(w, g) == 0.0


def test_full_reliance_on_guidance_that_suffices_leaves_no_torque() -> None:
    wanted = wanted_torque(ArmParameters(), RELAXED, -0.1)
    trusting = RELAXED._replace(guidance=1.5 * wanted, reliance=1.0)
    assert wanted == pytest.approx(1.2)
    assert settled_torque(trusting, -0.1) == 0.0


def test_guidance_that_opposes_takes_nothing_from_the_driver() -> None:
    opposed = RELAXED._replace(guidance=-3.0, reliance=1.0)
    assert settled_torque(opposed, -0.1) == settled_torque(RELAXED, -0.1) > 0.0


def test_half_reliance_halves_the_torque_that_guidance_shares() -> None:
    half = RELAXED._replace(guidance=5.0, reliance=0.5)
    alone = settled_torque(RELAXED, -0.1)
    assert settled_torque(half, -0.1) == pytest.approx(0.5 * alone, rel=1e-9)
