"""What the observer says of columns that are known, and of ones known badly."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from numpy.typing import NDArray

from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import steering_wheel_rate
from costeer.sensing.torque_observer import (
    DelayedTorque,
    TorqueObserverParameters,
    TorqueObserverState,
    WheelMotion,
    delayed_torque,
    initial_state,
    step,
)

DT = 1.0 / 960.0
KNOWN = TorqueObserverParameters(stiffness=0.4)
SMOOTH = KNOWN._replace(friction=0.0)
Signal = NDArray[np.float64]


class Run(NamedTuple):
    """A wheel and what was estimated, one value a step."""

    rate: Signal
    angle: Signal
    estimate: Signal


def run(
    parameters: TorqueObserverParameters,
    driver: Signal,
    motor: Signal,
    wheel: TorqueObserverParameters | None = None,
    tells_rate: bool = True,
) -> Run:
    """The plant's own wheel under the torque of both, watched by the observer."""
    device = parameters if wheel is None else wheel
    column = ColumnParameters(
        inertia=device.inertia,
        damping=device.damping,
        stiffness=device.stiffness,
        friction=device.friction,
    )
    angle, rate, state, rows = 0.0, 0.0, initial_state(), []
    for hands, torque in zip(driver.tolist(), motor.tolist(), strict=True):
        rate = steering_wheel_rate(column, angle, rate, hands + torque, DT)
        angle += DT * rate
        seen = WheelMotion(angle, rate if tells_rate else math.nan, torque)
        state, estimate = step(parameters, state, seen, DT)
        rows.append((rate, angle, estimate))
    return Run(*np.array(rows).T)


def shaken(seconds: float = 1.0) -> Signal:
    """A torque that moves the wheel fast both ways [N·m]."""
    time = DT * np.arange(round(seconds / DT))
    return np.asarray(1.5 * np.sin(9.0 * time) + 0.5 * np.sin(31.0 * time))


@pytest.mark.parametrize("torque", [0.7, -2.0])
def test_a_constant_torque_is_approached_as_an_exponential(torque: float) -> None:
    found = run(SMOOTH, np.full(200, torque), shaken()[:200]).estimate
    time = DT * np.arange(1, 201)
    expected = torque * (1.0 - np.exp(-time / SMOOTH.time_constant))
    # Rounding: the rate's last digits over a step of 1 ms.
    assert found == pytest.approx(expected, abs=1e-9)


def test_friction_that_is_known_changes_nothing_while_the_wheel_turns() -> None:
    found = run(KNOWN, np.full(200, 2.0), np.zeros(200))
    assert (found.rate > KNOWN.still_rate).all()  # else friction is not known
    time = DT * np.arange(1, 201)
    expected = 2.0 * (1.0 - np.exp(-time / KNOWN.time_constant))
    assert found.estimate == pytest.approx(expected, abs=1e-9)


def test_a_wheel_that_tells_only_its_angle_is_seen_through_one_more_lag() -> None:
    found = run(SMOOTH, np.full(300, 1.0), shaken()[:300], tells_rate=False).estimate
    slow = math.exp(-DT / SMOOTH.time_constant)
    fast = math.exp(-DT / SMOOTH.rate_time_constant)
    # Step response of two sampled lags in a row, by partial fractions.
    n = np.arange(1, 301)
    share = fast * (1.0 - slow) / (slow - fast)
    expected = 1.0 - slow**n - share * (slow**n - fast**n)
    assert found == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("tells_rate", [True, False])
def test_a_wheel_without_hands_has_no_driver(tells_rate: bool) -> None:
    found = run(SMOOTH, np.zeros(960), shaken(), tells_rate=tells_rate)
    assert np.ptp(found.angle) > 1.0  # rad: it does move
    assert np.abs(found.estimate).max() < 1e-9  # rounding


def test_on_a_still_wheel_the_error_is_what_friction_hides() -> None:
    below = np.full(960, 0.9 * KNOWN.friction)
    found = run(KNOWN, np.zeros(960), below)
    assert not found.angle.any()  # friction holds it, no hands do
    # As likely, hands hold it alone, or push as much again: the middle is taken.
    assert found.estimate[-1] == pytest.approx(-below[-1], abs=1e-3)
    assert not run(KNOWN, np.zeros(960), 0.0 * below).estimate.any()


def test_friction_makes_nobody_drive_a_wheel_without_hands() -> None:
    found = run(KNOWN, np.zeros(1920), shaken(2.0))
    # At each reversal friction is known within still_rate only: for the few steps of
    # 1 ms which the wheel spends there, at most twice the friction passes the lag.
    assert np.abs(found.estimate).max() < 0.3 * KNOWN.friction
    assert abs(found.estimate.mean()) < 0.01 * KNOWN.friction


def test_at_rest_the_estimate_is_steady_though_friction_is_not_known() -> None:
    # Hands hold the wheel against the motor; friction takes up to 0.15 N·m of it.
    motor = np.full(1920, 1.0)
    found = run(KNOWN, -motor, motor)
    assert not found.angle.any()
    settled = found.estimate[1440:]
    assert np.ptp(settled) < 1e-6  # no chatter: after 15 times the time of rest
    assert settled[-1] == pytest.approx(-1.0, abs=1e-6)


