"""The filter's equations are those of the simulated driver."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.drivers import arm, tracking, vision
from costeer.drivers.arm import ArmCommand, ArmState
from costeer.drivers.driver import DriverParameters
from costeer.drivers.vision import VisionNoise
from costeer.identification.kernel import (
    MOTOR_NOISE,
    NEAR_NOISE,
    WANDER,
    innovations,
)
from costeer.identification.likelihood import shown_share
from costeer.identification.model import (
    filter_inputs,
    filter_parameters,
    start,
    wheel_motion,
)
from costeer.identification.signals import (
    PLANT_STEPS,
    Drive,
    angles_between,
    sliding_share,
)
from costeer.plant.parameters import CARS, ColumnParameters, holding_stiffness
from costeer.plant.steering import steering_wheel_rate
from tests.identification.driving import true_driver

DT = 1.0 / 60.0
CAR, COLUMN = CARS["default"], ColumnParameters()


def smooth(seed: int, size: float, num_samples: int = 240) -> np.ndarray:
    """A signal that starts at rest: two sines that fade in."""
    time = DT * np.arange(num_samples)
    rng = np.random.default_rng(seed)
    waves = [np.sin(f * time + p) for f, p in rng.uniform(0.5, 4.0, (2, 2))]
    return size * (1.0 - np.exp(-(time**2))) * np.sum(waves, axis=0)


def made_up_drive(lane_bias: float, torque: np.ndarray | None = None) -> Drive:
    angle = smooth(3, 0.05)
    nothing = np.zeros(angle.size)
    return Drive(
        lateral_position=smooth(1, 0.2) + lane_bias,
        lane=nothing + 1.0,
        lane_offset=smooth(1, 0.2) + lane_bias,
        yaw_angle=smooth(2, 0.01),
        speed=20.0 + smooth(4, 0.5),
        steering_wheel_angle=angle,
        steering_wheel_rate=np.gradient(angle, DT),
        driver_torque=nothing if torque is None else torque,
        head_yaw=None,
        free=None,
        car=CAR,
        column=COLUMN,
        dt=DT,
    )


def torque_of_the_simulator(driver: DriverParameters, drive: Drive) -> np.ndarray:
    """The driver's own functions on the recorded motion, all noise left out."""
    eyes, hands = driver.vision, driver.arm
    seeing, muscles = vision.initial_state(), arm.initial_state()
    aimed = tracking.initial_state(driver.tracking.lane_bias)
    between = angles_between(drive)
    torques = [0.0]
    for k in range(len(between)):
        near = eyes.near_time * drive.speed[k]
        slope = (aimed.path.y5 - drive.lane_offset[k]) / near
        seeing, intended = vision.step(
            eyes,
            seeing,
            -drive.yaw_angle[k],
            np.arctan(slope) - drive.yaw_angle[k],
            drive.speed[k],
            VisionNoise(near=0.0, motor=0.0),
            DT,
        )
        command = ArmCommand(
            intended_angle=intended,
            holding_stiffness=holding_stiffness(CAR, COLUMN, drive.speed[k]),
            stiffening=1.0,
            guidance=0.0,
            reliance=0.5,
        )
        muscles, mean = moved_arm(driver, muscles, command, between[k])
        rate = np.diff(drive.steering_wheel_angle)[k] / DT
        acceleration = np.diff(drive.steering_wheel_rate)[k] / DT
        torques.append(arm.hand_torque(hands, mean, 1.0, rate, acceleration))
    return np.array(torques)


def moved_arm(
    driver: DriverParameters, state: ArmState, command: ArmCommand, angles: np.ndarray
) -> tuple[ArmState, float]:
    """Arm after a control step, and the mean torque of its muscles."""
    total = 0.0
    for angle in angles:
        state = arm.step(driver.arm, state, command, angle, DT / PLANT_STEPS)
        total += arm.muscle_torque(driver.arm, state, command, angle)
    return state, total / PLANT_STEPS


