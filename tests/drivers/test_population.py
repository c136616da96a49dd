"""Population: the same person for the same numbers, and how people differ."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.base.packing import leaf_names, packed
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import Draw
from costeer.drivers.population import (
    FASTEST_REACTION,
    POPULATION_VERSION,
    POPULATIONS,
    REACTION_SPREAD,
    SECOND,
    PopulationParameters,
    driver_with,
    hands_off,
    participant_driver,
    population_of,
)
from costeer.drivers.population import USUAL as USUAL_DRIVERS
from costeer.drivers.registry import driver_named
from costeer.drivers.traits import Traits
from tests.drivers.samples import SPEED

NUM_DRIVERS = 400
USUAL = Traits(*([0.0] * len(Traits._fields)))
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


REACTION = "evasion.reaction_time"

LOG_NORMAL = {
    "tracking.wander_deviation": "wander_deviation_spread",
    "tolerance.band": "band_spread",
    "decision.change_duration": "duration_spread",
    "decision.headway": "headway_spread",
    "decision.return_headway": "headway_spread",
    "decision.patience": "patience_spread",
    "gaze.amplitude": "glance_spread",
    "vision.near_noise": "near_noise_spread",
    "vision.motor_noise": "near_noise_spread",
    "arm.inertia": "arm_spread",
    "arm.damping": "arm_spread",
}


@pytest.mark.parametrize("name", LOG_NORMAL)
def test_a_positive_quantity_is_log_normal_between_drivers(name: str) -> None:
    median = packed(DriverParameters())[NAMES.index(name)]
    spread = getattr(PopulationParameters(), LOG_NORMAL[name])
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
    "decision.shoulder_share": (0.0, 0.84),
    "longitudinal.overtaking_speed": (0.0, 5.0),
    "longitudinal.preferred_speed": (0.8 * SPEED, 1.2 * SPEED),
}


OF_TRAIT = {
    "lead_time": "vision.lead_time",
    "stiffness": "arm.stiffness",
    "reliance": "reliance.reliance",
    "cocontraction": "reliance.cocontraction",
    "lane_bias": "tracking.lane_bias",
    "shoulder": "decision.shoulder_share",
    "overtaking_speed": "longitudinal.overtaking_speed",
    "preferred_speed": "longitudinal.preferred_speed",
}


@pytest.mark.parametrize("trait", OF_TRAIT)
def test_no_trait_however_extreme_leaves_its_range(trait: str) -> None:
    name = OF_TRAIT[trait]
    ends = [
        packed(driver_with(USUAL._replace(**{trait: size}), SPEED))[NAMES.index(name)]
        for size in (-30.0, 30.0)
    ]
    assert ends == pytest.approx(RANGES[name])


@pytest.mark.parametrize("name", RANGES)
def test_a_bounded_quantity_stays_in_its_range_and_varies(name: str) -> None:
    low, high = RANGES[name]
    assert low <= drawn(name).min() < drawn(name).max() <= high


def test_noises_of_eye_and_hand_go_together() -> None:
    ratio = drawn("vision.near_noise") / drawn("vision.motor_noise")
    assert np.ptp(ratio) < 1e-12


def test_what_is_not_spread_is_everybodys() -> None:
    varied = {name for name in NAMES if np.ptp(drawn(name)) > 0.0}
    assert varied == {*LOG_NORMAL, *RANGES, REACTION}


def test_the_driver_without_any_trait_is_the_usual_one() -> None:
    assert driver_with(USUAL, SPEED) == DriverParameters()


@pytest.mark.parametrize("trait", Traits._fields)
def test_every_trait_moves_the_driver_a_little(trait: str) -> None:
    more = driver_with(USUAL._replace(**{trait: 1.0}), SPEED)
    moved = np.flatnonzero(packed(more) != packed(DriverParameters()))
    assert 1 <= moved.size <= 2


def test_the_population_says_its_version() -> None:
    assert POPULATION_VERSION == "3"


def test_the_population_before_is_still_there() -> None:
    # Numbers of population 2, as docs/decisions/0009-drivers-frozen.md has them.
    usual = SECOND.usual
    assert SECOND.version == "2"
    assert usual.tracking.wander_deviation == 0.19
    assert (usual.vision.near_noise, usual.vision.motor_noise) == (0.008, 0.0095)
    assert usual.tolerance.band == usual.correcting.evidence_rate == 0.0
    assert usual.learning.share == usual.reliance.leading_horizon == 0.0
    assert usual.vision.signal_noise == 0.0


@pytest.mark.parametrize("name", POPULATIONS)
def test_a_population_is_a_driver_model(name: str) -> None:
    model = driver_named(name)
    assert population_of(model) is POPULATIONS[name]
    drawn_one = model.parameters(Draw(seed=3, participant=2, speed=SPEED))
    assert drawn_one == participant_driver(3, 2, SPEED, POPULATIONS[name])


def test_somebody_elses_driver_is_no_population() -> None:
    assert population_of(driver_named("virtual")._replace(name="mine")) is None
    assert population_of(driver_named("virtual")._replace(version="0")) is None


def test_no_spread_gives_the_median_driver() -> None:
    none = PopulationParameters(*([0.0] * len(PopulationParameters._fields)))
    usual = DriverParameters()
    alike = USUAL_DRIVERS._replace(spreads=none)
    drawn_one = participant_driver(1, 1, SPEED, alike)
    # Reaction times in an emergency are drawn apart, with a spread of their own.
    assert drawn_one._replace(evasion=usual.evasion) == usual


def test_reaction_times_are_log_normal_and_none_is_below_the_shortest() -> None:
    times = drawn(REACTION)
    logs, error = np.log(times), 4.0 * REACTION_SPREAD / math.sqrt(NUM_DRIVERS)
    assert logs.mean() == pytest.approx(math.log(0.7), abs=error)
    assert logs.std(ddof=1) == pytest.approx(REACTION_SPREAD, abs=error / 2.0**0.5)
    assert times.min() >= FASTEST_REACTION == 0.3


def test_reaction_times_have_nothing_to_do_with_how_somebody_drives() -> None:
    others = [drawn(name) for name in (*LOG_NORMAL, *RANGES)]
    # Four standard errors of a correlation of none.
    for values in others:
        assert abs(np.corrcoef(values, drawn(REACTION))[0, 1]) < 4.0 / NUM_DRIVERS**0.5


def test_hands_off_holds_the_speed_and_nothing_else() -> None:
    nobody = hands_off(25.0)
    assert nobody.arm.hands_on == 0.0 == nobody.decision.decides
    assert nobody.gaze.false_rate == 0.0 == nobody.gaze.drift_deviation
    assert nobody.longitudinal.preferred_speed == 25.0
    assert nobody.longitudinal.speed_deviation == 0.0
