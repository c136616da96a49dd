"""Eyes: gains, lead-lag, delay of what is seen, and noise."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.drivers import vision
from costeer.drivers.vision import VisionNoise, VisionParameters
from costeer.plant.parameters import CarParameters, steady_steering_wheel_angle
from tests.drivers.samples import DT, SPEED, driving

PARAMETERS = VisionParameters()
QUIET = VisionNoise(near=0.0, motor=0.0)
ANGLES = st.floats(-0.3, 0.3)


def asked(
    far: NDArray[np.float64],
    near: NDArray[np.float64],
    parameters: VisionParameters = PARAMETERS,
) -> NDArray[np.float64]:
    """Angles that vision asks for, from far and near angles, without noise."""
    state, answers = vision.initial_state(), []
    for ahead, beside in zip(far.tolist(), near.tolist(), strict=True):
        state, answer = vision.step(parameters, state, ahead, beside, SPEED, QUIET, DT)
        answers.append(answer)
    return np.array(answers)


def gain_at(response: NDArray[np.float64], frequency: float) -> complex:
    """Transfer function at a frequency [Hz], from an impulse response."""
    turns = np.exp(-2j * math.pi * frequency * DT * np.arange(response.size))
    return complex(response @ turns)


def single(seconds: float) -> NDArray[np.float64]:
    """A 1, then zeros."""
    values = np.zeros(round(seconds / DT))
    values[0] = 1.0
    return values


def far_gain(frequency: float, parameters: VisionParameters = PARAMETERS) -> complex:
    """From the far angle to the asked one."""
    one = single(10.0)
    return gain_at(asked(one, 0.0 * one, parameters), frequency)


def near_gain(frequency: float, parameters: VisionParameters = PARAMETERS) -> complex:
    """From the near angle to the asked one; 30 s are 30 times the lag of 1 s."""
    one = single(30.0)
    return gain_at(asked(0.0 * one, one, parameters), frequency)


def test_gains_lead_and_delay_are_the_published_ones() -> None:
    # Saleh et al. (2013), table of the driver's parameters.
    assert (PARAMETERS.far_gain, PARAMETERS.near_gain) == (3.4, 15.0)
    assert (PARAMETERS.lag_time, PARAMETERS.delay) == (1.0, 0.04)
    assert 1.0 <= PARAMETERS.lead_time <= 2.5


def test_each_gain_of_the_model_acts_on_its_own_angle() -> None:
    settled = np.ones(round(30.0 / DT))
    far = asked(0.02 * settled, 0.0 * settled)[-1]
    near = asked(0.0 * settled, 0.005 * settled)[-1]
    both = asked(0.02 * settled, 0.005 * settled)[-1]
    assert far == pytest.approx(3.4 * 0.02, rel=1e-12)  # exp(-30) of the lag is left
    assert near == pytest.approx(15.0 / SPEED * 0.005, rel=1e-12)
    assert both == pytest.approx(far + near, rel=1e-12)


def test_what_is_seen_far_ahead_comes_out_40_ms_later() -> None:
    # The phase of slow signals; (w T)^3 / 12 of the all-pass is 1e-7 of it. The
    # command to the arms, held over a control step, is no part of the 40 ms.
    frequency = 3e-3
    delay = -cmath.phase(far_gain(frequency)) / (2.0 * math.pi * frequency)
    assert delay == pytest.approx(0.040, rel=1e-6)


@pytest.mark.parametrize("frequency", [0.05, 0.3, 1.0, 3.0, 10.0])
def test_the_delay_acts_on_the_sum_of_far_and_near(frequency: float) -> None:
    # Saleh et al. delay the sum: with another delay the answers to both angles turn
    # by the same factor, that of the delay alone.
    longer = PARAMETERS._replace(delay=0.12)
    far = far_gain(frequency, longer) / far_gain(frequency)
    near = near_gain(frequency, longer) / near_gain(frequency)
    assert near == pytest.approx(far, abs=1e-9)
    assert abs(far) == pytest.approx(1.0, abs=1e-9)
    assert abs(far - 1.0) > 2e-2  # the factor is not 1


@pytest.mark.parametrize("times", [(1.75, 1.0), (3.0, 2.0)])
@pytest.mark.parametrize("frequency", [0.02, 0.1, 0.5, 2.0])
def test_compensation_is_a_lead_lag_of_the_near_angle(
    frequency: float, times: tuple[float, float]
) -> None:
    lead, lag = times
    parameters = PARAMETERS._replace(lead_time=lead, lag_time=lag)
    s = 2j * math.pi * frequency
    lead_lag = (1.0 + lead * s) / (1.0 + lag * s)
    expected = parameters.near_gain / SPEED * lead_lag * cmath.exp(-0.04 * s)
    # The lag takes the sample of this step for the whole of it: half a step early,
    # s dt / 2 of the part that lags; the delay is Padé's, (s T)^3 / 12 off. After 30 s
    # up to exp(-15) of the lag is left.
    size = abs(expected)
    allowed = size * (abs(s) * DT / 2.0 + abs(0.04 * s) ** 3 / 12.0) + 1e-6
    assert abs(near_gain(frequency, parameters) - expected) < allowed


def test_compensation_starts_at_lead_over_lag_and_settles_to_the_angle() -> None:
    lead = PARAMETERS.lead_time / PARAMETERS.lag_time
    assert vision.compensation(PARAMETERS, 0.0, 0.01) == pytest.approx(0.01 * lead)
    assert vision.compensation(PARAMETERS, 0.01, 0.01) == 0.01


def test_a_planned_curvature_is_steered_without_delay() -> None:
    car = CarParameters()
    ahead = steady_steering_wheel_angle(car, SPEED, 0.001)
    planned = vision.planned_angle(PARAMETERS, car, SPEED, 0.001)
    assert planned == pytest.approx(PARAMETERS.curvature_gain * ahead, rel=1e-12)
    slow = PARAMETERS._replace(delay=1.0)
    assert vision.planned_angle(slow, car, SPEED, 0.001) == planned


def noise_of(num_steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Seen and intended noise, and asked angles [rad], of eyes on the aim."""
    state, noises, answers = vision.initial_state(), [], []
    for near, motor in np.random.default_rng(1).normal(size=(num_steps, 2)).tolist():
        draws = VisionNoise(near=near, motor=motor)
        state, asked = vision.step(PARAMETERS, state, 0.0, 0.0, SPEED, draws, DT)
        answer = vision.performed(PARAMETERS, state, asked, 0.0)
        noises.append((state.near_noise, state.motor_noise))
        answers.append(answer)
    return np.array(noises[600:]).T, np.array(answers[600:])


