"""The whole driver: eyes, decision, head, foot and hands in one step."""

from __future__ import annotations

import pytest

from costeer.base.bezier import path_point
from costeer.drivers import driver
from costeer.drivers.decision import CHANGING, PREPARING
from costeer.drivers.driver import (
    Action,
    DriverNoise,
    DriverParameters,
    DriverState,
    Knowledge,
    Perception,
)
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.traffic import LeaderState
from tests.drivers.samples import DT, NO_LEADER, SPEED, driving, leader

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
    before = state or driver.initial_state(0.0)
    return driver.act(PARAMETERS, before, KNOWLEDGE, perception, QUIET, DT)


def test_a_driver_where_the_car_should_be_does_nothing() -> None:
    state, action = act()
    assert action.arm.intended_angle == 0.0
    assert action.intention == 0.0 == action.head_yaw
    assert state.reliance.stiffening == 1.0
    assert action.pedals.accelerator > 0.0  # holds the speed against the losses


def test_a_driver_left_of_the_aim_steers_right() -> None:
    assert act(lateral_position=0.5)[1].arm.intended_angle < 0.0
    assert act(lateral_position=-0.5)[1].arm.intended_angle > 0.0


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
    for _ in range(round(2.1 / DT)):
        state, _ = act(state, ahead=leader(25.0, SPEED - 3.0))
    assert state.decision.phase == CHANGING
    end = path_point(state.tracking.path, 7.0 * SPEED)
    assert end.lateral_position == pytest.approx(-3.5)


def test_guidance_reaches_the_arms_with_the_lag_of_feeling() -> None:
    state, action = act(guidance=1.0)
    assert 0.0 < action.arm.guidance < 0.3
    for _ in range(60):
        state, action = act(state, guidance=1.0)
    # One second is ten time constants of feeling.
    assert action.arm.guidance == pytest.approx(1.0, abs=1e-4)


def test_guidance_against_the_intended_angle_makes_the_arms_tense() -> None:
    state = driver.initial_state(0.0)
    for _ in range(60):  # left of the aim, pushed further left
        state, action = act(state, lateral_position=0.5, guidance=2.0)
    assert action.arm.stiffening > 2.0
    for _ in range(60):  # now pushed the way that is wanted
        state, action = act(state, lateral_position=0.5, guidance=-2.0)
    assert action.arm.stiffening < 1.1
