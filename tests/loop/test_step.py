"""One control step of the closed loop: who sees what when."""

from __future__ import annotations

import math

import pytest

from costeer.drivers.driver import DriverNoise
from costeer.drivers.population import hands_off
from costeer.loop.rollout import REQUEST_DURATION, requested, scripted_probability
from costeer.loop.step import (
    DT,
    LoopParameters,
    LoopState,
    StartParameters,
    initial_state,
    planned_to_cross,
    sense,
    step,
)
from costeer.plant.parameters import ColumnParameters

QUIET = DriverNoise(*([0.0] * len(DriverNoise._fields)))._replace(
    look_uniform=1.0, glance_uniform=1.0, leader_uniform=-1.0
)
SPEED = 20.0


def hands_off_loop(offset: float = 0.0, steps: int = 8) -> LoopParameters:
    return LoopParameters(
        driver=hands_off(SPEED),
        start=StartParameters(speed=SPEED, lateral_offset=offset),
        plant_steps=steps,
    )


def run(parameters: LoopParameters, num_steps: int) -> list[LoopState]:
    """States after each step, nobody at the wheel, no noise."""
    state, states = initial_state(parameters), []
    for _ in range(num_steps):
        measurement = sense(parameters, state, QUIET)
        state, _ = step(parameters, state, measurement, math.nan, False, QUIET)
        states.append(state)
    return states


def test_a_car_in_the_middle_of_its_lane_stays_there() -> None:
    last = run(hands_off_loop(), 120)[-1]
    assert last.world.vehicle.lateral_position == 0.0
    assert last.world.column.steering_wheel_angle == 0.0
    # The foot holds the speed against the losses: the pedal answers with its lag.
    assert last.world.vehicle.longitudinal_velocity == pytest.approx(SPEED, abs=0.01)


def test_a_torque_acts_one_control_step_after_its_measurement() -> None:
    first, second, *_ = run(hands_off_loop(offset=0.5), 3)
    assert first.torque_command < 0.0  # computed from the first sample
    assert first.world.column.motor_torque == 0.0  # and not yet given
    # From rest, the motor's lag lets through this much of it in one control step.
    share = 1.0 - math.exp(-DT / ColumnParameters().motor_lag)
    given = second.world.column.motor_torque
    assert given == pytest.approx(share * first.torque_command, rel=1e-9)


def test_finer_plant_steps_change_a_run_little() -> None:
    coarse, fine = (run(hands_off_loop(0.5, n), 120)[-1] for n in (8, 64))
    here, there = (s.world.vehicle.lateral_position for s in (coarse, fine))
    # The implicit column is of first order: 1/480 s against 25 ms of its own.
    assert here == pytest.approx(there, abs=2e-3)
    assert here != there


def test_the_trial_starts_in_the_cruising_lane_of_its_side() -> None:
    left = hands_off_loop()
    right = left._replace(road=left.road._replace(overtaking_side=1.0))
    assert initial_state(left).world.vehicle.lateral_position == 0.0
    assert initial_state(right).world.vehicle.lateral_position == -3.5


def test_a_request_lasts_a_tenth_of_a_second() -> None:
    times = [k * DT for k in range(120) if requested((1.0,), k * DT)]
    assert times[0] == pytest.approx(1.0)
    assert len(times) * DT == pytest.approx(REQUEST_DURATION)


def test_a_plan_counts_while_its_crossing_lies_ahead_within_the_horizon() -> None:
    assert [planned_to_cross(t, 3.0) for t in (3.1, 3.0, 0.1)] == [False, True, True]
    assert not planned_to_cross(0.0, 3.0)
    assert not planned_to_cross(-1.0, 3.0)


def test_a_driver_without_a_plan_is_no_positive() -> None:
    assert scripted_probability(initial_state(hands_off_loop()), 3.0) == 0.0
