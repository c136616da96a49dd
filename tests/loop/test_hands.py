"""Torque between hands and wheel: momentum over a control step, and none without."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverNoise
from costeer.drivers.population import hands_off, participant_driver
from costeer.loop import step as loop
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters, StartParameters
from costeer.loop.rows import rules_of
from costeer.loop.step import LoopState
from costeer.methods.ibhs import IBHS
from costeer.plant import world
from costeer.plant.parameters import CarParameters, ColumnParameters
from costeer.plant.steering import aligning_torque
from costeer.plant.vehicle import VehicleInput, front_lateral_force
from costeer.plant.world import Inputs, WorldState

SMOOTH = ColumnParameters(friction=0.0)
SPEED = 20.0
RULES = rules_of(IBHS)


class Moment(NamedTuple):
    """One plant step as the simulation made it."""

    before: WorldState
    inputs: Inputs
    after: WorldState
    dt: float


class Run(NamedTuple):
    """States of a run, and the plant steps between each two."""

    states: list[LoopState[ControllerState]]
    moments: list[list[Moment]]


def run(
    parameters: LoopParameters[ControllerParameters],
    num_steps: int,
    monkeypatch: pytest.MonkeyPatch,
) -> Run:
    """Drive with noise against a change asked for after 1 s; listen to the plant."""
    heard: list[Moment] = []
    move = world.step

    def listening(
        car: CarParameters,
        column: ColumnParameters,
        state: WorldState,
        inputs: Inputs,
        dt: float,
    ) -> WorldState:
        after = move(car, column, state, inputs, dt)
        heard.append(Moment(state, inputs, after, dt))
        return after

    monkeypatch.setattr(world, "step", listening)
    state = loop.initial_state(RULES, parameters)
    states, moments = [state], []
    for k, draws in enumerate(driver_noise(900_001, 3, "pilot", num_steps)):
        noise = DriverNoise(*draws.tolist())
        measurement = loop.sense(parameters, state)
        asked = Request(requested=60 <= k < 66)
        state, _ = loop.step(RULES, parameters, state, measurement, asked, noise)
        states.append(state)
        moments.append(list(heard))
        heard.clear()
    return Run(states, moments)


def torque_on_the_column(column: ColumnParameters, moments: list[Moment]) -> float:
    """Mean torque that hands must have given, from the bare column's motion [N·m].

    Inertia times acceleration, less motor and tyres, plus spring and damper, of which
    the column's step takes the end of each plant step.
    """
    car = CarParameters()
    impulse = 0.0
    for moment in moments:
        old, new = moment.before.column, moment.after.column
        motion = VehicleInput(car, old.steering_wheel_angle / car.steering_ratio, 0.0)
        force = front_lateral_force(moment.before.vehicle, motion)
        others = new.motor_torque + aligning_torque(car, force)
        spring = column.stiffness * new.steering_wheel_angle
        damper = column.damping * new.steering_wheel_rate
        momentum = column.inertia * (new.steering_wheel_rate - old.steering_wheel_rate)
        impulse += momentum - moment.dt * (others - spring - damper)
    return impulse / DT


def wild(
    column: ColumnParameters, steps: int = 8
) -> LoopParameters[ControllerParameters]:
    """A driver half a metre beside the lane, strong guidance against the arms."""
    return LoopParameters(
        controller=ControllerParameters(),
        column=column,
        driver=participant_driver(900_001, 3, SPEED),
        start=StartParameters(speed=SPEED, lateral_offset=0.5),
        plant_steps=steps,
    )


def balances(
    column: ColumnParameters, found: Run
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Hand torque that the column felt, and that the driver reports [N·m]."""
    felt = [torque_on_the_column(column, moments) for moments in found.moments]
    told = [state.arm.torque for state in found.states[1:]]
    return np.array(felt), np.array(told)


@pytest.mark.parametrize("steps", [1, 8, pytest.param(16, marks=pytest.mark.slow)])
def test_hands_give_the_column_its_momentum(
    steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without dry friction the balance is exact: rounding of torques of some N·m that
    # are differences over 1/960 s of rates of some rad/s.
    found = run(wild(SMOOTH, steps), 240, monkeypatch)
    felt, told = balances(SMOOTH, found)
    assert np.abs(felt).max() > 1.0
    assert max(state.driver.reliance.stiffening for state in found.states) > 1.5
    np.testing.assert_allclose(told, felt, rtol=0.0, atol=1e-10)


def test_dry_friction_makes_up_the_difference_and_no_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    column = ColumnParameters(friction=0.25)
    felt, told = balances(column, run(wild(column), 240, monkeypatch))
    brake = told - felt
    assert np.abs(brake).max() <= 0.25 + 1e-10
    assert np.abs(brake).max() > 0.2


def test_the_recorded_torque_is_that_of_the_step_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parameters = wild(SMOOTH)
    found = run(parameters, 60, monkeypatch)
    felt, _ = balances(SMOOTH, found)
    recorded = [loop.sense(parameters, s).driver_torque for s in found.states]
    assert recorded[0] == 0.0
    np.testing.assert_allclose(recorded[1:], felt, rtol=0.0, atol=1e-10)


def test_the_balance_would_show_arms_of_another_inertia(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heavier = SMOOTH._replace(inertia=SMOOTH.inertia + 1e-3)
    felt, told = balances(heavier, run(wild(SMOOTH), 60, monkeypatch))
    assert np.abs(told - felt).max() > 1e-4


def test_without_hands_no_torque_and_the_columns_own_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parameters = wild(ColumnParameters())._replace(driver=hands_off(SPEED))
    found = run(parameters, 120, monkeypatch)
    assert {state.arm.torque for state in found.states} == {0.0}
    assert {m.inputs.driver_torque for ms in found.moments for m in ms} == {0.0}
    for alone, moments, after in zip(
        found.states, found.moments, found.states[1:], strict=False
    ):
        moved = alone.world
        for moment in moments:
            moved = world.step(
                parameters.car, parameters.column, moved, moment.inputs, moment.dt
            )
        assert moved == after.world


def test_held_and_free_wheels_move_differently(monkeypatch: pytest.MonkeyPatch) -> None:
    # What the arms weigh shows: the same torque turns a held wheel more slowly.
    limp = DriverParameters()
    limp = limp._replace(
        arm=limp.arm._replace(stiffness=0.0, holding_gain=0.0),
        reliance=limp.reliance._replace(reliance=0.0),
    )
    held = run(wild(SMOOTH)._replace(driver=limp), 12, monkeypatch)
    free = run(wild(SMOOTH)._replace(driver=hands_off(SPEED)), 12, monkeypatch)
    turned = [
        abs(found.states[-1].world.column.steering_wheel_angle)
        for found in (held, free)
    ]
    assert 0.0 < turned[0] < 0.8 * turned[1]
