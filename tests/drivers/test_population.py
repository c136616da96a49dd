"""Population: the same person for the same numbers, and how people differ."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.base.packing import leaf_names, packed
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import (
    PopulationParameters,
    hands_off,
    participant_driver,
)
from tests.drivers.samples import SPEED

NUM_DRIVERS = 400
NAMES = leaf_names(DriverParameters())


@cache
def population(seed: int = 1) -> NDArray[np.float64]:
    """Parameters of many drivers, shape `(driver, parameter)`."""
    numbers = range(1, NUM_DRIVERS + 1)
    return np.array([packed(participant_driver(seed, n, SPEED)) for n in numbers])


def drawn(name: str) -> NDArray[np.float64]:
    return population()[:, NAMES.index(name)]


def test_a_driver_is_the_same_whatever_else_was_drawn() -> None:
    alone = participant_driver(5, 7, SPEED)
    np.random.default_rng(0).random(100)
    for other in (9, 1, 8):
        participant_driver(5, other, SPEED)
    assert participant_driver(5, 7, SPEED) == alone


def test_other_numbers_and_other_seeds_are_other_people() -> None:
    people = {participant_driver(seed, n, SPEED) for seed in (1, 2) for n in (1, 2, 3)}
    assert len(people) == 6


def test_the_suggested_speed_moves_the_preferred_speed_only() -> None:
    slow, fast = participant_driver(1, 1, 15.0), participant_driver(1, 1, 25.0)
    assert fast.longitudinal.preferred_speed > slow.longitudinal.preferred_speed
    same = slow.longitudinal._replace(preferred_speed=fast.longitudinal.preferred_speed)
    assert fast == slow._replace(longitudinal=same)


LOG_NORMAL = {
    "tracking.wander_deviation": (0.19, 0.18),
    "decision.change_duration": (6.9, 0.16),
    "decision.headway": (2.3, 0.12),
    "decision.return_distance": (28.0, 0.12),
    "gaze.amplitude": (0.29, 0.1),
    "vision.near_noise": (0.009, 0.2),
}


@pytest.mark.parametrize("name", LOG_NORMAL)
def test_a_positive_quantity_is_log_normal_between_drivers(name: str) -> None:
    median, spread = LOG_NORMAL[name]
    logs = np.log(drawn(name))
    # Four standard errors of mean and of standard deviation.
    error = 4.0 * spread / math.sqrt(NUM_DRIVERS)
    assert logs.mean() == pytest.approx(math.log(median), abs=error)
    assert logs.std(ddof=1) == pytest.approx(spread, abs=error / math.sqrt(2.0))


RANGES = {
    "vision.lead_time": (1.0, 2.5),
    "arm.stiffness": (8.0, 20.0),
    "reliance.reliance": (0.0, 1.0),
    "reliance.cocontraction": (1.5, 3.0),
    "tracking.lane_bias": (-0.2, 0.2),
    "longitudinal.overtaking_speed": (0.0, 5.0),
    "longitudinal.preferred_speed": (0.8 * SPEED, 1.2 * SPEED),
}


@pytest.mark.parametrize("name", RANGES)
def test_a_bounded_quantity_stays_in_its_range_and_varies(name: str) -> None:
    low, high = RANGES[name]
    assert low <= drawn(name).min() < drawn(name).max() <= high


def test_noises_of_eye_and_hand_go_together() -> None:
    ratio = drawn("vision.near_noise") / drawn("vision.motor_noise")
    assert np.ptp(ratio) < 1e-12


def test_what_is_not_spread_is_everybodys() -> None:
    varied = {name for name in NAMES if np.ptp(drawn(name)) > 0.0}
    assert varied == {*LOG_NORMAL, *RANGES, "vision.motor_noise"}


def test_no_spread_gives_the_median_driver() -> None:
    none = PopulationParameters(*([0.0] * len(PopulationParameters._fields)))
    usual = DriverParameters()
    assert participant_driver(1, 1, SPEED, none) == usual


def test_hands_off_holds_the_speed_and_nothing_else() -> None:
    nobody = hands_off(25.0)
    assert nobody.arm.hands_on == 0.0 == nobody.decision.decides
    assert nobody.gaze.false_rate == 0.0 == nobody.gaze.drift_deviation
    assert nobody.longitudinal.preferred_speed == 25.0
    assert nobody.longitudinal.speed_deviation == 0.0