@pytest.mark.parametrize("participant", [1, 2])
def test_without_noise_the_filter_predicts_what_the_simulator_does(
    participant: int,
) -> None:
    driver = true_driver(participant)
    drive = made_up_drive(driver.tracking.lane_bias)
    drive = drive._replace(driver_torque=torque_of_the_simulator(driver, drive))
    parameters = filter_parameters(driver, DT, 1e-5)
    inputs = filter_inputs(driver, drive, wheel_motion(drive, driver.arm))
    mean, covariance = start(parameters, inputs, driver.vision)
    errors, variances = np.empty((2, inputs.torque.size))
    innovations(parameters, inputs, 0.0 * mean, covariance, errors, variances)
    # Nothing is random and both start at rest: only rounding is left, of 1 N·m.
    assert np.abs(errors).max() < 1e-10
    assert np.abs(drive.driver_torque).max() > 0.1


@pytest.mark.parametrize("participant", [1, 2])
def test_wander_and_noise_begin_with_the_deviations_of_the_driver(
    participant: int,
) -> None:
    driver = true_driver(participant)
    drive = made_up_drive(0.0)
    inputs = filter_inputs(driver, drive, wheel_motion(drive, driver.arm))
    parameters = filter_parameters(driver, DT, 1e-5)
    _, covariance = start(parameters, inputs, driver.vision)
    deviations = np.sqrt(np.diag(covariance))
    # The wander's step is semi-implicit: its variance is off by the order of ω dt.
    assert deviations[WANDER] == pytest.approx(
        driver.tracking.wander_deviation, rel=0.01
    )
    assert deviations[NEAR_NOISE] == pytest.approx(driver.vision.near_noise, rel=1e-9)
    assert deviations[MOTOR_NOISE] == pytest.approx(driver.vision.motor_noise, rel=1e-9)


def test_a_wheel_between_samples_is_the_cubic_through_them() -> None:
    time = DT * np.arange(4)
    drive = made_up_drive(0.0)._replace(
        steering_wheel_angle=time**3 - time, steering_wheel_rate=3.0 * time**2 - 1.0
    )
    fine = DT / PLANT_STEPS * np.arange(3 * PLANT_STEPS)
    # Exact for a cubic, up to rounding.
    np.testing.assert_allclose(
        angles_between(drive).ravel(), fine**3 - fine, atol=1e-14
    )


def test_a_wheel_that_friction_holds_hides_nothing_of_a_torque() -> None:
    drive = made_up_drive(0.0)._replace(
        steering_wheel_angle=np.array([0.0, 0.0, 0.1 * DT / 4.0, 0.02, 0.03, 0.03]),
        steering_wheel_rate=np.array([0.0, 0.0, 0.1, 0.2, 0.2, 0.0]),
    )
    # The third step broke loose half-way: the torque's growing impulse of the later
    # half is 3/4 of the whole.
    np.testing.assert_allclose(sliding_share(drive), [0.0, 0.75, 1.0, 1.0, 0.0])


def hand_and_muscle_torque(driver: DriverParameters, push: float) -> tuple[float, ...]:
    """Means over a step in which the intended angle jumps by `push` [rad]."""
    hands, short = driver.arm, DT / PLANT_STEPS
    stiffness = holding_stiffness(CAR, COLUMN, 20.0)
    command = ArmCommand(push, stiffness, 1.0, 0.0, 0.0)
    column = arm.held_column(hands, COLUMN, 1.0)._replace(friction=0.0)
    state, angle, rate, muscles, given = arm.initial_state(), 0.0, 0.0, 0.0, 0.0
    for _ in range(PLANT_STEPS):
        state = arm.step(hands, state, command, angle, short)
        torque = arm.muscle_torque(hands, state, command, angle)
        gain = hands.holding_gain * stiffness + hands.stiffness
        given += gain * state.equilibrium / PLANT_STEPS
        muscles += torque / PLANT_STEPS
        rate = steering_wheel_rate(column, angle, rate, torque, short)
        angle += short * rate
    return arm.hand_torque(hands, muscles, 1.0, angle / DT, rate / DT), given


@pytest.mark.parametrize("participant", [1, 2, 3])
def test_hands_show_the_share_of_a_push_that_the_simulator_shows(
    participant: int,
) -> None:
    driver = true_driver(participant)
    shown, given = hand_and_muscle_torque(driver, 0.01)
    # The same linear equations, summed in another order.
    assert shown_share(driver.arm, COLUMN, DT) == pytest.approx(shown / given, rel=1e-9)
