"""Virtual drivers in manual driving: swings, settling, the road's edges."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers.driver import DriverParameters
from costeer.drivers.evidence import gathered
from costeer.drivers.population import SECOND, participant_driver
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import PILOT_SEED, TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_OFF, Script
from costeer.loop.trial import idle_network, simulate_trial
from costeer.methods.manual import MANUAL
from costeer.plant.parameters import CARS
from costeer.records.row import ROW_COLUMNS
from costeer.validation.driver_loop import (
    STATES,
    least_damped,
    linear_core,
    poles,
    smooth,
    transition,
)
from costeer.validation.stability import (
    SPEEDS,
    Signal,
    Stability,
    StabilityBounds,
    driver_stability,
    edge_margin,
    every_stability,
    leaves_road,
    let_go,
    manual_setup,
    offset_run,
    oscillates,
    settling_time,
    swing_ratio,
    swings,
)

FRESH_SEED = 131
"""No driver was ever tuned on this seed."""

TIME = np.arange(3600) * DT


def loop_of(driver: DriverParameters, car: str, speed: float) -> LoopParameters[Any]:
    return loop_parameters(manual_setup(car, speed))._replace(driver=driver)


@cache
def dozen() -> Stability:
    return driver_stability(PILOT_SEED, 12)


@cache
def hundred(car: str, speed: float) -> NDArray[np.float64]:
    """The linear loops of a hundred drivers."""
    people = [participant_driver(PILOT_SEED, n, speed) for n in range(1, 101)]
    return transition(loop_parameters(manual_setup(car, speed)), people)


def sluggish() -> DriverParameters:
    """A driver who sees everything half a second late and steers all the more."""
    usual = DriverParameters()
    eyes = usual.vision._replace(delay=0.5, far_gain=10.0, near_gain=40.0)
    return usual._replace(vision=eyes)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("car", CARS)
def test_the_linear_loop_goes_the_way_of_the_simulation(car: str, speed: float) -> None:
    driver = participant_driver(PILOT_SEED, 3, speed)
    pedals = driver.longitudinal._replace(preferred_speed=speed)  # linear at one speed
    driver = linear_core(driver._replace(longitudinal=pedals))
    parameters = loop_of(driver, car, speed)
    (matrix,) = transition(parameters, [driver])
    simulated = offset_run(smooth(parameters), 0.01)
    # The arm's angle is delayed by a filter whose memory starts at rest, as here.
    x, linear = np.eye(len(STATES))[0] * 0.01, []
    for _ in range(600):
        linear.append(x[0])
        x = matrix @ x
    # A centimetre is hardly nonlinear: angles of 0.01 / 8 rad, whose cube counts.
    assert simulated[:600] == pytest.approx(np.array(linear), abs=2e-6)


def test_many_drivers_at_once_give_what_each_gives_alone() -> None:
    people = [participant_driver(PILOT_SEED, n, 20.0) for n in (1, 2, 3)]
    parameters = loop_parameters(manual_setup("default", 20.0))
    alone = np.concatenate([transition(parameters, [each]) for each in people])
    assert transition(parameters, people) == pytest.approx(alone, rel=1e-12, abs=1e-12)


def test_least_damped_is_the_swing_of_the_textbook() -> None:
    # s² + 2 z w s + w² of w = 2 rad/s, z = 0.3, and a faster one with z = 0.5.
    rates = []
    for frequency, ratio in ((2.0, 0.3), (7.0, 0.5)):
        turning = frequency * math.sqrt(1.0 - ratio**2)
        rates += [complex(-frequency * ratio, sign * turning) for sign in (1, -1)]
    found = least_damped(np.array([[*rates, -1.0 + 0j], [-1.0 + 0j] * 5]))
    assert found[0] == pytest.approx([0.3, 1.0])
    assert found[1] == pytest.approx([2.0, math.nan], nan_ok=True)


def test_what_is_slower_than_a_swing_does_not_count() -> None:
    assert least_damped(np.array([[-0.01 + 0.4j, -0.01 - 0.4j]]))[0] == [1.0]


def test_what_stays_as_it_is_has_no_rate_and_does_not_swing() -> None:
    ratio, frequency = least_damped(poles(np.eye(2)[None]))
    assert ratio == [1.0]
    assert np.isnan(frequency).all()


def test_a_memory_that_is_gone_after_a_step_has_a_finite_rate() -> None:
    assert np.isfinite(poles(np.zeros((1, 2, 2)))).all()


def test_swings_of_a_decaying_oscillation_shrink_by_the_textbook_ratio() -> None:
    ratio, frequency = 0.2, 2.0
    turning = frequency * math.sqrt(1.0 - ratio**2)
    signal = np.exp(-ratio * frequency * TIME) * np.cos(turning * TIME)
    # exp(-pi z / sqrt(1 - z²)) from peak to peak, sampled at 60 Hz.
    wanted = math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))
    size = swings(signal)[1:5]  # the first starts at its value, not at a peak
    assert size[1:] / size[:-1] == pytest.approx(wanted, rel=1e-3)
    assert wanted <= swing_ratio(signal) < 0.63


def test_an_oscillation_that_lasts_has_ratio_one_and_never_settles() -> None:
    signal = 0.5 * np.cos(TIME)
    assert swing_ratio(signal) == pytest.approx(1.0, abs=1e-3)
    assert settling_time(signal) == math.inf


def test_swings_within_what_is_let_go_do_not_count() -> None:
    signal = 0.5 * np.exp(-TIME) + 0.15 * np.cos(TIME)
    assert swing_ratio(signal) > 0.9
    assert settling_time(signal) == math.inf
    assert swing_ratio(signal, 0.2) == 0.0
    assert settling_time(signal, 0.2) < 3.0
    assert swing_ratio(0.5 * np.cos(TIME), 0.2) > 0.9  # beyond it they do


def test_ripples_of_millimetres_are_no_swings() -> None:
    assert swing_ratio(0.5 * np.exp(-TIME) + 0.001 * np.sin(5.0 * TIME)) == 0.0


def test_settling_time_is_when_the_last_excursion_ends() -> None:
    signal = np.where(TIME < 2.0, 0.5, 0.05)
    assert settling_time(signal) == pytest.approx(2.0, abs=DT)
    assert settling_time(0.05 * np.ones(10)) == 0.0


@pytest.mark.slow
def test_nobody_of_a_dozen_swings_or_leaves_the_road() -> None:
    found = dozen()
    assert not oscillates(found).any()
    assert not leaves_road(found).any()


def test_the_damping_is_far_from_the_bound() -> None:
    # Of 1000 drivers none had less than 0.31; a third less tells of another model.
    matrices = hundred("default", 70.0 / 3.6)
    assert least_damped(poles(matrices))[0].min() > 0.2


@pytest.mark.parametrize(
    "car",
    [c if c == "default" else pytest.param(c, marks=pytest.mark.slow) for c in CARS],
)
def test_no_driver_swings_in_any_car_at_any_speed(car: str) -> None:
    for speed in SPEEDS:
        matrices = hundred(car, speed)
        assert np.abs(np.linalg.eigvals(matrices)).max() < 1.0
        ratio, _ = least_damped(poles(matrices))
        assert ratio.min() > StabilityBounds().damping_ratio


def test_a_sluggish_driver_is_seen_by_both_looks() -> None:
    speed = 70.0 / 3.6
    parameters = loop_of(sluggish(), "default", speed)
    matrices = transition(parameters, [sluggish()])
    assert np.abs(np.linalg.eigvals(matrices)).max() > 1.0
    assert least_damped(poles(matrices))[0] < 0.0
    room = let_go(sluggish(), speed)
    signal = offset_run(smooth(parameters), 0.5 + room)
    assert swing_ratio(signal, room) > 0.8
    assert settling_time(signal, room) == math.inf


@pytest.mark.parametrize("speed", SPEEDS)
def test_what_is_let_go_is_where_the_evidence_is_never_complete(speed: float) -> None:
    driver = participant_driver(PILOT_SEED, 5, speed)
    own, near = driver.tolerance, speed * driver.vision.near_time
    rule = own.evidence_rate, own.band, own.forgetting_time
    for share, corrects in ((0.49, False), (0.51, True)):  # half of it: no drift
        beside = share * let_go(driver, speed)
        asked = driver.vision.near_gain / speed * math.atan(beside / near)
        evidence = 0.0
        for _ in range(round(1000.0 / DT)):
            evidence = min(gathered(*rule, evidence, asked, DT), 1.0)
        assert (evidence == 1.0) is corrects
    assert let_go(participant_driver(PILOT_SEED, 5, speed, SECOND), speed) == 0.0


@pytest.mark.parametrize("speed", SPEEDS)
def test_who_lets_go_drifts_about_the_aim_and_no_farther(speed: float) -> None:
    for number in range(1, 7):
        driver = participant_driver(PILOT_SEED, number, speed)
        parameters, room = loop_of(driver, "default", speed), let_go(driver, speed)
        signal = offset_run(smooth(parameters), 0.5 + room)
        late = np.abs(signal[round(30.0 / DT) :])
        # It does not come to rest at the aim, does not grow, and stays in the lane.
        assert 0.2 * room < late.max() < room + 0.02
        assert swing_ratio(signal, room) == 0.0
        assert late.max() < 1.75 - CARS["default"].width / 2.0


def test_without_tolerance_nobody_swings_a_second_time() -> None:
    for number in range(1, 7):
        driver = participant_driver(PILOT_SEED, number, 20.0, SECOND)
        signal = offset_run(smooth(loop_of(driver, "default", 20.0)))
        assert swing_ratio(signal) == 0.0
        assert settling_time(signal) < 4.0


def test_each_fault_is_told() -> None:
    good = Stability("default", 20.0, *([np.ones(1)] * 7))._replace(
        largest_modulus=np.array([0.99]), swing_ratio=np.zeros(1)
    )
    assert not oscillates(good)[0]
    bad = {
        "largest_modulus": 1.0,
        "damping_ratio": 0.05,
        "swing_ratio": 0.9,
        "settling_time": math.inf,
    }
    for name, value in bad.items():
        parts = {**good._asdict(), name: np.array([value])}
        assert oscillates(Stability(**parts))[0]
    assert not leaves_road(good._replace(edge_margin=np.array([-0.4])))[0]
    assert leaves_road(good._replace(edge_margin=np.array([-0.6])))[0]
    assert leaves_road(good._replace(edge_margin=np.array([math.nan])))[0]


def test_the_edge_margin_is_that_of_the_nearer_edge() -> None:
    setup = TrialSetup(participant=2, seed=PILOT_SEED, intention="off")
    position = simulate_trial(setup).columns["lateral_position"]
    # Wheels 0.9 m beside the middle; lines at +1.75 m and -5.25 m.
    assert edge_margin(setup) == pytest.approx(
        min(1.75 - 0.9 - position.max(), position.min() - 0.9 + 5.25)
    )


def lane_position(number: int, friction: float) -> Signal:
    """Ten minutes of lane keeping with the driver's noise, without the start."""
    speed = 70.0 / 3.6
    driver = participant_driver(PILOT_SEED, number, speed)
    parameters = loop_parameters(manual_setup("default", speed, 600.0))
    parameters = parameters._replace(
        driver=driver, column=parameters.column._replace(friction=friction)
    )
    noise = driver_noise(PILOT_SEED, number, "friction", round(550.0 / DT))
    script = Script(INTENTION_OFF, 3.0, np.empty(0))
    rows = rollout(MANUAL, parameters, script, idle_network(), noise, "numba")
    return rows[round(10.0 / DT) :, ROW_COLUMNS.index("lateral_position")]