def test_a_still_wheel_forgets_how_it_came_to_rest() -> None:
    held = initial_state()._replace(estimated_driver_torque=0.1)
    still = WheelMotion(0.0, 0.0, 0.0)
    for _ in range(96):  # the time of rest
        held, _ = step(KNOWN, held, still, DT)
    # A step of 1 ms in a lag of 20 ms is 2.6 % less than its rate says.
    assert held.estimated_driver_torque == pytest.approx(0.1 / math.e, rel=0.03)


SIGNALS = st.lists(
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)), min_size=2, max_size=20
)


@settings(max_examples=30)
@given(SIGNALS, st.booleans())
def test_a_mirrored_wheel_has_a_mirrored_driver(
    torques: list[tuple[float, float]], tells_rate: bool
) -> None:
    driver, motor = (np.repeat(each, 10) for each in np.array(torques).T)
    here = run(KNOWN, driver, motor, tells_rate=tells_rate)
    there = run(KNOWN, -driver, -motor, tells_rate=tells_rate)
    assert (there.estimate == -here.estimate).all()


@given(st.floats(0.0, 3.0), st.floats(0.0, 0.03))
def test_a_ramp_comes_late_by_the_latency(slope: float, latency: float) -> None:
    line = DelayedTorque(0.0, 0.0, 0.0, 0.0)
    for n in range(400):
        line = delayed_torque(latency, line, slope * DT * n, DT)
    # Four lags of 7.5 ms at most have settled after 400 ms; rounding.
    late = slope * (399 * DT - latency)
    assert line.fourth == pytest.approx(late, abs=1e-6)


@pytest.mark.parametrize("factor", [0.8, 1.2])
@pytest.mark.parametrize("tells_rate", [True, False])
def test_parameters_wrong_by_a_fifth_err_by_a_fifth_of_what_they_explain(
    factor: float, tells_rate: bool
) -> None:
    driver, motor = 0.5 * shaken(2.0)[::-1], shaken(2.0)
    wrong = KNOWN._replace(
        inertia=factor * KNOWN.inertia,
        damping=factor * KNOWN.damping,
        stiffness=factor * KNOWN.stiffness,
        friction=factor * KNOWN.friction,
    )
    right = run(KNOWN, driver, motor, tells_rate=tells_rate)
    found = run(wrong, driver, motor, KNOWN, tells_rate)
    explained = (
        KNOWN.inertia * np.abs(np.diff(right.rate, prepend=0.0)).max() / DT
        + KNOWN.damping * np.abs(right.rate).max()
        + KNOWN.stiffness * np.abs(right.angle).max()
        + KNOWN.friction
    )
    # The lag's weights are positive and add up to one, so it enlarges no error. At
    # reversals the two estimates may choose differently within the friction's room.
    error = np.abs(found.estimate - right.estimate).max()
    assert 0.02 * explained < error <= 0.2 * explained + 0.2 * KNOWN.friction


def test_a_batch_gives_what_its_members_give() -> None:
    generator = np.random.default_rng(5)
    motions = (
        generator.normal(size=(3, 50, 4)) * np.array([0.1, 1.0, 1.0])[:, None, None]
    )
    motions[1, ::3] = math.nan
    latency = np.array([0.0, 0.004, 0.01, 0.03])
    states = initial_state()
    alone = [initial_state() for _ in range(4)]
    for angle, rate, torque in motions.swapaxes(0, 1):
        many = KNOWN._replace(latency=latency)  # type: ignore[arg-type]  # a batch
        states, estimates = step(many, states, WheelMotion(angle, rate, torque), DT)
        for i in range(4):
            one = KNOWN._replace(latency=float(latency[i]))
            motion = WheelMotion(float(angle[i]), float(rate[i]), float(torque[i]))
            alone[i], estimate = step(one, alone[i], motion, DT)
            # NumPy's exponential may differ from math's in the last digit.
            assert np.asarray(estimates)[i] == pytest.approx(estimate, rel=1e-9)


@njit
def followed(
    parameters: TorqueObserverParameters, state: TorqueObserverState, motions: Signal
) -> Signal:
    estimates = np.empty(len(motions))
    for i in range(len(motions)):
        angle, rate, torque = motions[i]
        motion = WheelMotion(angle, rate, torque)
        state, estimates[i] = step(parameters, state, motion, DT)
    return estimates


@pytest.mark.slow
def test_compiled_it_says_the_same() -> None:
    motions = np.random.default_rng(6).normal(size=(60, 3))
    motions[::2, 1] = math.nan
    state, expected = initial_state(), []
    for row in motions.tolist():
        state, estimate = step(KNOWN, state, WheelMotion(*row), DT)
        expected.append(estimate)
    found = followed(KNOWN, initial_state(), motions)
    assert found == pytest.approx(expected, rel=1e-9)  # fused multiply-add


@pytest.mark.parametrize(
    "motion",
    [
        WheelMotion(math.nan, 0.1, 0.2),
        WheelMotion(0.1, math.nan, math.inf),
        WheelMotion(-math.inf, 0.0, 0.0),
    ],
)
def test_a_reading_that_is_no_number_changes_nothing(motion: WheelMotion) -> None:
    before = initial_state(0.3, 0.2)
    assert step(KNOWN, before, motion, DT) == (before, 0.0)
