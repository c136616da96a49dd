"""Arms: stiffness at once and by reflex, what they add to the wheel they hold."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.drivers import arm
from costeer.drivers.arm import (
    ArmParameters,
    ArmState,
    arm_damping,
    hand_torque,
    held_column,
    muscle_torque,
    wanted_torque,
)
from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import steering_wheel_rate
from tests.drivers.arms import (
    PARAMETERS,
    PLANT_DT,
    RELAXED,
    TENSE,
    settled_torque,
    torques,
)

ANGLES = st.floats(-2.0, 2.0)
TORQUES = st.floats(-10.0, 10.0)


@given(ANGLES, ANGLES, st.floats(0.0, 6.0), st.floats(0.0, 1.0), st.floats(1.0, 3.0))
def test_a_held_wheel_feels_the_published_torque_whatever_acts_at_once(
    intended: float, angle: float, holding: float, share: float, stiffening: float
) -> None:
    # Saleh et al. (2013): K_r K_hold θ_i + K_t (θ_i - θ).
    command = RELAXED._replace(
        intended_angle=intended, holding_stiffness=holding, stiffening=stiffening
    )
    parameters = ArmParameters(intrinsic_share=share)
    expected = 0.75 * holding * intended + 12.0 * stiffening * (intended - angle)
    settled = settled_torque(command, angle, parameters)
    assert settled == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert wanted_torque(parameters, command, angle) == pytest.approx(expected)


def test_muscles_bring_an_intended_angle_with_their_lag() -> None:
    # The lag is exact for what is held: K_r H + K_t times 1 - exp(-t / T).
    answers = torques(RELAXED._replace(intended_angle=0.1), 0.0, 0.5)
    times = PLANT_DT * np.arange(1, answers.size + 1)
    expected = (0.75 * 3.0 + 12.0) * 0.1 * (1.0 - np.exp(-times / 0.1))
    np.testing.assert_allclose(answers, expected, rtol=1e-9)


def test_relaxed_muscles_resist_a_turned_wheel_at_once_by_their_share() -> None:
    only_muscle = ArmParameters(intrinsic_share=1.0)
    expected = -12.0 * 0.1
    at_once = torques(RELAXED, 0.1, 0.5, only_muscle)
    np.testing.assert_allclose(at_once, expected, rtol=1e-12)
    # With a reflex: its Padé delay starts the wrong way, 1/50 of it in one step.
    share = PARAMETERS.intrinsic_share
    first = torques(RELAXED, 0.1, 0.5)[0]
    assert first == pytest.approx(share * expected, abs=0.03 * abs(expected))


def reflex_share(seconds: float) -> NDArray[np.float64]:
    """Reflex torque after the wheel was turned, over its lasting value."""
    only_reflex = ArmParameters(intrinsic_share=0.0)
    return torques(RELAXED, 0.1, seconds, only_reflex) / (-12.0 * 0.1)


def test_the_reflex_comes_after_its_delay_and_the_muscles_lag() -> None:
    # The area above a step response is its mean delay: 40 ms of the reflex and 100 ms
    # of the muscle, which takes each sample half a plant step early.
    delay = float(np.sum(1.0 - reflex_share(4.0)) * PLANT_DT)
    assert delay == pytest.approx(0.14 - PLANT_DT / 2.0, abs=1e-4)


def test_the_reflex_gives_next_to_nothing_within_its_delay() -> None:
    # A pure delay would give nothing; Padé's, through the lag, stays within 6.3 %.
    answers = reflex_share(0.3)
    assert np.abs(answers[: round(0.04 / PLANT_DT)]).max() < 0.07
    assert answers[-1] > 0.9


def test_the_reflex_answers_as_its_closed_form() -> None:
    # Padé of 40 ms and a lag of 100 ms: 1 + e^(-50 t) / 2 - 3 e^(-10 t) / 2. Steps of
    # 1/480 s shift it by half of one; its steepest slope is 7 per second.
    answers = reflex_share(0.5)
    times = PLANT_DT * np.arange(1, answers.size + 1)
    expected = 1.0 + 0.5 * np.exp(-50.0 * times) - 1.5 * np.exp(-10.0 * times)
    np.testing.assert_allclose(answers, expected, atol=10.0 * PLANT_DT)


def test_what_cocontraction_adds_acts_at_once() -> None:
    added = torques(TENSE, 0.1, 0.5) - torques(RELAXED, 0.1, 0.5)
    np.testing.assert_allclose(added, -12.0 * 1.2 * 0.1, rtol=1e-9)


def test_damping_grows_with_the_root_of_the_stiffness() -> None:
    assert arm_damping(PARAMETERS, 1.0) == PARAMETERS.damping
    assert arm_damping(PARAMETERS, 2.25) == pytest.approx(1.5 * PARAMETERS.damping)
    assert arm_damping(ArmParameters(hands_on=0.0), 2.25) == 0.0


def test_arms_add_their_inertia_and_damping_to_the_wheel_they_hold() -> None:
    column = ColumnParameters(friction=0.2, motor_lag=0.03, torque_limit=4.0)
    held = held_column(PARAMETERS, column, 4.0)
    assert held == column._replace(
        inertia=column.inertia + PARAMETERS.inertia,
        damping=column.damping + 2.0 * PARAMETERS.damping,
    )


def test_a_wheel_without_hands_is_the_column_alone() -> None:
    column, nobody = ColumnParameters(friction=0.2), ArmParameters(hands_on=0.0)
    assert held_column(nobody, column, 2.2) == column
    assert not torques(TENSE._replace(intended_angle=0.3), 0.1, 0.2, nobody).any()
    assert hand_torque(nobody, 0.0, 2.2, 3.0, -40.0) == 0.0


def test_hands_give_what_the_muscles_do_less_what_moves_the_arms() -> None:
    torque = hand_torque(PARAMETERS, 5.0, 4.0, 2.0, 10.0)
    damping, inertia = PARAMETERS.damping, PARAMETERS.inertia
    assert torque == pytest.approx(5.0 - 2.0 * damping * 2.0 - inertia * 10.0)


class Wheel:
    """A wheel in two hands, without friction; what pulls it straight is given."""

    def __init__(
        self, parameters: ArmParameters, stiffening: float, pull: float
    ) -> None:
        self.arm = parameters
        self.command = RELAXED._replace(stiffening=stiffening, holding_stiffness=pull)
        column = ColumnParameters(friction=0.0, stiffness=pull)
        self.column = held_column(parameters, column, stiffening)

    def moved(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angle, rate and arms a plant step later."""
        angle, rate, delayed, reflex = values.tolist()
        before = arm.initial_state()._replace(delayed=delayed, reflex=reflex)
        after = arm.step(self.arm, before, self.command, angle, PLANT_DT)
        muscles = muscle_torque(self.arm, after, self.command, angle)
        rate = steering_wheel_rate(self.column, angle, rate, muscles, PLANT_DT)
        return np.array([angle + PLANT_DT * rate, rate, after.delayed, after.reflex])

    def largest_modulus(self) -> float:
        """Of the eigenvalues of one plant step; below 1 the wheel comes to rest."""
        matrix = np.transpose([self.moved(unit) for unit in np.eye(4)])
        return float(np.abs(np.linalg.eigvals(matrix)).max())


