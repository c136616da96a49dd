"""Eyes: delay, lead-lag, gains and noise of the near and far point."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers import vision
from costeer.drivers.tracking import Aim
from costeer.drivers.vision import VisionParameters, VisionState, delayed_angle
from costeer.plant.parameters import CarParameters, steady_steering_wheel_angle
from tests.drivers.samples import DT, SPEED, driving

DELAY = VisionParameters().delay
AT_REST = VisionState(delayed=0.0, lagged=0.0, near_noise=0.0, motor_noise=0.0)


def impulse_response(
    step: Callable[[float, float], tuple[float, float]], num_steps: int
) -> NDArray[np.float64]:
    """Answer of `state, output = step(state, input)` to a single 1."""
    state, answers = 0.0, []
    for k in range(num_steps):
        state, output = step(state, 1.0 if k == 0 else 0.0)
        answers.append(output)
    return np.array(answers)


def gain_at(response: NDArray[np.float64], frequency: float, dt: float) -> complex:
    """Transfer function at a frequency [rad/s], from an impulse response."""
    turns = np.exp(-1j * frequency * dt * np.arange(response.size))
    return complex(response @ turns)


def delay_response(dt: float) -> NDArray[np.float64]:
    steps = round(20.0 * DELAY / dt)
    return impulse_response(
        lambda state, angle: delayed_angle(state, angle, DELAY, dt), steps
    )


def group_delay(dt: float) -> float:
    """Delay of slow signals [s]."""
    frequency = 1e-3
    return -cmath.phase(gain_at(delay_response(dt), frequency, dt)) / frequency


def test_delay_lets_a_constant_through_unchanged() -> None:
    # What is left of the approximation's state after 20 delays: exp(-40).
    assert gain_at(delay_response(DT), 0.0, DT) == pytest.approx(1.0, abs=1e-12)


def test_delay_of_slow_signals_approaches_its_parameter_as_steps_shrink() -> None:
    # An input held over the step is half a step early: T - dt + O(dt²) in all.
    for dt in (DT / 10.0, DT / 20.0, DT / 40.0):
        assert group_delay(dt) == pytest.approx(DELAY - dt, abs=dt)
    assert group_delay(DT / 400.0) == pytest.approx(DELAY, abs=1e-4)


def test_delay_at_60_hz_is_26_ms_by_the_closed_form() -> None:
    # The frozen population was calibrated with this discretisation: the half step
    # by which a held input is early counts twice in 2/(1 + sT/2) - 1. The command to
    # the arms, held over a control step, adds 8 ms: 34 ms in all.
    kept = math.exp(-2.0 * DT / DELAY)
    assert group_delay(DT) == pytest.approx(2.0 * kept / (1.0 - kept) * DT, rel=1e-4)
    assert group_delay(DT) == pytest.approx(0.0256, abs=1e-4)


def test_delay_has_unit_gain_below_one_hertz() -> None:
    # Padé's all-pass, sampled: its gain falls with the square of the frequency.
    gains = [abs(gain_at(delay_response(DT), 2.0 * math.pi * f, DT)) for f in (0.3, 1)]
    assert gains == pytest.approx([1.0, 1.0], abs=0.01)


def lead_lag(angle: float, seconds: float) -> list[float]:
    """Compensation after a step of the near angle, without noise."""
    state, answers = AT_REST, []
    quiet = VisionParameters(delay=1e-6)
    for _ in range(round(seconds / DT)):
        state, compensation = vision.step(quiet, state, angle, 0.0, 0.0, DT)
        answers.append(compensation)
    return answers


def test_compensation_starts_at_lead_over_lag_and_settles_to_the_angle() -> None:
    parameters = VisionParameters()
    answers = lead_lag(0.01, 12.0)
    # One control step of the lag is in the first answer: exp(-dt / T_I) of the jump.
    lead = parameters.lead_time / parameters.lag_time
    kept = math.exp(-DT / parameters.lag_time)
    assert answers[0] == pytest.approx(0.01 * (1.0 + (lead - 1.0) * kept), rel=1e-9)
    assert answers[-1] == pytest.approx(0.01, rel=1e-4)  # exp(-12)


def test_seen_noise_settles_to_its_deviation_and_correlation() -> None:
    state, seen = AT_REST, []
    normals = np.random.default_rng(1).normal(size=(120_000, 2))
    parameters = VisionParameters()
    for near, motor in normals:
        state, _ = vision.step(parameters, state, 0.0, near, motor, DT)
        seen.append((state.near_noise, state.motor_noise))
    near_noise, motor_noise = np.array(seen[600:]).T
    # 2000 s hold about 2000 / (2 · 0.35) independent values: 1.3 % of a deviation.
    assert near_noise.std() == pytest.approx(parameters.near_noise, rel=0.06)
    assert motor_noise.std() == pytest.approx(parameters.motor_noise, rel=0.06)
    lag = round(parameters.noise_time / DT)
    kept = np.corrcoef(near_noise[:-lag], near_noise[lag:])[0, 1]
    assert kept == pytest.approx(math.exp(-lag * DT / parameters.noise_time), abs=0.06)


def test_a_car_on_its_aim_keeps_the_wheel_straight() -> None:
    aim = Aim(near_position=0.0, far_slope=0.0, far_curvature=0.0)
    assert vision.near_angle(driving(), 0.0, 10.0) == 0.0
    intended = vision.intended_angle(
        VisionParameters(), CarParameters(), driving(), aim, 0.0
    )
    assert intended == 0.0


def test_each_gain_of_the_model_acts_on_its_own_angle() -> None:
    parameters, car = VisionParameters(), CarParameters()
    aim = Aim(near_position=0.0, far_slope=0.02, far_curvature=0.001)
    intended = vision.intended_angle(parameters, car, driving(), aim, 0.005)
    ahead = steady_steering_wheel_angle(car, SPEED, 0.001)
    expected = (
        3.4 * math.atan(0.02) + 15.0 / SPEED * 0.005 + parameters.curvature_gain * ahead
    )
    assert intended == pytest.approx(expected, rel=1e-12)


def test_a_near_point_to_the_left_is_a_positive_angle() -> None:
    assert vision.near_angle(driving(), 0.1, 8.0) == pytest.approx(0.0125, rel=1e-3)
    assert vision.near_angle(driving(yaw_angle=0.01), 0.0, 8.0) == pytest.approx(-0.01)
