"""Answers to a heading error, counted as in the experiment with people."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import NORMAL_DRAWS, DriverNoise
from costeer.drivers.population import hands_off, participant_driver
from costeer.loop.parameters import DT
from costeer.validation.people.onset import (
    SPEED,
    Correction,
    correction,
    onset_test,
    steering_onset,
)

PILOT = 900001


def quiet(num_steps: int = 150) -> np.ndarray:
    """No noise; uniform draws of 0.5."""
    normal = [0.0] * NORMAL_DRAWS
    uniform = [0.5] * (len(DriverNoise._fields) - NORMAL_DRAWS)
    return np.tile([*normal, *uniform], (num_steps, 1))


def answer(driver: DriverParameters, degrees: float) -> Correction:
    return steering_onset(driver, math.radians(degrees), quiet())


@pytest.mark.parametrize("rate", [3.5, 10.0, 30.0])
def test_a_wheel_that_starts_to_turn_is_seen_when_it_does(rate: float) -> None:
    # The smoothing over 11 frames sees a steep start up to 5 frames early.
    time = np.arange(180) * DT
    angle = np.radians(rate) * np.clip(time - 0.5, 0.0, 1.0)
    found = correction(angle)
    assert 0.5 - 5.0 * DT <= found.onset <= 0.5 + 2.0 * DT
    assert found.peak == pytest.approx(math.radians(rate))


def test_slow_drift_of_the_wheel_is_no_onset() -> None:
    time = np.arange(180) * DT
    # 1.2 deg/s count; the smoothing overshoots the start of the drift by a tenth.
    drifting = np.radians(1.0) * time
    turning = np.radians(20.0) * np.clip(time - 1.0, 0.0, 0.5)
    assert correction(drifting + turning).onset == pytest.approx(1.0, abs=0.09)


def test_a_driver_who_hardly_steers_has_no_onset() -> None:
    time = np.arange(180) * DT
    # 3 deg/s count, less a tenth as above.
    assert math.isnan(correction(np.radians(2.6) * time).onset)
    assert math.isnan(correction(-np.radians(20.0) * time).peak)


def test_nobody_at_the_wheel_corrects_nothing() -> None:
    assert math.isnan(answer(hands_off(SPEED), 2.0).onset)


def test_a_virtual_driver_steers_against_the_error() -> None:
    found = answer(participant_driver(PILOT, 1, SPEED), 2.0)
    # A swing back, which would count if the side were mistaken, comes later.
    assert 0.0 < found.onset < 0.75
    assert math.radians(1.0) < found.peak < math.radians(60.0)


def test_a_larger_error_is_corrected_with_a_larger_angle() -> None:
    driver = participant_driver(PILOT, 2, SPEED)
    assert answer(driver, 2.0).peak > answer(driver, 1.0).peak


@pytest.mark.slow
def test_a_test_repeats_itself_and_holds_both_errors() -> None:
    first = onset_test(PILOT, 3, repeats=2)
    assert first == onset_test(PILOT, 3, repeats=2)
    assert first.participant == 3
    assert len(first.onset) == len(first.peak) == 2
    assert all(math.isfinite(peak) for peak in first.peak)
