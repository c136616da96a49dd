"""The driver's equations over one control step, in the form that the filter takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from costeer.base.filters import decay
from costeer.drivers.arm import ArmParameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.vision import VisionParameters
from costeer.identification.kernel import (
    NUM_NOISES,
    NUM_STATES,
    FilterInputs,
    FilterParameters,
    fill_vision_and_arm,
    fill_wander_and_noise,
)
from costeer.identification.signals import (
    PLANT_STEPS,
    Drive,
    Signal,
    WheelMotion,
    angles_between,
    sliding_share,
)
from costeer.plant.parameters import holding_stiffness

_UNKNOWN = (0.0, 0.0, 0.0, 0.0, 0.02, 0.05, 0.1)
"""Deviation at the start of what is not noise [rad]: lead-lag, delay, equilibrium."""


_DOUBLINGS = 14
"""So many double one step to four minutes, 60 time constants of the wander."""


def _pade_share(delay: float, dt: float) -> float:
    """Coefficient of `base.filters.pade_delay`."""
    return (dt - delay) / (dt + delay)


def reflex_angle(arm: ArmParameters, angle: Signal, dt: float) -> Signal:
    """Wheel angle as the reflex acts on it: after delay and lag, `arm.step` [rad].

    Args:
        arm: Delay and lag.
        angle: Of the wheel at the plant steps, shape `(time,)` [rad].
        dt: Plant step [s].
    """
    share, kept = _pade_share(arm.reflex_delay, dt), decay(dt, arm.lag)
    start = angle[0]
    delayed = lfilter([share, 1.0], [1.0, share], angle - start)
    felt = lfilter([1.0 - kept], [1.0, -kept], delayed)
    return np.asarray(felt + start)


def wheel_motion(drive: Drive, arm: ArmParameters) -> WheelMotion:
    """Motion of the wheel over each control step, seen by arm and reflex."""
    angles = angles_between(drive)
    reflex = reflex_angle(arm, angles.ravel(), drive.dt / PLANT_STEPS)
    return WheelMotion(
        mean_angle=angles.mean(axis=1),
        mean_reflex_angle=reflex.reshape(angles.shape).mean(axis=1),
        mean_rate=np.diff(drive.steering_wheel_angle) / drive.dt,
        mean_acceleration=np.diff(drive.steering_wheel_rate) / drive.dt,
        sliding=sliding_share(drive),
    )


def filter_parameters(
    driver: DriverParameters, dt: float, torque_noise: float
) -> FilterParameters:
    """The driver's constants over a control step.

    Args:
        driver: Eyes, aim and arms.
        dt: Control step [s].
        torque_noise: Standard deviation of the measured torque's noise [N·m].
    """
    eyes, aim, arm = driver.vision, driver.tracking, driver.arm
    kept = decay(dt, eyes.noise_time)
    kick = np.sqrt(1.0 - kept * kept)
    frequency, damping = aim.wander_frequency, aim.wander_damping
    intensity = 2.0 * np.sqrt(damping * frequency) * frequency
    left = decay(dt / PLANT_STEPS, arm.lag) ** np.arange(1, PLANT_STEPS + 1)
    return FilterParameters(
        wander_pull=frequency**2 * dt,
        wander_kept=1.0 - 2.0 * damping * frequency * dt,
        wander_kick=float(aim.wander_deviation * intensity * np.sqrt(dt)),
        noise_kept=kept,
        near_kick=float(eyes.near_noise * kick),
        motor_kick=float(eyes.motor_noise * kick),
        lag_kept=decay(dt, eyes.lag_time),
        lead=eyes.lead_time / eyes.lag_time,
        delay_share=_pade_share(eyes.delay, dt),
        far_gain=eyes.far_gain,
        arm_kept=float(left[-1]),
        arm_mean=float(left.mean()),
        error_variance=torque_noise**2,
        dt=dt,
    )


def muscle_torque(arm: ArmParameters, drive: Drive, motion: WheelMotion) -> Signal:
    """Torque that the equilibrium gives: what is measured less what the wheel gives.

    The hands' torque lacks what moves the arms, `arm.hand_torque`; stiffness and
    reflex take their part of the wheel's angle, `arm.muscle_torque`.

    Args:
        arm: Stiffness, damping and inertia.
        drive: The recording.
        motion: Of the wheel.

    Returns:
        Means over the control steps, shape `(time - 1,)` [N·m].
    """
    share = arm.intrinsic_share
    angle = share * motion.mean_angle + (1.0 - share) * motion.mean_reflex_angle
    moved = arm.damping * motion.mean_rate + arm.inertia * motion.mean_acceleration
    return np.asarray(drive.driver_torque[1:] + moved + arm.stiffness * angle)


def filter_inputs(
    driver: DriverParameters, drive: Drive, motion: WheelMotion
) -> FilterInputs:
    """What the driver saw and did over each control step, shape `(time - 1,)` each."""
    eyes, arm = driver.vision, driver.arm
    speed, yaw = drive.speed[:-1], drive.yaw_angle[:-1]
    distance = speed * eyes.near_time
    slope = (driver.tracking.lane_bias - drive.lane_offset[:-1]) / distance
    # The equations take arrays as well as the floats they are annotated with.
    holding = np.asarray(holding_stiffness(drive.car, drive.column, speed))  # type: ignore[arg-type]  # said above
    return FilterInputs(
        near_angle=np.arctan(slope) - yaw,
        far_angle=-yaw,
        wander_angle=1.0 / (distance * (1.0 + slope**2)),
        near_gain=eyes.near_gain / speed,
        torque_gain=arm.holding_gain * holding + arm.stiffness,
        torque=muscle_torque(arm, drive, motion),
    )


def part(inputs: FilterInputs, rows: slice) -> FilterInputs:
    """The rows of one stretch."""
    return FilterInputs(*(np.ascontiguousarray(each[rows]) for each in inputs))


def stationary_covariance(
    transition: NDArray[np.float64], added: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Covariance that a stable filter settles to, shape `(state, state)`.

    The sum of what each past step has added, twice as many of them in every turn: more
    robust than the linear equation, whose matrix has the square of the condition.

    Args:
        transition: Of the states in one step, shape `(state, state)`.
        added: Covariance of the noise in one step, shape `(state, state)`.
    """
    total, power = added, transition
    for _ in range(_DOUBLINGS):
        total = total + power @ total @ power.T
        power = power @ power
    return np.asarray(total)