def test_arms_of_the_whole_population_are_stable_on_the_column() -> None:
    # 8 to 20 N·m/rad, relaxed to 3 times tense, the wheel from free to stiff, arms
    # three standard deviations lighter or heavier than usual.
    size = math.exp(3.0 * 0.15)
    for stiffness, stiffening, pull, factor in itertools.product(
        (8.0, 12.0, 20.0), (1.0, 1.5, 3.0), (0.0, 2.0, 8.0), (1.0 / size, 1.0, size)
    ):
        arms = ArmParameters(
            stiffness=stiffness, inertia=0.09 * factor, damping=0.5 / factor
        )
        assert Wheel(arms, stiffening, pull).largest_modulus() < 1.0


def test_arms_that_are_reflex_alone_and_far_too_stiff_are_unstable() -> None:
    wild = ArmParameters(stiffness=200.0, intrinsic_share=0.0)
    assert Wheel(wild, 1.0, 2.0).largest_modulus() > 1.0


def swing(wheel: Wheel) -> list[float]:
    """Largest angle in each second after the wheel is let go at 0.2 rad."""
    values, peaks = np.array([0.2, 0.0, 0.0, 0.0]), []
    for _ in range(3):
        peak = 0.0
        for _ in range(480):
            values = wheel.moved(values)
            peak = max(peak, abs(values[0]))
        peaks.append(peak)
    return peaks


def test_the_stiffest_arms_come_to_rest_on_the_simulated_column() -> None:
    first, second, third = swing(Wheel(ArmParameters(stiffness=20.0), 3.0, 2.0))
    assert third < 0.5 * second < 0.25 * first


def mirrored(state: ArmState) -> ArmState:
    return ArmState(*(-value for value in state))


@given(ANGLES, ANGLES, TORQUES, st.floats(0.0, 1.0), st.floats(1.0, 3.0))
def test_mirrored_commands_give_mirrored_torques(
    intended: float, angle: float, guidance: float, trust: float, stiffening: float
) -> None:
    command = RELAXED._replace(
        intended_angle=intended,
        guidance=guidance,
        reliance=trust,
        stiffening=stiffening,
    )
    turned = command._replace(intended_angle=-intended, guidance=-guidance)
    here, there = arm.initial_state(), arm.initial_state()
    for _ in range(3):
        here = arm.step(PARAMETERS, here, command, angle, PLANT_DT)
        there = arm.step(PARAMETERS, there, turned, -angle, PLANT_DT)
        left = muscle_torque(PARAMETERS, here, command, angle)
        assert muscle_torque(PARAMETERS, there, turned, -angle) == -left
        assert there == mirrored(here)
