"""Lane departures beside those of a Gaussian lane position."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate, linalg, stats

from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.records.columns import TrialRecord
from costeer.study.measures import trial_row
from costeer.validation.departures import (
    Departures,
    LaneHold,
    departures,
    gaussian_departures,
    lane_hold,
    summarise,
)
from costeer.validation.threads import in_threads

ROOM = 0.85
"""From the lane's centre until a wheel of the 1.8 m wide car is on the line [m]."""


def driver_departures(seed: int, number: int) -> Departures:
    """Of a population in manual driving, one trial each."""
    manual = TrialSetup(seed=seed, condition="manual", intention="off")
    setups = [manual._replace(participant=n) for n in range(1, number + 1)]
    return departures(
        in_threads(lambda setup: lane_hold(simulate_trial(setup)), setups, 2)
    )


@cache
def dozen() -> Departures:
    return driver_departures(PILOT_SEED, 12)


def array(value: float) -> NDArray[np.float64]:
    return np.array([value])


def test_at_one_deviation_the_rate_is_the_closed_form() -> None:
    # Of s = a and no bias, each side exp(-1/2) of s_rate / (2 pi s).
    found = gaussian_departures(array(ROOM), array(0.0), array(0.1))
    assert found == pytest.approx(0.1 / (math.pi * ROOM) * math.exp(-0.5))


def test_the_rate_is_the_integral_over_the_joint_density() -> None:
    # Rice: the flow of probability outward, the integral of v p(a, v) over v > 0.
    sdlp, mean, rate = 0.25, 0.1, 0.08
    flows = []
    for level, side in ((ROOM, 1.0), (-ROOM, -1.0)):
        density = stats.norm.pdf(level, mean, sdlp)
        outward, _ = integrate.quad(lambda v: v * stats.norm.pdf(v, 0.0, rate), 0, 1)
        flows.append(abs(side) * density * outward)
    found = gaussian_departures(array(sdlp), array(mean), array(rate))
    assert found == pytest.approx(sum(flows), rel=1e-6)


def test_a_bias_to_either_side_adds_departures_alike() -> None:
    sdlp, rate = np.full(3, 0.2), np.full(3, 0.08)
    left, centre, right = gaussian_departures(sdlp, np.array([0.1, 0.0, -0.1]), rate)
    assert left == right > centre


def wandering(
    sdlp: float, frequency: float, mean: float, seed: int
) -> NDArray[np.float64]:
    """A damped oscillator driven by white noise, shape `(time, chain)`, 20 Hz.

    Exact in distribution: transition and covariance are those of the continuous
    process x'' + 2 z w x' + w² x = noise with z = 0.7.
    """
    dt, damping = 0.05, 0.7
    pull = np.array([[0.0, 1.0], [-(frequency**2), -2.0 * damping * frequency]])
    move = linalg.expm(pull * dt)
    settled = sdlp**2 * np.diag([1.0, frequency**2])
    kick = np.linalg.cholesky(settled - move @ settled @ move.T)
    generator = np.random.default_rng(seed)
    num_steps, chains = 20_000, 300
    state = np.sqrt(settled) @ generator.standard_normal((2, chains))
    positions = np.empty((num_steps, chains))
    for k in range(num_steps):
        positions[k] = mean + state[0]
        state = move @ state + kick @ generator.standard_normal((2, chains))
    return positions


@pytest.mark.parametrize(
    ("sdlp", "mean"), [pytest.param(0.45, 0.0, marks=pytest.mark.slow), (0.35, 0.2)]
)
def test_a_simulated_gaussian_lane_position_departs_as_often(
    sdlp: float, mean: float
) -> None:
    frequency = 0.4
    over = np.abs(wandering(sdlp, frequency, mean, 3)) > ROOM
    count = int(np.count_nonzero(over[1:] & ~over[:-1]))
    seconds = 300 * 20_000 * 0.05
    expected = seconds * float(
        gaussian_departures(array(sdlp), array(mean), array(frequency * sdlp))[0]
    )
    assert count > 2000
    # Crossings come in clumps: three times Poisson's scatter. Samples at 20 Hz miss
    # excursions of less than 0.05 s, as the rate is rough: some 2 %.
    assert count == pytest.approx(expected, rel=0.02, abs=6.0 * math.sqrt(expected))