def start(
    parameters: FilterParameters, inputs: FilterInputs, vision: VisionParameters
) -> tuple[Signal, NDArray[np.float64]]:
    """Mean and covariance of the filter's states at the start of a stretch.

    Noise and wander are in their stationary state; how what was seen before has
    filled lead-lag, delay and arm is hardly known.

    Args:
        parameters: Of the filter.
        inputs: Of the stretch.
        vision: Delay.
    """
    matrix = np.zeros((NUM_STATES + 1, NUM_STATES + NUM_NOISES + 1))
    fill_wander_and_noise(parameters, matrix)
    fill_vision_and_arm(parameters, inputs, 0, matrix)
    transition = matrix[:NUM_STATES, :NUM_STATES]
    noise = matrix[:NUM_STATES, NUM_STATES : NUM_STATES + NUM_NOISES]
    covariance = stationary_covariance(transition, noise @ noise.T)
    near, far = inputs.near_angle[0], inputs.far_angle[0]
    asked = parameters.far_gain * far + inputs.near_gain[0] * near
    memory = asked * 2.0 * vision.delay / (vision.delay + parameters.dt)
    mean = np.array([0.0, 0.0, 0.0, 0.0, near, memory, asked])
    return mean, np.asarray(covariance + np.diag(_UNKNOWN) ** 2)
