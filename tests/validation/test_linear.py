"""Linear analysis: right about the vehicle, and right about the simulation."""

from __future__ import annotations

import math
from functools import cache
from typing import TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from costeer.controller.step import ControllerParameters
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_OFF, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import CARS, CarParameters
from costeer.records.row import ROW_COLUMNS
from costeer.validation.linear import (
    LinearLoop,
    closed_loop,
    damping_ratio,
    delay_margin,
    gain_margin,
    largest_modulus,
    linear_loop,
    loop_gain,
    poles,
)

SPEEDS_KMH = (50, 70, 90, 110)
GAINS = (0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
CASES = [(car, speed) for car in sorted(CARS) for speed in SPEEDS_KMH]
SMALL = 1e-3
Parameters: TypeAlias = LoopParameters[ControllerParameters]


def hands_off(car: str, speed_kmh: float, preview_time: float = 1.5) -> Parameters:
    """Strong guidance alone, 1 mm beside the lane's centre."""
    setup = TrialSetup(
        condition="strong-normal",
        car=car,
        speed=speed_kmh / 3.6,
        driver="hands-off",
        intention="off",
        events=False,
        initial_offset=SMALL,
    )
    parameters = loop_parameters(setup)
    method = parameters.controller
    aimed = method.preview._replace(preview_time=preview_time)
    return parameters._replace(controller=method._replace(preview=aimed))


@cache
def loop(car: str, speed_kmh: float, compensated: bool = False) -> LinearLoop:
    return linear_loop(hands_off(car, speed_kmh), compensated)


def simulated(
    parameters: Parameters, compensated: bool, seconds: float
) -> NDArray[np.float64]:
    """Lateral position in the nonlinear loop without dry friction."""
    smooth = parameters.column._replace(friction=0.0)
    method = parameters.controller
    if not compensated:
        method = method._replace(column=smooth)
    rows = rollout(
        IBHS,
        parameters._replace(column=smooth, controller=method),
        Script(INTENTION_OFF, 3.0, np.zeros(0)),
        idle_network(),
        driver_noise(1, 1, "hands-off", round(seconds / DT)),
        "numba",
    )
    return rows[:, ROW_COLUMNS.index("lateral_position")]


def predicted(linear: LinearLoop, seconds: float) -> NDArray[np.float64]:
    """Lateral position of the linear loop from the same offset."""
    matrix = closed_loop(linear, 1.0)
    states = np.zeros(len(matrix))
    states[0] = SMALL
    positions = []
    for _ in range(round(seconds / DT)):
        positions.append(states[0])
        states = matrix @ states
    return np.array(positions)


def single_track(car: CarParameters, v: float) -> NDArray[np.float64]:
    """Textbook matrix of y, yaw, lateral velocity, yaw rate; road-wheel angle last."""
    front, rear = car.front_cornering_stiffness, car.rear_cornering_stiffness
    lf, lr, m, inertia = (
        car.front_distance,
        car.rear_distance,
        car.mass,
        car.yaw_inertia,
    )
    coupling = lr * rear - lf * front
    return np.array(
        [
            [0, v, 1, 0, 0],
            [0, 0, 0, 1, 0],
            [0, 0, -(front + rear) / (m * v), coupling / (m * v) - v, front / m],
            [
                0,
                0,
                coupling / (inertia * v),
                -(lf**2 * front + lr**2 * rear) / (inertia * v),
                lf * front / inertia,
            ],
            [0, 0, 0, 0, 0],
        ]
    )


@pytest.mark.parametrize(("car", "speed_kmh"), CASES)
def test_the_vehicles_block_is_the_textbooks(car: str, speed_kmh: float) -> None:
    # Without self-aligning torque the wheel stays where it is.
    parameters = hands_off(car, speed_kmh)
    loose = CARS[car]._replace(aligning_stiffness=0.0)
    block = linear_loop(parameters._replace(car=loose)).transition[:4, :4]
    exact = expm(single_track(CARS[car], speed_kmh / 3.6) * DT)
    # Runge-Kutta at 480 Hz is exact to 1e-8; the brush tyre bends by h / slide = 1e-5.
    np.testing.assert_allclose(block, exact[:4, :4], 2e-5, 1e-7)


@pytest.mark.parametrize(("car", "speed_kmh"), CASES)
def test_the_loop_is_stable_at_every_gain(car: str, speed_kmh: float) -> None:
    for gain in GAINS:
        assert largest_modulus(loop(car, speed_kmh), gain) < 1.0
    assert gain_margin(loop(car, speed_kmh), 1.0) > 1.3
    assert delay_margin(loop(car, speed_kmh), 1.0) > 0.06


@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("car", sorted(CARS))
def test_the_simulation_does_what_the_linear_loop_predicts(
    car: str, compensated: bool
) -> None:
    linear = predicted(loop(car, 70, compensated), 10.0)
    nonlinear = simulated(hands_off(car, 70), compensated, 10.0)
    # At 1 mm, 1.5 mN·m, tanh and tyre bend by parts in 1e4 at most.
    np.testing.assert_allclose(nonlinear, linear, rtol=0.0, atol=2e-4 * SMALL)


def test_a_small_offset_decays_at_the_rate_of_the_slowest_pole() -> None:
    slowest = poles(loop("large", 110), 1.0)[0]
    period = 2.0 * math.pi / abs(slowest.imag)
    position = simulated(hands_off("large", 110), False, 10.0 + 2.0 * period)
    early, late = (
        np.abs(position[int(start / DT) : int((start + period) / DT)]).max()
        for start in (10.0, 10.0 + period)
    )
    # A swing of 1.3 s is 77 samples: its peak is seen to 0.1 percent, and the poles
    # at -1.3/s have shrunk to 0.3 percent of it after 10 s.
    assert math.log(late / early) / period == pytest.approx(slowest.real, rel=0.02)


def test_far_too_long_a_preview_is_unstable_in_both() -> None:
    parameters = hands_off("large", 110, preview_time=4.0)
    linear = linear_loop(parameters)
    assert largest_modulus(linear, 1.0) > 1.0
    assert gain_margin(linear, 1.0) < 1.0
    assert delay_margin(linear, 1.0) == 0.0
    position = np.abs(simulated(parameters, False, 15.0))
    assert position[-120:].max() > 3.0 * SMALL
    assert position[-120:].max() > 2.0 * position[-480:-360].max()


@pytest.mark.parametrize(("car", "speed_kmh"), [("default", 50), ("large", 110)])
def test_the_gain_margin_is_where_stability_ends(car: str, speed_kmh: float) -> None:
    margin = gain_margin(loop(car, speed_kmh), 1.0)
    assert largest_modulus(loop(car, speed_kmh), margin * 0.999) < 1.0
    assert largest_modulus(loop(car, speed_kmh), margin * 1.001) > 1.0
    half = gain_margin(loop(car, speed_kmh), 0.5)
    assert half == pytest.approx(2.0 * margin)


@pytest.mark.parametrize(("car", "speed_kmh"), [("compact", 70), ("large", 110)])
@pytest.mark.parametrize("compensated", [False, True])
def test_the_delay_margin_is_where_stability_ends(
    car: str, speed_kmh: float, compensated: bool
) -> None:
    linear = loop(car, speed_kmh, compensated)
    gain = 0.4
    steps = delay_margin(linear, gain) / DT
    assert largest_modulus(linear, gain, math.floor(steps)) < 1.0
    assert largest_modulus(linear, gain, math.ceil(steps)) > 1.0


def test_a_closed_loop_on_the_brink_has_an_open_loop_of_one() -> None:
    linear = loop("default", 110)
    margin = gain_margin(linear, 1.0)
    values = np.linalg.eigvals(closed_loop(linear, margin))
    fastest = values[np.argmax(np.abs(values))]
    frequency = np.array([abs(np.angle(fastest)) / DT])
    # Bisection ends at 1e-9; conditioning costs some digits.
    assert loop_gain(linear, margin, frequency)[0] == pytest.approx(1.0, abs=1e-4)


def test_a_loop_that_nothing_can_upset_has_no_margin_to_tell() -> None:
    calm = LinearLoop(np.eye(7) * 0.5, np.full(7, 1e-9), np.ones(7))
    assert gain_margin(calm, 1.0) == math.inf
    assert delay_margin(calm, 1.0) == math.inf


def test_the_damping_ratio_is_that_of_the_worst_swing() -> None:
    # Two oscillators: -1 ± 3i and -2 ± 1i per second.
    rates = np.zeros((7, 7))
    rates[:2, :2] = [[-1.0, 3.0], [-3.0, -1.0]]
    rates[2:4, 2:4] = [[-2.0, 1.0], [-1.0, -2.0]]
    rates[4:, 4:] = np.diag([-1.0, -2.0, -3.0])
    swinging = LinearLoop(expm(rates * DT), np.zeros(7), np.zeros(7))
    assert damping_ratio(swinging, 1.0) == pytest.approx(1.0 / math.sqrt(10.0))
    aperiodic = LinearLoop(expm(-np.diag(np.arange(1.0, 8.0)) * DT), *np.zeros((2, 7)))
    assert damping_ratio(aperiodic, 1.0) == 1.0