def test_noise_settles_to_its_deviation_and_correlation() -> None:
    (near_noise, motor_noise), _ = noise_of(60_000)
    # 1000 s hold about 1000 / (2 · 0.35) independent values: 1.9 % of a deviation.
    assert near_noise.std() == pytest.approx(PARAMETERS.near_noise, rel=0.06)
    assert motor_noise.std() == pytest.approx(PARAMETERS.motor_noise, rel=0.06)
    lag = round(PARAMETERS.noise_time / DT)
    kept = np.corrcoef(near_noise[:-lag], near_noise[lag:])[0, 1]
    assert kept == pytest.approx(math.exp(-lag * DT / PARAMETERS.noise_time), abs=0.06)


def test_noise_of_the_hand_is_added_after_the_delay() -> None:
    start, draws = vision.initial_state(), VisionNoise(near=0.0, motor=1.0)
    state, answer = vision.step(PARAMETERS, start, 0.0, 0.0, SPEED, draws, DT)
    assert answer == 0.0
    assert vision.performed(PARAMETERS, state, answer, 0.0) == state.motor_noise != 0.0


@pytest.mark.parametrize("angle", [0.0, 0.05, -0.2])
def test_noise_of_the_hand_grows_with_what_it_does(angle: float) -> None:
    # Standard deviation: that at rest and a tenth of the angle, whoever plans it.
    parameters = PARAMETERS._replace(motor_noise=0.01, signal_noise=0.1)
    one = vision.initial_state()._replace(motor_noise=0.01)  # standard deviation
    for seen, planned in ((angle, 0.0), (0.0, angle), (angle / 2.0, angle / 2.0)):
        done = vision.performed(parameters, one, seen, planned)
        assert done - angle == pytest.approx(0.01 + 0.1 * abs(angle))


def test_a_car_on_its_aim_keeps_the_wheel_straight() -> None:
    assert (
        vision.near_angle(driving(), 0.0, 10.0)
        == 0.0
        == vision.far_angle(driving(), 0.0)
    )
    nothing = np.zeros(60)
    assert not asked(nothing, nothing).any()


def test_a_point_to_the_left_is_a_positive_angle() -> None:
    assert vision.near_angle(driving(), 0.1, 8.0) == pytest.approx(0.0125, rel=1e-3)
    assert vision.near_angle(driving(yaw_angle=0.01), 0.0, 8.0) == pytest.approx(-0.01)
    assert vision.far_angle(driving(yaw_angle=0.01), 0.02) == pytest.approx(
        math.atan(0.02) - 0.01
    )


@given(ANGLES, ANGLES, st.floats(-4.0, 4.0), st.floats(-4.0, 4.0))
def test_mirrored_angles_ask_for_the_mirrored_wheel(
    far: float, near: float, seen: float, moved: float
) -> None:
    here = there = vision.initial_state()
    for _ in range(3):
        noise = VisionNoise(near=seen, motor=moved)
        mirrored = VisionNoise(near=-seen, motor=-moved)
        here, left = vision.step(PARAMETERS, here, far, near, SPEED, noise, DT)
        there, right = vision.step(PARAMETERS, there, -far, -near, SPEED, mirrored, DT)
        assert left == -right
