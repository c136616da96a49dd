"""The steering column: dry friction holds, dampers lose energy, the motor lags."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.parameters import DEFAULT_CAR, ColumnParameters
from costeer.plant.steering import aligning_torque, motor_torque, steering_wheel_rate

DT = 1.0 / 480.0
COLUMN = ColumnParameters()
LOOSE = COLUMN._replace(stiffness=0.0)
ANGLES = st.floats(-5.0, 5.0)
RATES = st.floats(-10.0, 10.0)
TORQUES = st.floats(-20.0, 20.0)


def turned(
    column: ColumnParameters, angle: float, rate: float, torque: float, num_steps: int
) -> tuple[float, float]:
    """Angle and rate of the wheel after some steps under a constant torque."""
    for _ in range(num_steps):
        rate = steering_wheel_rate(column, angle, rate, torque, DT)
        angle += DT * rate
    return angle, rate


def energy(column: ColumnParameters, angle: float, rate: float) -> float:
    """Kinetic and spring energy of the wheel [J]."""
    return column.inertia * rate**2 / 2.0 + column.stiffness * angle**2 / 2.0


@given(ANGLES, st.floats(-0.999, 0.999))
def test_a_wheel_at_rest_under_less_than_the_friction_stays_at_rest(
    angle: float, share: float
) -> None:
    torque = COLUMN.stiffness * angle + share * COLUMN.friction
    assert turned(COLUMN, angle, 0.0, torque, 3) == (angle, 0.0)


def test_a_wheel_at_rest_under_more_than_the_friction_moves() -> None:
    for side in (-1.0, 1.0):
        _, rate = turned(LOOSE, 0.0, 0.0, side * 1.01 * COLUMN.friction, 1)
        assert rate * side > 0.0


@given(ANGLES, RATES)
def test_energy_never_grows_without_a_torque(angle: float, rate: float) -> None:
    before = energy(COLUMN, angle, rate)
    for _ in range(20):
        angle, rate = turned(COLUMN, angle, rate, 0.0, 1)
        after = energy(COLUMN, angle, rate)
        assert after <= before * (1.0 + 1e-12)  # rounding at rest
        before = after


def test_a_wheel_without_spring_comes_to_rest_exactly() -> None:
    _, rate = turned(LOOSE, 1.0, 2.0, 0.0, 200)
    assert rate == 0.0


@given(st.floats(0.3, 10.0), st.sampled_from([-1.0, 1.0]))
def test_the_steady_rate_is_the_torque_above_friction_over_the_damping(
    torque: float, side: float
) -> None:
    _, rate = turned(LOOSE, 0.0, 0.0, side * torque, 500)
    # A second is 25 time constants J / B = 40 ms: e⁻²⁵ = 1e-11 of it is missing.
    steady = side * (torque - LOOSE.friction) / LOOSE.damping
    assert rate == pytest.approx(steady, rel=1e-9)


def test_half_the_step_halves_the_error_of_a_swing() -> None:
    # Underdamped, without friction: the closed form is a decaying cosine.
    column = ColumnParameters(inertia=0.06, damping=0.1, stiffness=2.0, friction=0.0)
    decay = column.damping / (2.0 * column.inertia)
    frequency = math.sqrt(column.stiffness / column.inertia - decay**2)
    swing = math.cos(frequency) + decay / frequency * math.sin(frequency)
    errors = []
    for num_steps in (960, 1920):
        angle, rate, dt = 1.0, 0.0, 1.0 / num_steps
        for _ in range(num_steps):
            rate = steering_wheel_rate(column, angle, rate, 0.0, dt)
            angle += dt * rate
        errors.append(abs(angle - math.exp(-decay) * swing))
    # First order: two in the limit, the second-order term is some percent here.
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)


@given(ANGLES, RATES, TORQUES)
def test_a_mirrored_wheel_turns_the_other_way(
    angle: float, rate: float, torque: float
) -> None:
    left = steering_wheel_rate(COLUMN, angle, rate, torque, DT)
    assert steering_wheel_rate(COLUMN, -angle, -rate, -torque, DT) == -left


@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(1e-4, 0.2))
def test_the_motor_follows_a_first_order_lag(
    before: float, command: float, dt: float
) -> None:
    gone = 1.0 - math.exp(-dt / COLUMN.motor_lag)
    # Rounding of a few newton metres.
    assert motor_torque(COLUMN, before, command, dt) == pytest.approx(
        before + (command - before) * gone, abs=1e-14
    )


@given(st.floats(-5.0, 5.0), st.floats())
def test_the_motor_never_passes_its_limit(before: float, command: float) -> None:
    torque = motor_torque(COLUMN, before, command, DT)
    assert abs(torque) <= COLUMN.torque_limit


@pytest.mark.parametrize("command", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_not_finite_asks_for_no_torque(command: float) -> None:
    assert motor_torque(COLUMN, 0.0, command, DT) == 0.0
    assert 0.0 < motor_torque(COLUMN, 5.0, command, 0.1) < 0.05


def test_the_tyres_pull_with_the_aligning_stiffness_at_small_slip() -> None:
    slip = 0.01
    force = -DEFAULT_CAR.front_cornering_stiffness * slip
    # The specification's k_s of the default car is 107 N·m/rad, rounded.
    assert aligning_torque(DEFAULT_CAR, force) == pytest.approx(107.0 * slip, rel=3e-3)


def test_a_batch_gives_what_its_members_give() -> None:
    generator = np.random.default_rng(0)
    angles, rates, torques = generator.normal(size=(3, 40))
    batch = steering_wheel_rate(COLUMN, angles, rates, torques, DT)
    members = [
        steering_wheel_rate(COLUMN, *numbers, DT)
        for numbers in zip(
            angles.tolist(), rates.tolist(), torques.tolist(), strict=True
        )
    ]
    assert batch.tolist() == members
