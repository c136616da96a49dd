"""Torque perturbation of the held wheel."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import participant_driver
from costeer.loop.scenario import PILOT_SEED
from costeer.validation.arms import (
    ARM_RANGES,
    FREQUENCIES,
    PUBLISHED,
    TASKS,
    ArmRange,
    ArmTest,
    Signal,
    Spectrum,
    arm_admittance,
    arm_rows,
    arm_tests,
    arms_in_range,
    band,
    coefficients,
    perturbation,
    shaken,
)

USUAL = DriverParameters()
S = 2j * math.pi * FREQUENCIES


@cache
def dozen() -> dict[str, ArmTest]:
    people = [participant_driver(PILOT_SEED, n, 20.0) for n in range(1, 13)]
    return {test.task: test for test in arm_tests(people)}


def without_phase(size: Signal) -> Spectrum:
    return size.astype(np.complex128)


def impedance(task: str) -> Spectrum:
    """J s² + B s + K, and the reflex (1 - share) K Pade(s) / (1 + T s)."""
    hands = USUAL.arm
    tense = USUAL.reliance.cocontraction if task == "tense" else 1.0
    at_once = hands.intrinsic_share + tense - 1.0
    late = 1.0 - hands.intrinsic_share if task != "relaxed" else 0.0
    half = S * hands.reflex_delay / 2.0
    reflex = (1.0 - half) / (1.0 + half) / (1.0 + hands.lag * S)
    damping = hands.damping * math.sqrt(tense)
    elastic = hands.stiffness * (at_once + late * reflex)
    return np.asarray(hands.inertia * S**2 + damping * S + elastic)


@pytest.mark.parametrize("task", TASKS)
def test_admittance_is_that_of_mass_damper_spring_and_reflex(task: str) -> None:
    # Explicit muscles and an implicit wheel at 480 Hz: half a step or less of time,
    # 1 % at the resonance, where small terms are left.
    assert arm_admittance(USUAL, task) == pytest.approx(1.0 / impedance(task), rel=0.02)


def test_the_wheel_itself_does_not_show() -> None:
    # Without reflex, stiffness and damping only the arms' inertia is left.
    free = USUAL.arm._replace(stiffness=0.0, damping=0.0)
    found = arm_admittance(USUAL._replace(arm=free), "driving")
    # The second difference of a sine is smaller by (w dt)²/12, 0.14 % at 10 Hz.
    assert found == pytest.approx(1.0 / (free.inertia * S**2), rel=0.002)


def test_tense_arms_give_way_less_below_1_hz() -> None:
    slow = FREQUENCIES < 1.0
    size = {task: np.abs(test.admittance[:, slow]) for task, test in dozen().items()}
    # Intrinsic 35 % of the stiffness, all of it, 1.5 to 3 times it: far apart.
    assert (size["tense"] < 0.8 * size["driving"]).all()
    assert (size["driving"] < 0.6 * size["relaxed"]).all()


def test_inertia_rules_at_10_hz_whatever_the_task() -> None:
    size = {task: np.abs(test.admittance[:, -1]) for task, test in dozen().items()}
    # Stiffness over J w²: 32 of at most 355 N·m/rad.
    assert size["tense"] == pytest.approx(size["relaxed"], rel=0.1)
    assert size["driving"] == pytest.approx(size["relaxed"], rel=0.02)


def test_the_answer_is_linear() -> None:
    once = shaken(USUAL, "tense", perturbation())
    twice = shaken(USUAL, "tense", perturbation(2.0 * 0.3))
    for small, large in zip(once, twice, strict=True):
        assert large == pytest.approx(2.0 * small, rel=1e-9, abs=1e-12)


def test_two_engines_shake_alike() -> None:
    for task in TASKS:
        compiled = shaken(USUAL, task, perturbation()[:600])
        plain = shaken(USUAL, task, perturbation()[:600], engine="python")
        assert compiled[0] == pytest.approx(plain[0], rel=1e-12, abs=1e-15)
        assert compiled[1] == pytest.approx(plain[1], rel=1e-12, abs=1e-15)


def test_no_transient_is_left_in_the_measured_period() -> None:
    angles, _ = shaken(USUAL, "relaxed", perturbation())
    longer, _ = shaken(USUAL, "relaxed", np.tile(perturbation(), 2))
    assert coefficients(angles) == pytest.approx(coefficients(longer), rel=1e-4)


def effective_damping(test: ArmTest) -> NDArray[np.float64]:
    """Torque in phase with the rate, over it; negative where arms feed the motion."""
    impedance = 1.0 / test.admittance
    return np.asarray(impedance.imag / (2.0 * np.pi * test.frequency))


def test_relaxed_arms_damp_the_motion_and_a_late_reflex_takes_that_away() -> None:
    damping = effective_damping(dozen()["relaxed"])
    own = [participant_driver(PILOT_SEED, n, 20.0).arm.damping for n in range(1, 13)]
    # Half a step of muscle lag, K dt / 2, is 1 % of the damping.
    assert damping == pytest.approx(np.outer(own, np.ones(9)), rel=0.03)
    hands = USUAL.arm
    late = hands.stiffness * (1.0 - hands.intrinsic_share)
    wanted = hands.damping - late * (hands.lag + hands.reflex_delay)
    test = ArmTest("driving", FREQUENCIES, arm_admittance(USUAL, "driving")[None])
    # At 0.1 Hz the lag turns by w T = 0.06 rad, its square is left out; muscle lag as
    # above. What the reflex takes is as large as the damping, so the sum is near zero.
    found = effective_damping(test)[0, 0]
    assert found == pytest.approx(wanted, abs=0.03 * hands.damping)


def test_relaxed_and_driving_arms_are_of_the_assumed_size() -> None:
    relaxed = arms_in_range(dozen()["relaxed"])
    assert relaxed.mean() > 0.9  # the band is that of usual arms, not of everyone
    assert arms_in_range(dozen()["driving"])[:, :4].mean() > 0.9


def test_the_band_holds_all_arms_of_the_range_and_is_reached() -> None:
    generator = np.random.default_rng(1)
    for arms in ARM_RANGES.values():
        j, b, k = (generator.choice(each, 3000) for each in arms)
        j2, b2, k2 = (generator.uniform(*each, 3000) for each in arms)
        j, b, k = np.append(j, j2), np.append(b, b2), np.append(k, k2)
        size = np.abs(1.0 / (np.outer(j, S**2) + np.outer(b, S) + k[:, None]))
        limits = band(arms)
        assert (size >= limits.low * (1.0 - 1e-12)).all()
        assert (size <= limits.high * (1.0 + 1e-12)).all()
        # Corners are among them; inside a resonance 3000 draws come close.
        assert size.min(axis=0) == pytest.approx(limits.low, rel=1e-9)
        assert size.max(axis=0) == pytest.approx(limits.high, rel=0.1)


def test_the_band_of_one_arm_is_its_admittance() -> None:
    limits = band(ArmRange((0.1, 0.1), (0.5, 0.5), (10.0, 10.0)))
    size = np.abs(1.0 / (0.1 * S**2 + 0.5 * S + 10.0))
    assert limits.low == pytest.approx(size)
    assert limits.high == pytest.approx(size)


def test_what_lies_outside_the_band_is_seen() -> None:
    limits = PUBLISHED["tense"]
    soft = ArmTest("tense", FREQUENCIES, without_phase(1.01 * limits.high[None]))
    hard = ArmTest("tense", FREQUENCIES, without_phase(0.99 * limits.low[None]))
    assert not arms_in_range(soft).any()
    assert not arms_in_range(hard).any()
    assert [row.share_inside for row in arm_rows([soft])] == [0.0] * len(FREQUENCIES)


def test_a_row_holds_the_percentiles_of_the_drivers() -> None:
    sizes = np.linspace(1.0, 101.0, 101)[:, None] * np.ones(len(FREQUENCIES))
    (row, *rest) = arm_rows([ArmTest("relaxed", FREQUENCIES, without_phase(sizes))])
    assert row.percentiles == pytest.approx((6.0, 51.0, 96.0))
    assert [row.frequency, *(each.frequency for each in rest)] == FREQUENCIES.tolist()


def test_the_perturbation_is_made_of_equal_sines_that_begin_at_zero() -> None:
    assert coefficients(perturbation(1.0)) == pytest.approx(-1j * 10.0 * 480.0 / 2.0)
    assert perturbation()[0] == 0.0


def test_an_unknown_task_is_refused() -> None:
    with pytest.raises(ValueError, match="choose one of relaxed, driving, tense"):
        shaken(USUAL, "asleep", perturbation())