def record_of(position: NDArray[np.float64]) -> TrialRecord:
    """A drive along an empty road at 20 m/s with these lane positions."""
    time = np.arange(len(position)) / 60.0
    columns = {
        "time": time,
        "lateral_position": position,
        "longitudinal_position": 20.0 * time,
        "longitudinal_velocity": np.full(len(position), 20.0),
        "yaw_angle": np.zeros(len(position)),
        "event": np.zeros(len(position), np.int8),
    }
    return TrialRecord(metadata={}, columns=columns)


def test_a_sine_has_its_own_deviations_and_each_turn_is_a_departure() -> None:
    time = np.arange(6000) / 60.0
    found = lane_hold(record_of(0.1 + 0.9 * np.sin(0.5 * time)))
    # 100 s are 8 turns less 1 %; the left side is passed in each, the right is not:
    # 0.1 + 0.9 m and 0.1 - 0.9 m.
    assert found.num_departures == 8
    assert found.sdlp == pytest.approx(0.9 / math.sqrt(2.0), rel=0.02)
    assert found.mean_position == pytest.approx(0.1, abs=0.02)
    assert found.lateral_speed_deviation == pytest.approx(0.45 / math.sqrt(2), rel=0.02)
    assert found.mean_speed == 20.0
    assert found.distance == pytest.approx(2000.0, rel=0.001)


@pytest.mark.slow
def test_counts_and_sdlp_are_those_of_the_study() -> None:
    record = simulate_trial(
        TrialSetup(participant=2, seed=PILOT_SEED, condition="manual", intention="off")
    )
    row, found = trial_row(record), lane_hold(record)
    assert found.sdlp == row["sdlp"]
    assert found.num_departures == row["num_lane_departures"]
    assert found.distance == row["distance"]
    assert dozen().sdlp[1] == found.sdlp


def test_a_record_without_lane_positions_has_nothing() -> None:
    record = record_of(np.full(60, math.nan))
    assert np.isnan(lane_hold(record)).all()
    assert np.isnan(lane_hold(record_of(np.full(600, -3.5)))[:4]).all()


@pytest.mark.slow
def test_manual_departures_of_a_dozen_are_few() -> None:
    found = summarise(dozen())
    # 96 km: 0.02 per km would be two; six would be a chance of 1 %.
    assert found.num_departures < 6
    assert found.kilometres == pytest.approx(12 * 8.0, rel=0.01)
    # Of whom the mean has 0.19 m: once in hundreds of kilometres.
    assert 0.0 < found.gaussian_per_km < 0.1


def test_drivers_who_differ_depart_more_than_their_mean() -> None:
    holds = [
        LaneHold(sdlp, 0.0, 0.4 * sdlp, 20.0, 1.0, 8000.0) for sdlp in (0.15, 0.2, 0.25)
    ]
    found = summarise(departures(holds))
    assert found.counted_per_km == pytest.approx(3.0 / 24.0)
    own = [
        float(gaussian_departures(array(h.sdlp), array(0.0), array(0.4 * h.sdlp))[0])
        / 0.02
        for h in holds
    ]
    assert found.gaussian_per_km == pytest.approx(np.mean(own))
    assert found.usual_per_km == pytest.approx(own[1])
    assert found.gaussian_per_km > 3.0 * found.usual_per_km
    short = [holds[0], holds[1], holds[2]._replace(distance=4000.0)]
    assert summarise(departures(short)).gaussian_per_km == pytest.approx(
        (own[0] + own[1] + 0.5 * own[2]) / 2.5
    )


def test_who_keeps_no_lane_is_left_out() -> None:
    kept = LaneHold(0.2, 0.0, 0.08, 20.0, 1.0, 8000.0)
    nothing = math.nan
    never = LaneHold(nothing, nothing, nothing, nothing, 0.0, 8000.0)
    assert summarise(departures([kept, never])) == summarise(departures([kept]))
    with pytest.raises(ValueError, match="no driver has any lane keeping"):
        summarise(departures([never]))


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_200_fresh_drivers_depart_at_most_once_in_50_km() -> None:
    found = summarise(driver_departures(101, 200))
    assert found.counted_per_km <= 0.02
