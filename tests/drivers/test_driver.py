"""The whole driver: eyes, decision, head, foot and hands in one step."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.base.bezier import path_point
from costeer.drivers import driver
from costeer.drivers.decision import CHANGING, CRUISING, PREPARING
from costeer.drivers.driver import DriverParameters, DriverState
from costeer.drivers.interface import Action, DriverNoise, Knowledge, Perception
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.traffic import LeaderState
from tests.drivers.samples import DT, NO_LEADER, RIGHT, SPEED, driving, leader

PARAMETERS = DriverParameters()
KNOWLEDGE = Knowledge(CarParameters(), ColumnParameters(), RoadParameters())
QUIET = DriverNoise(*([0.0] * len(DriverNoise._fields)))._replace(
    look_uniform=0.5, glance_uniform=1.0, glance_side_uniform=0.5
)


def act(
    state: DriverState | None = None,
    lateral_position: float = 0.0,
    guidance: float = 0.0,
    ahead: LeaderState = NO_LEADER,
    position: float = 0.0,
) -> tuple[DriverState, Action]:
    """One step of the median driver without noise."""
    perception = Perception(driving(position, lateral_position), ahead, guidance)
    before = state or driver.initial_state(PARAMETERS, 0.0)
    return driver.act(PARAMETERS, before, KNOWLEDGE, perception, QUIET, DT)


def test_a_driver_where_the_car_should_be_does_nothing() -> None:
    state, action = act()
    assert action.arm.intended_angle == 0.0
    assert action.intention == 0.0 == action.head_yaw
    assert state.reliance.stiffening == 1.0
    assert action.pedals.accelerator > 0.0  # holds the speed against the losses


def intended_after(seconds: float, lateral_position: float) -> float:
    """Angle that a driver beside the aim comes to intend [rad]."""
    state, action = act(lateral_position=lateral_position)
    for _ in range(round(seconds / DT) - 1):
        state, action = act(state, lateral_position)
    return action.arm.intended_angle


def test_a_driver_left_of_the_aim_steers_right_once_that_is_noticed() -> None:
    assert abs(intended_after(0.1, 0.5)) < 1e-3
    for seconds in (1.0, 1.5):
        assert intended_after(seconds, 0.5) < -0.05
        assert intended_after(seconds, -0.5) > 0.05


def test_a_decision_shows_in_intention_and_head_before_the_wheel() -> None:
    state, action = act(ahead=leader(25.0, SPEED - 3.0))
    assert state.decision.phase == PREPARING
    assert action.intention == -1.0
    assert action.arm.intended_angle == 0.0
    for _ in range(20):
        state, action = act(state, ahead=leader(25.0, SPEED - 3.0))
    assert action.head_yaw < -0.2


def test_steering_starts_a_path_to_the_overtaking_lane() -> None:
    state, _ = act(ahead=leader(25.0, SPEED - 3.0))
    for _ in range(round(2.0 / DT)):
        state, _ = act(state, ahead=leader(25.0, SPEED - 3.0))
    assert state.decision.phase == CHANGING
    end = path_point(state.tracking.path, 7.3 * SPEED)
    assert end.lateral_position == pytest.approx(-3.5)


def test_the_wish_to_be_faster_makes_a_leader_worth_overtaking() -> None:
    # 0.9 m/s slower is not worth it, 1.1 m/s is: the wander of the wanted speed counts.
    close = leader(25.0, SPEED - 0.9)
    at_rest = driver.initial_state(PARAMETERS, 0.0)
    hurried = at_rest._replace(
        longitudinal=at_rest.longitudinal._replace(speed_wander=0.2)
    )
    assert act(at_rest, ahead=close)[0].decision.phase == CRUISING
    assert act(hurried, ahead=close)[0].decision.phase == PREPARING


def test_a_driver_speeds_up_from_the_decision_on() -> None:
    # The leader in the other lane is far from where it would slow anybody down.
    deciding = driver.initial_state(PARAMETERS, 0.0)
    far = leader(300.0, SPEED - 3.0)
    cruising, preparing = (
        deciding._replace(
            decision=deciding.decision._replace(phase=phase, preparation_time=9.0)
        )
        for phase in (CRUISING, PREPARING)
    )
    slow, fast = (
        act(state, ahead=far)[0].longitudinal.wanted_acceleration
        for state in (cruising, preparing)
    )
    assert fast > 0.0 >= slow


def test_guidance_reaches_the_arms_with_the_lag_of_feeling() -> None:
    state, action = act(guidance=1.0)
    assert 0.0 < action.arm.guidance < 0.3
    for _ in range(60):
        state, action = act(state, guidance=1.0)
    # One second is ten time constants of feeling.
    assert action.arm.guidance == pytest.approx(1.0, abs=1e-4)


def test_guidance_against_the_intended_angle_makes_the_arms_tense() -> None:
    state = driver.initial_state(PARAMETERS, 0.0)
    for _ in range(60):  # left of the aim, pushed further left
        state, action = act(state, lateral_position=0.5, guidance=2.0)
    # A practice of 300 s takes 0.3 (1 - exp(-300 / 180)) off the 1.2 beyond relaxed.
    assert action.arm.stiffening == pytest.approx(1.91, abs=0.03)
    for _ in range(60):  # now pushed the way that is wanted
        state, action = act(state, lateral_position=0.5, guidance=-2.0)
    assert action.arm.stiffening < 1.1


def signed(action: Action) -> list[float]:
    """What has a side: wheel, felt guidance, head and intention."""
    arm = action.arm
    return [arm.intended_angle, arm.guidance, action.head_yaw, action.intention]


def test_a_mirrored_world_gets_the_mirrored_action() -> None:
    # Right-hand traffic: lanes change places, positions mirror at the line between.
    here, there = (
        driver.initial_state(PARAMETERS, 0.0),
        driver.initial_state(PARAMETERS, -3.5),
    )
    right_hand = KNOWLEDGE._replace(road=RoadParameters(overtaking_side=1.0))
    noise = QUIET._replace(near=0.3, motor=-1.1, wander=0.7, head_drift=0.9)
    sides = ("near", "motor", "wander", "head_drift")
    opposite = noise._replace(**{name: -getattr(noise, name) for name in sides})
    seen = set()
    for k in range(round(4.0 / DT)):
        place = k * SPEED * DT
        mine = Perception(driving(place, 0.3), leader(place + 25.0, 16.0), 1.0)
        other = Perception(
            driving(place, -3.8, lane=RIGHT), leader(place + 25.0, 16.0, RIGHT), -1.0
        )
        here, left = driver.act(PARAMETERS, here, KNOWLEDGE, mine, noise, DT)
        there, right = driver.act(PARAMETERS, there, right_hand, other, opposite, DT)
        # Positions near 0 and near -3.5 m are rounded differently.
        np.testing.assert_allclose(signed(right), -np.array(signed(left)), atol=1e-12)
        assert right.pedals == left.pedals
        assert right.arm.stiffening == pytest.approx(left.arm.stiffening)
        seen.add(here.decision.phase)
    assert seen == {PREPARING, CHANGING}