@pytest.mark.slow  # a population of its own
def test_with_the_drivers_noise_dry_friction_hardly_adds_to_the_drift() -> None:
    # Without noise the same friction lets them hunt by a decimetre.
    assert np.median(dozen().hunting) > 0.05
    numbers = range(1, 9)
    with_it, without = (
        np.mean([lane_position(n, friction).std() for n in numbers])
        for friction in (0.25, 0.0)
    )
    # Same noise in both, so the difference is the friction's: 3 % of 0.18 m.
    assert with_it < 1.1 * without


@pytest.mark.slow
def test_progress_counts_drivers_and_threads_change_nothing() -> None:
    told: list[int] = []
    alone = driver_stability(PILOT_SEED, 2, jobs=1, progress=told.append)
    together = driver_stability(PILOT_SEED, 2, jobs=2)
    assert told == [1, 1]
    for name in Stability._fields[2:]:
        assert (getattr(alone, name) == getattr(together, name)).all()


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_nobody_of_1000_swings_or_leaves_the_road() -> None:
    found = driver_stability(FRESH_SEED, 1000)
    assert np.flatnonzero(oscillates(found)).tolist() == []
    assert np.flatnonzero(leaves_road(found)).tolist() == []


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_nobody_swings_or_leaves_the_road_in_any_car_at_any_speed() -> None:
    for found in every_stability(FRESH_SEED, 20):
        assert not oscillates(found).any(), f"{found.car} at {found.speed}"
        assert not leaves_road(found).any(), f"{found.car} at {found.speed}"
