"""What relaxed arms give is no will; what they do not explain is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller import consistency, hands
from costeer.controller.consistency import ConsistencyParameters, pushes
from costeer.controller.hands import HandsParameters
from tests.controller.samples import DT, sample

ARMS = HandsParameters(inertia=0.1, damping=0.8)
TIME = np.arange(60) * DT


def own_torques(angle: np.ndarray, rate: np.ndarray, torque: np.ndarray) -> list[float]:
    """What the hands do themselves while the wheel moves so."""
    state, found = hands.initial_state(), []
    for theta, omega, tau in zip(angle, rate, torque, strict=True):
        measured = sample(
            steering_wheel_angle=theta, steering_wheel_rate=omega, driver_torque=tau
        )
        state, own = hands.step(ARMS, state, measured, DT)
        found.append(float(own))
    return found


@given(push=st.floats(-5.0, 5.0), frequency=st.floats(0.1, 12.0))
def test_of_arms_that_are_carried_along_only_the_push_is_left(
    push: float, frequency: float
) -> None:
    # The wheel swings; mean rate and mean acceleration of a step are differences.
    angle = 0.3 * np.sin(frequency * TIME)
    rate = 0.3 * frequency * np.cos(frequency * TIME)
    carried = -(0.1 * np.diff(rate) + 0.8 * np.diff(angle)) / DT
    torque = push + np.append(0.0, carried)
    assert own_torques(angle, rate, torque) == pytest.approx([push] * 60, abs=1e-9)


def test_on_a_wheel_at_rest_all_torque_is_the_drivers() -> None:
    still = np.zeros(3)
    assert own_torques(still, still, np.array([1.0, -0.2, 0.0])) == [1.0, -0.2, 0.0]


def test_after_a_lost_sample_all_torque_counts() -> None:
    angle = np.array([0.0, math.nan, 0.2, 0.3])
    found = own_torques(angle, np.full(4, 6.0), np.full(4, -1.0))
    assert found[1:3] == [-1.0, -1.0]
    assert found[3] == pytest.approx(-1.0 + 0.8 * 0.1 / DT)


@pytest.mark.parametrize(
    ("torque", "own", "pushing"),
    [
        (0.1, 0.1, True),
        (-0.1, -5.0, True),
        (0.09, 5.0, False),
        (5.0, 0.09, False),
        (-5.0, -0.09, False),
        (0.0, 0.0, False),
    ],
)
def test_who_pushes_gives_the_threshold_and_means_it(
    torque: float, own: float, pushing: bool
) -> None:
    assert pushes(ConsistencyParameters(), torque, own) is pushing
    assert pushes(ConsistencyParameters(hands_on_threshold=0.0), torque, own)


@pytest.mark.parametrize(
    ("torque", "own", "consistent"),
    [(-1.0, -1.0, False), (-0.05, -1.0, True), (-1.0, 0.05, True)],
)
def test_nobody_disagrees_without_pushing(
    torque: float, own: float, consistent: bool
) -> None:
    state = consistency.initial_state()
    for _ in range(60):
        state, verdict = consistency.step(
            ConsistencyParameters(), state, 3.0, torque, 0.5, DT, own
        )
    assert verdict.consistent == consistent
