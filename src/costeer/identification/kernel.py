"""Kalman filter of the driver in lane keeping: what the next torque was expected to be.

In lane keeping on a straight road the driver of `costeer.drivers` is linear in what it
remembers, with Gaussian noise. What it sees and feels (position, yaw, speed, wheel) is
recorded, so the filter needs no car: it predicts the torque of the muscles from what
was recorded before, and corrects its idea of wander and noise by how wrong that was.

State: wander of the aim and its rate, noise of seeing, noise of steering, lead-lag,
delay, arm's equilibrium. One row of `drivers.driver.see` and `drivers.arm.step` each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real, compiled
from costeer.base.entry import entry

NUM_STATES, NUM_NOISES = 7, 3
WANDER, WANDER_RATE, NEAR_NOISE, MOTOR_NOISE, LAGGED, DELAYED, EQUILIBRIUM = range(7)
_CONSTANT = NUM_STATES + NUM_NOISES
_SIZE = _CONSTANT + 1


class FilterParameters(NamedTuple):
    """The driver's constants over one control step.

    Attributes:
        wander_pull: Of the wander on its rate, per step [1/s]. Source: tracking.py.
        wander_kept: Share of its rate that is left [-]. Source: tracking.py.
        wander_kick: Deviation of its rate per step [m/s]. Source: tracking.py.
        noise_kept: Share of both noises that is left [-]. Source: vision.py.
        near_kick: Deviation of the seen noise per step [rad]. Source: vision.py.
        motor_kick: Deviation of the steering noise per step [rad]. Source: vision.py.
        lag_kept: Share of the lead-lag's state that is left [-]. Source: vision.py.
        lead: T_L over T_I [-]. Source: vision.py.
        delay_share: Coefficient of the Pade delay [-]. Source: base/filters.py.
        far_gain: K_p [-]. Source: vision.py.
        arm_kept: Share of the equilibrium left after the step [-]. Source: arm.py.
        arm_mean: Mean share that is left during the step [-]. Source: arm.py.
        error_variance: Of the torque [N²·m²]. Source: likelihood.py.
        dt: Control step [s]. Source: the recording.
    """

    wander_pull: Real
    wander_kept: Real
    wander_kick: Real
    noise_kept: Real
    near_kick: Real
    motor_kick: Real
    lag_kept: Real
    lead: Real
    delay_share: Real
    far_gain: Real
    arm_kept: Real
    arm_mean: Real
    error_variance: Real
    dt: Real


class FilterInputs(NamedTuple):
    """What the driver saw, shape `(time,)` each.

    Attributes:
        near_angle: To the near point without wander and noise [rad].
        far_angle: [rad].
        wander_angle: Near angle per wander [rad/m].
        near_gain: K_c over speed [-].
        torque_gain: Torque of the muscles per equilibrium [N·m/rad].
        torque: Of the muscles less what the felt wheel angle gives [N·m].
    """

    near_angle: NDArray[np.float64]
    far_angle: NDArray[np.float64]
    wander_angle: NDArray[np.float64]
    near_gain: NDArray[np.float64]
    torque_gain: NDArray[np.float64]
    torque: NDArray[np.float64]


@compiled
def fill_wander_and_noise(
    parameters: FilterParameters, matrix: NDArray[np.float64]
) -> None:
    """Rows of wander and noises: how they go on by themselves, and what drives them.

    Args:
        parameters: Of the driver.
        matrix: Rows states and torque, columns states, noises and a constant; filled.
    """
    dt = parameters.dt
    matrix[WANDER_RATE, WANDER] = -parameters.wander_pull
    matrix[WANDER_RATE, WANDER_RATE] = parameters.wander_kept
    matrix[WANDER_RATE, NUM_STATES] = parameters.wander_kick
    matrix[WANDER, WANDER] = 1.0 - dt * parameters.wander_pull
    matrix[WANDER, WANDER_RATE] = dt * parameters.wander_kept
    matrix[WANDER, NUM_STATES] = dt * parameters.wander_kick
    matrix[NEAR_NOISE, NEAR_NOISE] = parameters.noise_kept
    matrix[NEAR_NOISE, NUM_STATES + 1] = parameters.near_kick
    matrix[MOTOR_NOISE, MOTOR_NOISE] = parameters.noise_kept
    matrix[MOTOR_NOISE, NUM_STATES + 2] = parameters.motor_kick


@compiled
def fill_vision_and_arm(
    parameters: FilterParameters,
    inputs: FilterInputs,
    k: int,
    matrix: NDArray[np.float64],
) -> None:
    """Rows of lead-lag, delay, equilibrium and torque at step `k`.

    Args:
        parameters: Of the driver.
        inputs: What the driver saw.
        k: Step.
        matrix: As above; the rows of wander and noises are filled already.
    """
    share, lead, lag = parameters.delay_share, parameters.lead, parameters.lag_kept
    arm, mean = parameters.arm_kept, parameters.arm_mean
    gain, wandered = inputs.near_gain[k], inputs.wander_angle[k]
    torque_gain = inputs.torque_gain[k]
    for j in range(_SIZE):
        seen = wandered * matrix[WANDER, j] + matrix[NEAR_NOISE, j]
        asked, delayed, lagged, equilibrium = 0.0, 0.0, 0.0, 0.0
        if j == _CONSTANT:
            seen = inputs.near_angle[k]
            asked = parameters.far_gain * inputs.far_angle[k]
        if j == LAGGED:
            lagged = 1.0
        if j == DELAYED:
            delayed = 1.0
        if j == EQUILIBRIUM:
            equilibrium = 1.0
        lagged = seen + (lagged - seen) * lag
        asked += gain * (lagged + lead * (seen - lagged))
        felt = delayed + share * asked
        intended = felt + matrix[MOTOR_NOISE, j]
        matrix[LAGGED, j] = lagged
        matrix[DELAYED, j] = asked - share * felt
        matrix[EQUILIBRIUM, j] = intended + (equilibrium - intended) * arm
        matrix[NUM_STATES, j] = torque_gain * (
            intended + (equilibrium - intended) * mean
        )


@compiled
def predict(
    matrix: NDArray[np.float64],
    covariance: NDArray[np.float64],
    moved: NDArray[np.float64],
) -> None:
    """Covariance of states and torque one step on, shape `(8, 8)`, in `moved`."""
    size = NUM_STATES + 1
    half = np.zeros((size, NUM_STATES))
    for i in range(size):
        for j in range(NUM_STATES):
            total = 0.0
            for m in range(NUM_STATES):
                total += matrix[i, m] * covariance[m, j]
            half[i, j] = total
    for i in range(size):
        for j in range(i + 1):
            total = 0.0
            for m in range(NUM_STATES):
                total += half[i, m] * matrix[j, m]
            for m in range(NUM_STATES, _CONSTANT):
                total += matrix[i, m] * matrix[j, m]
            moved[i, j] = total
            moved[j, i] = total


@compiled
def innovations(
    parameters: FilterParameters,
    inputs: FilterInputs,
    state: NDArray[np.float64],
    covariance: NDArray[np.float64],
    errors: NDArray[np.float64],
    variances: NDArray[np.float64],
) -> None:
    """Fill the errors of the one-step predictions [N·m] and their variances.

    Args:
        parameters: Of the driver.
        inputs: What the driver saw and did, shape `(time,)`.
        state: Mean at the start, shape `(7,)`; changed in place.
        covariance: At the start, shape `(7, 7)`; changed in place.
        errors: Torque less its prediction, shape `(time,)`; filled.
        variances: Of the errors, shape `(time,)`; filled.
    """
    matrix = np.zeros((NUM_STATES + 1, _SIZE))
    moved = np.zeros((NUM_STATES + 1, NUM_STATES + 1))
    expected = np.zeros(NUM_STATES + 1)
    fill_wander_and_noise(parameters, matrix)
    for k in range(len(errors)):
        fill_vision_and_arm(parameters, inputs, k, matrix)
        predict(matrix, covariance, moved)
        for i in range(NUM_STATES + 1):
            total = matrix[i, _CONSTANT]
            for m in range(NUM_STATES):
                total += matrix[i, m] * state[m]
            expected[i] = total
        variance = moved[NUM_STATES, NUM_STATES] + parameters.error_variance
        error = inputs.torque[k] - expected[NUM_STATES]
        for i in range(NUM_STATES):
            gain = moved[i, NUM_STATES] / variance
            state[i] = expected[i] + gain * error
            for j in range(NUM_STATES):
                covariance[i, j] = moved[i, j] - gain * moved[j, NUM_STATES]
        errors[k] = error
        variances[k] = variance


@entry
def innovations_compiled(
    parameters: FilterParameters,
    inputs: FilterInputs,
    state: NDArray[np.float64],
    covariance: NDArray[np.float64],
    errors: NDArray[np.float64],
    variances: NDArray[np.float64],
) -> None:
    """`innovations`, compiled."""
    innovations(parameters, inputs, state, covariance, errors, variances)
