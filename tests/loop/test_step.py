"""One control step of the closed loop: who sees what when."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import pytest

from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.drivers.decision import (
    CHANGING,
    PREPARING,
    DecisionState,
    time_to_crossing,
)
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverNoise, Plan
from costeer.drivers.population import hands_off
from costeer.loop.half_step import Sample
from costeer.loop.parameters import DT, LoopParameters, StartParameters
from costeer.loop.rows import rules_of
from costeer.loop.step import LoopState, initial_state, planned_to_cross, sense, step
from costeer.loop.tick import REQUEST_DURATION, requested, scripted_probability
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import ColumnParameters

QUIET = DriverNoise(*([0.0] * len(DriverNoise._fields)))._replace(
    look_uniform=1.0, glance_uniform=1.0, leader_uniform=-1.0, tracker_uniform=0.9
)
SPEED = 20.0
RULES = rules_of(IBHS)
Parameters: TypeAlias = LoopParameters[ControllerParameters]
State: TypeAlias = LoopState[ControllerState]


def hands_off_loop(offset: float = 0.0, steps: int = 8) -> Parameters:
    return LoopParameters(
        controller=ControllerParameters(),
        driver=hands_off(SPEED),
        start=StartParameters(speed=SPEED, lateral_offset=offset),
        plant_steps=steps,
    )


PARAMETERS = hands_off_loop()


def after(
    parameters: Parameters, state: State, noise: DriverNoise = QUIET
) -> tuple[State, Sample[ControllerState]]:
    """One step later, nothing asked of the method."""
    measurement = sense(parameters, state)
    return step(RULES, parameters, state, measurement, Request(), noise)


def run(parameters: Parameters, num_steps: int) -> list[State]:
    """States after each step, nobody at the wheel, no noise."""
    state, states = initial_state(RULES, parameters), []
    for _ in range(num_steps):
        state, _ = after(parameters, state)
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
    assert first.control.torque_command < 0.0  # computed from the first sample
    assert first.world.column.motor_torque == 0.0  # and not yet given
    # From rest, the motor's lag lets through this much of it in one control step.
    share = 1.0 - math.exp(-DT / ColumnParameters().motor_lag)
    given = second.world.column.motor_torque
    assert given == pytest.approx(share * first.control.torque_command, rel=1e-9)


def test_finer_plant_steps_change_a_run_little() -> None:
    coarse, fine = (run(hands_off_loop(0.5, n), 120)[-1] for n in (8, 24))
    here, there = (s.world.vehicle.lateral_position for s in (coarse, fine))
    # The implicit column is of first order: 1/480 s against 25 ms of its own.
    assert here == pytest.approx(there, abs=2e-3)
    assert here != there


def test_the_trial_starts_in_the_cruising_lane_of_its_side() -> None:
    left = hands_off_loop()
    right = left._replace(road=left.road._replace(overtaking_side=1.0))
    assert initial_state(RULES, left).world.vehicle.lateral_position == 0.0
    assert initial_state(RULES, right).world.vehicle.lateral_position == -3.5


def test_a_request_lasts_a_tenth_of_a_second() -> None:
    times = [k * DT for k in range(120) if requested((1.0,), k * DT)]
    assert times[0] == pytest.approx(1.0)
    assert len(times) * DT == pytest.approx(REQUEST_DURATION)


def test_a_plan_counts_while_its_crossing_lies_ahead_within_the_horizon() -> None:
    assert [planned_to_cross(t, 3.0) for t in (3.1, 3.0, 0.1)] == [False, True, True]
    assert not planned_to_cross(0.0, 3.0)
    assert not planned_to_cross(-1.0, 3.0)


def test_a_verdict_comes_the_horizon_or_half_the_change_before_the_crossing() -> None:
    state = initial_state(RULES, PARAMETERS)
    decided = state.driver.decision._replace(
        phase=PREPARING, preparation_time=9.0, change_duration=8.0
    )

    def planning(decided: DecisionState) -> LoopState[ControllerState]:
        plan = Plan(decided.change_duration, time_to_crossing(decided))
        return state._replace(plan=plan)

    def verdicts(parameters: Parameters) -> list[float]:
        """When the verdict is positive before the crossing, 13 s after the decision."""
        times = np.arange(0.0, 9.0, 0.1)
        states = [
            planning(decided._replace(time_in_phase=time)) for time in times.tolist()
        ]
        given = [scripted_probability(parameters, one, 5.0) for one in states]
        return [13.0 - t for t, p in zip(times.tolist(), given, strict=True) if p > 0.5]

    assert max(verdicts(PARAMETERS)) == pytest.approx(5.0, abs=0.101)
    follower = PARAMETERS._replace(follows_plan=1.0)
    assert verdicts(follower) == []  # a change of 8 s begins 4 s before the crossing
    steering = planning(decided._replace(phase=CHANGING, time_in_phase=0.0))
    assert scripted_probability(follower, steering, 5.0) == 1.0


def test_the_tracker_sees_the_head_of_the_step_before() -> None:
    turned = hands_off_loop()._replace(driver=DriverParameters())
    state = initial_state(RULES, turned)
    head = state.driver.gaze._replace(
        glancing=True, time_in_glance=0.5, side=1.0, amplitude=0.4
    )
    state = state._replace(driver=state.driver._replace(gaze=head))
    assert sense(turned, state).head_yaw == 0.0
    moved, _ = after(turned, state)
    assert sense(turned, moved).head_yaw == pytest.approx(0.4)
    assert sense(turned, moved).head_yaw_valid


def test_a_lost_face_is_not_valid_in_the_measurement() -> None:
    lost = QUIET._replace(tracker_uniform=0.0)  # below any rate times the step
    state = initial_state(RULES, PARAMETERS)
    moved, sample = after(PARAMETERS, state, lost)
    assert sample.measurement.head_yaw_valid
    assert not sense(PARAMETERS, moved).head_yaw_valid


def test_a_driver_without_a_plan_is_no_positive() -> None:
    assert (
        scripted_probability(PARAMETERS, initial_state(RULES, PARAMETERS), 3.0) == 0.0
    )
