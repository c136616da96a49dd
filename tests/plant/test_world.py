"""Car and column together: order of the step, convergence, rest, mirror."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.plant import world
from costeer.plant.parameters import DEFAULT_CAR, ColumnParameters
from costeer.plant.vehicle import VehicleState
from costeer.plant.world import Inputs, WorldState

SPEED = 70.0 / 3.6
COLUMN = ColumnParameters()
START = world.initial_state(DEFAULT_CAR, 0.0, SPEED)
HOLDING_SPEED = START.vehicle.drive


def moved(
    num_steps: int, inputs: Inputs, column: ColumnParameters = COLUMN
) -> WorldState:
    """The world after one second in equal steps."""
    state = START
    for _ in range(num_steps):
        state = world.step(DEFAULT_CAR, column, state, inputs, 1.0 / num_steps)
    return state


def test_hands_off_and_straight_ahead_nothing_turns() -> None:
    state = moved(480, Inputs(0.0, 0.0, HOLDING_SPEED))
    assert state.column == (0.0, 0.0, 0.0)
    assert state.vehicle.lateral_position == 0.0
    assert state.vehicle.longitudinal_velocity == pytest.approx(SPEED, rel=1e-14)


def test_a_torque_to_the_left_turns_wheel_and_car_left_and_tyres_pull_back() -> None:
    state = moved(480, Inputs(1.0, 0.0, HOLDING_SPEED))
    assert state.column.steering_wheel_angle > 0.0
    assert state.vehicle.yaw_rate > 0.0
    assert state.vehicle.lateral_position > 0.0
    loose = DEFAULT_CAR._replace(aligning_stiffness=0.0)
    free = START
    for _ in range(480):
        free = world.step(
            loose, COLUMN, free, Inputs(1.0, 0.0, HOLDING_SPEED), 1.0 / 480.0
        )
    wheel = state.column.steering_wheel_angle
    assert wheel < 0.5 * free.column.steering_wheel_angle


def test_a_motor_torque_does_what_the_hands_would_but_later() -> None:
    by_hand = moved(480, Inputs(1.0, 0.0, HOLDING_SPEED)).column
    by_motor = moved(480, Inputs(0.0, 1.0, HOLDING_SPEED)).column
    fast = COLUMN._replace(motor_lag=1e-6)
    without_lag = moved(480, Inputs(0.0, 1.0, HOLDING_SPEED), fast).column
    assert by_motor.steering_wheel_angle < by_hand.steering_wheel_angle
    assert without_lag.steering_wheel_angle == by_hand.steering_wheel_angle


def test_a_mirrored_torque_gives_the_mirrored_world() -> None:
    left = moved(100, Inputs(1.5, 0.5, HOLDING_SPEED))
    right = moved(100, Inputs(-1.5, -0.5, HOLDING_SPEED))
    assert right.column == tuple(-value for value in left.column)
    for name in VehicleState._fields:
        sign = 1.0 if name.startswith("longitudinal") or name == "drive" else -1.0
        assert getattr(right.vehicle, name) == sign * getattr(left.vehicle, name)


def test_half_the_step_halves_the_error_of_the_world() -> None:
    inputs = Inputs(1.0, 0.5, HOLDING_SPEED)
    reference = moved(7_680, inputs).vehicle.lateral_position
    errors = [
        abs(moved(num_steps, inputs).vehicle.lateral_position - reference)
        for num_steps in (240, 480)
    ]
    # The implicit column is of first order; at 480 Hz the car is 1 mm off in a
    # second of firm steering.
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
    assert errors[1] < 1e-3


def test_a_batch_gives_what_its_members_give() -> None:
    torques = np.array([-2.0, 0.1, 0.4, 3.0])
    batch = moved(60, Inputs(torques, 0.0, HOLDING_SPEED))
    for k, torque in enumerate(torques.tolist()):
        member = moved(60, Inputs(torque, 0.0, HOLDING_SPEED))
        # NumPy's sine may differ in the last place; 60 steps add that up.
        assert batch.column.steering_wheel_angle[k] == pytest.approx(
            member.column.steering_wheel_angle, rel=1e-12
        )
        assert batch.vehicle.yaw_rate[k] == pytest.approx(
            member.vehicle.yaw_rate, rel=1e-12
        )
