"""Keys move what the arms intend; released hands follow the wheel."""

from __future__ import annotations

import math

import pytest

from costeer.plant.parameters import DEFAULT_CAR
from costeer.plant.vehicle import resistance
from costeer.runtime.hands import (
    FootParameters,
    FootState,
    HandsParameters,
    HandsState,
    asked_angle,
    press,
    step,
)

DT = 1.0 / 60.0
HANDS = HandsParameters()
FOOT = FootParameters()


def held(seconds: float, asked: float, wheel: float = 0.0) -> HandsState:
    state = HandsState()
    for _ in range(round(seconds / DT)):
        state = step(HANDS, state, asked, True, wheel, DT)
    return state


def test_key_moves_the_intended_angle_with_its_time_constant() -> None:
    # First-order: after one time constant 1 - 1/e of the way, exact at any step.
    state = held(0.25, 0.2)
    assert state.intended_angle == pytest.approx(0.2 * (1 - math.exp(-1.0)))
    assert state.grip == pytest.approx(1 - math.exp(-2.5))


def test_released_hands_follow_the_wheel_wherever_the_guidance_turns_it() -> None:
    state, wheel = held(1.0, 0.2), 0.2
    for _ in range(60):
        wheel -= 0.01
        state = step(HANDS, state, 0.0, False, wheel, DT)
    assert state.intended_angle == wheel
    assert state.grip < 0.01


def test_mirrored_keys_give_mirrored_hands() -> None:
    left, right = held(0.3, 0.1, wheel=0.02), held(0.3, -0.1, wheel=-0.02)
    assert left == HandsState(-right.intended_angle, right.grip)


@pytest.mark.parametrize("speed_kmh", [50.0, 70.0, 110.0])
def test_full_key_asks_for_the_same_lateral_acceleration(speed_kmh: float) -> None:
    speed = speed_kmh / 3.6
    angle = asked_angle(HANDS, DEFAULT_CAR, speed, 1.0)
    assert asked_angle(HANDS, DEFAULT_CAR, speed, -0.5) == -0.5 * angle
    wheelbase = DEFAULT_CAR.front_distance + DEFAULT_CAR.rear_distance
    understeer = 1500.0 * (1.6 * 120e3 - 1.1 * 110e3) / (wheelbase * 110e3 * 120e3)
    road_wheel = angle / DEFAULT_CAR.steering_ratio
    curvature = road_wheel / (wheelbase + understeer * speed**2)
    assert curvature * speed**2 == pytest.approx(HANDS.lateral_acceleration)


def test_standing_car_is_not_asked_for_more_than_hands_can_hold() -> None:
    assert asked_angle(HANDS, DEFAULT_CAR, 0.0, 1.0) == HANDS.largest_angle


def test_foot_keeps_the_speed_against_the_air() -> None:
    state = FootState(kept_speed=20.0)
    _, accelerator, brake = press(FOOT, state, DEFAULT_CAR, 20.0, (0.0, 0.0))
    expected = resistance(DEFAULT_CAR, 20.0) / DEFAULT_CAR.acceleration_limit
    assert (accelerator, brake) == (pytest.approx(expected), 0.0)


def test_foot_brakes_for_a_lower_speed_and_pushes_for_a_higher_one() -> None:
    slower = press(FOOT, FootState(10.0), DEFAULT_CAR, 20.0, (0.0, 0.0))
    faster = press(FOOT, FootState(30.0), DEFAULT_CAR, 20.0, (0.0, 0.0))
    assert slower[1:] == (0.0, pytest.approx(0.5 - 0.0265, abs=0.01))
    assert faster[1:] == (1.0, 0.0)


def test_pressed_pedal_acts_as_it_is_and_its_release_keeps_the_speed() -> None:
    state, *pedals = press(FOOT, FootState(20.0), DEFAULT_CAR, 25.0, (0.4, 0.0))
    assert pedals == [0.4, 0.0]
    assert state.kept_speed == 25.0


def test_foot_that_keeps_no_speed_leaves_the_pedals_alone() -> None:
    assert press(FOOT, FootState(), DEFAULT_CAR, 25.0, (0.0, 0.01))[1:] == (0.0, 0.01)
