"""The loop with a person is the loop of the studies with the driver left out."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.base.packing import pack, packed, unpack
from costeer.controller.step import ControllerParameters
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.person import PersonInput, initial_motion
from costeer.loop.real_wheel import WheelInput
from costeer.loop.realtime import (
    NOTHING_GIVEN,
    PersonMemory,
    control_tick,
    hands_tick,
    person_memory,
    wheel_tick,
)
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import REQUEST_DURATION
from costeer.loop.trial import simulate_trial
from costeer.methods.ibhs import IBHS
from costeer.records.row import ROW_COLUMNS

SETUP = TrialSetup(
    condition="strong-normal",
    driver="hands-off",
    intention="off",
    length=400.0,
    trigger_times=(2.0,),
    events=False,
    initial_offset=0.3,
    plant_steps=16,
)
MANUAL = SETUP._replace(condition="manual", driver="virtual", trigger_times=())
PARAMETERS = loop_parameters(SETUP)
TICK = control_tick(IBHS)
Parameters: TypeAlias = LoopParameters[ControllerParameters]
OF_THE_PERSON = {"driver_intention", "head_yaw", "head_yaw_valid"}
OF_THE_FOOT = {"accelerator", "brake"}


def driven(parameters: Parameters, given: list[PersonInput]) -> NDArray[np.float64]:
    """Rows of a drive with virtual hands."""
    memory = person_memory(IBHS, parameters)
    rows = []
    for now in given:
        pack(memory.given, now)
        control(memory, has_wheel=False)
        rows.append(memory.row.copy())
        for _ in range(parameters.plant_steps):
            hands_tick(memory.plant, memory.motion, memory.held)
    return np.array(rows)


def control(memory: PersonMemory, has_wheel: bool) -> None:
    TICK(
        memory.parameters,
        memory.state,
        memory.motion,
        memory.given,
        has_wheel,
        memory.held,
        memory.row,
    )


def column(rows: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    return rows[:, ROW_COLUMNS.index(name)]


def as_given(record: dict[str, NDArray[np.float64]]) -> list[PersonInput]:
    """The pedals of a simulated trial, and its request."""
    return [
        NOTHING_GIVEN._replace(
            accelerator=accelerator,
            brake=brake,
            requested=2.0 - 0.5 * DT <= time < 2.0 - 0.5 * DT + REQUEST_DURATION,
        )
        for time, accelerator, brake in zip(
            record["time"], record["accelerator"], record["brake"], strict=True
        )
    ]


def test_without_hands_it_is_the_trial_of_the_studies_bit_for_bit() -> None:
    record = simulate_trial(SETUP).columns
    rows = driven(PARAMETERS, as_given(record))
    for name in set(ROW_COLUMNS) - OF_THE_PERSON - {"mode"}:
        there = np.ma.filled(np.ma.asarray(record[name], float), np.nan)
        np.testing.assert_array_equal(column(rows, name), there, err_msg=name)
    assert (record["mode"] == "lane_changing").any()  # the request was part of it


def test_intended_angle_to_the_left_turns_wheel_and_car_to_the_left() -> None:
    parameters = loop_parameters(MANUAL._replace(initial_offset=0.0))
    left = NOTHING_GIVEN._replace(intended_angle=0.1, grip=1.0)
    rows = driven(parameters, [left] * 60)
    mirrored = driven(parameters, [left._replace(intended_angle=-0.1)] * 60)
    assert column(rows, "steering_wheel_angle")[-1] > 0.05
    assert column(rows, "lateral_position")[-1] > 0.1
    for name in ("steering_wheel_angle", "yaw_rate", "driver_torque"):
        np.testing.assert_array_equal(column(mirrored, name), -column(rows, name))


def test_resting_hands_leave_the_wheel_to_the_guidance() -> None:
    # The system's lane change of 3.5 m in 6 s, done within 0.3 m although the resting
    # arms still weigh on the wheel.
    setup = SETUP._replace(driver="virtual", initial_offset=0.0, length=2000.0)
    given = [
        NOTHING_GIVEN._replace(accelerator=0.07, requested=120 <= k < 126)
        for k in range(660)
    ]
    rows = driven(loop_parameters(setup), given)
    assert abs(column(rows, "lateral_position")[-1] + 3.5) < 0.3


def test_driver_torque_of_resting_hands_is_only_what_moves_the_arms() -> None:
    setup = SETUP._replace(driver="virtual", initial_offset=0.5, trigger_times=())
    rows = driven(loop_parameters(setup), [NOTHING_GIVEN] * 200)
    hands = loop_parameters(setup).driver.arm
    rate = column(rows, "steering_wheel_rate")
    angle = column(rows, "steering_wheel_angle")
    mean_rate = np.diff(angle) / DT
    acceleration = np.diff(rate) / DT
    expected = -hands.damping * mean_rate - hands.inertia * acceleration
    # The same sums in another order.
    np.testing.assert_allclose(column(rows, "driver_torque")[1:], expected, atol=1e-12)


def wheel_input(angle: float, rate: float, **changed: float) -> WheelInput:
    still = WheelInput(
        steering_wheel_angle=angle,
        steering_wheel_rate=rate,
        driver_torque=0.0,
        damping=0.0,
        friction=0.0,
    )
    return still._replace(**changed)


def test_wheel_that_moves_as_the_column_would_leaves_the_same_track() -> None:
    # The angles of a drive with virtual hands, played into the loop of a real wheel.
    parameters = loop_parameters(MANUAL._replace(initial_offset=0.0))
    memory, other = person_memory(IBHS, parameters), person_memory(IBHS, parameters)
    steer = NOTHING_GIVEN._replace(intended_angle=0.1, grip=1.0)
    for _ in range(60):
        pack(memory.given, steer)
        pack(other.given, steer)
        control(memory, has_wheel=False)
        control(other, has_wheel=True)
        for _ in range(16):
            hands_tick(memory.plant, memory.motion, memory.held)
            moved = unpack(initial_motion(parameters), memory.motion)
            wheel = moved.plant.world.column
            pack(
                other.wheel,
                wheel_input(wheel.steering_wheel_angle, wheel.steering_wheel_rate),
            )
            wheel_tick(other.plant, other.motion, other.held, other.wheel)
    np.testing.assert_array_equal(
        column(memory.row[None], "lateral_position"),
        column(other.row[None], "lateral_position"),
    )


@pytest.mark.parametrize("angle", [-0.02, 0.0, 0.03])
def test_wheel_at_rest_is_pulled_by_the_columns_stiffness(angle: float) -> None:
    # Straight ahead with the wheel turned: after one plant step the car has hardly
    # turned, so the tyres' torque is that of the slip angle -angle / ratio.
    memory = person_memory(IBHS, PARAMETERS)
    car, stiffness = PARAMETERS.car, PARAMETERS.column.stiffness
    torque = np.nan
    for _ in range(2):
        pack(memory.wheel, wheel_input(angle, 0.0))
        torque = wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)
    tyres = -car.aligning_stiffness * angle / car.steering_ratio
    # Within 4 %: the brush tyre gives a little less than its stiffness times slip.
    expected = tyres - stiffness * angle
    assert torque == pytest.approx(expected, rel=0.04, abs=1e-6)


def test_device_with_damping_of_its_own_is_given_that_much_less() -> None:
    memory = person_memory(IBHS, PARAMETERS)
    torques = []
    for damping in (0.0, 0.5, PARAMETERS.column.damping, 9.0):
        pack(memory.wheel, wheel_input(0.0, 1.0, damping=damping, friction=9.0))
        torques.append(
            wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)
        )
    assert torques[1] - torques[0] == pytest.approx(0.5, abs=0.01)
    # More damping than the column's cannot be taken away.
    assert torques[3] == pytest.approx(torques[2], abs=0.01)


def test_torque_of_a_real_wheel_is_its_mean_over_the_control_step() -> None:
    memory = person_memory(IBHS, PARAMETERS)
    control(memory, has_wheel=True)
    for k in range(16):
        pack(memory.wheel, wheel_input(0.0, 0.0, driver_torque=float(k)))
        wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)
    control(memory, has_wheel=True)
    assert column(memory.row[None], "driver_torque")[0] == pytest.approx(7.5)


def test_lost_torque_sensor_leaves_no_guidance() -> None:
    memory = person_memory(IBHS, PARAMETERS)
    for _ in range(60):
        control(memory, has_wheel=True)
        for _ in range(16):
            pack(memory.wheel, wheel_input(0.0, 0.0, driver_torque=math.nan))
            wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)
    assert abs(column(memory.row[None], "applied_torque")[0]) < 1e-12


def test_compiled_and_plain_ticks_agree() -> None:
    here, there = person_memory(IBHS, PARAMETERS), person_memory(IBHS, PARAMETERS)
    for k in range(40):
        given = NOTHING_GIVEN._replace(intended_angle=0.01 * k, grip=1.0)
        for memory, engine in ((here, "compiled"), (there, "plain")):
            plain = engine == "plain"
            tick = TICK.py_func if plain else TICK  # type: ignore[attr-defined]  # Numba adds it
            move = hands_tick.py_func if plain else hands_tick  # type: ignore[attr-defined]  # Numba adds it
            pack(memory.given, given)
            tick(
                memory.parameters,
                memory.state,
                memory.motion,
                memory.given,
                False,
                memory.held,
                memory.row,
            )
            for _ in range(16):
                move(memory.plant, memory.motion, memory.held)
    np.testing.assert_allclose(here.row, there.row, 1e-12, 1e-14)
    np.testing.assert_allclose(here.state, there.state, 1e-12, 1e-14)


def test_leader_appears_and_its_zone_ends_when_the_car_has_settled_again() -> None:
    setup = SETUP._replace(events=True, length=8000.0, trigger_times=())
    parameters = loop_parameters(setup)
    # Nobody steers, and a car without width passes through its leader.
    early = parameters._replace(
        traffic=parameters.traffic._replace(first_event=50.0, num_events=1.0),
        car=parameters.car._replace(width=0.0),
    )
    given = NOTHING_GIVEN._replace(accelerator=0.6, leader_uniform=0.99)
    rows = driven(early, [given] * 1500)
    event = column(rows, "event")
    passed = column(rows, "lead_distance") < 0.0
    assert event.max() == 1.0
    assert passed.any()
    assert event[-1] == 0.0


def test_packed_memory_holds_the_parameters_in_order() -> None:
    np.testing.assert_array_equal(
        person_memory(IBHS, PARAMETERS).parameters, packed(PARAMETERS)
    )
