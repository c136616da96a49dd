"""What repeats is an oscillation; single corrections, however large, are not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.loop.parameters import DT
from costeer.validation.swing import (
    LEAST_DAMPING,
    MOST_KEPT,
    kept_after_a_period,
    without_drift,
)

TIME = np.arange(round(100.0 / DT)) * DT

Signal = NDArray[np.float64]


def swing(damping_ratio: float, frequency: float) -> Signal:
    """Free motion of the textbook oscillator; it grows if the ratio is negative."""
    turning = frequency * math.sqrt(1.0 - damping_ratio**2)
    return np.exp(-damping_ratio * frequency * TIME) * np.sin(turning * TIME)


def corrections(seed: int, every: float = 4.0) -> Signal:
    """Single movements at random times to random sides, each of 0.4 s and back."""
    random = np.random.default_rng(seed)
    signal, shape = np.zeros(len(TIME)), np.hanning(round(0.8 / DT))
    time = random.exponential(every)
    while time < 98.0:
        at = round(time / DT)
        signal[at : at + len(shape)] += random.normal() * shape
        time += 0.8 + random.exponential(every)
    return signal


def limit_cycle(period: float) -> Signal:
    """A wheel that sticks, jumps over and sticks: as little like a sine as can be."""
    return np.sign(np.sin(2.0 * np.pi * TIME / period))


@pytest.mark.parametrize("frequency", [0.6, 1.0, 3.0])
@pytest.mark.parametrize("ratio", [0.02, 0.05, 0.1, 0.2])
def test_of_a_decaying_swing_its_damping_is_left(
    frequency: float, ratio: float
) -> None:
    wanted = math.exp(-2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2))
    # The drift that is taken out is not quite none while a swing of 100 s decays.
    found = kept_after_a_period(swing(ratio, frequency))
    assert found == pytest.approx(wanted, abs=0.06)
    assert (found > MOST_KEPT + 0.06) is (ratio < LEAST_DAMPING / 1.5)


@pytest.mark.parametrize("period", [1.0, 3.0, 10.0])
def test_all_of_a_limit_cycle_is_found_again(period: float) -> None:
    assert kept_after_a_period(limit_cycle(period)) > 0.98
    assert kept_after_a_period(np.cos(2.0 * np.pi * TIME / period)) > 0.98


@pytest.mark.parametrize("ratio", [-0.01, -0.05, -0.2])
def test_all_of_a_growing_swing_is_found_again(ratio: float) -> None:
    assert kept_after_a_period(swing(ratio, 2.0)) > 0.98


@pytest.mark.slow
def test_single_corrections_do_not_repeat() -> None:
    found = [kept_after_a_period(corrections(seed)) for seed in range(200)]
    # Some 20 corrections fall into line by chance now and then.
    assert np.median(found) < 0.3
    assert np.mean(np.array(found) > MOST_KEPT) <= 0.05


def test_corrections_hide_no_oscillation_of_their_size() -> None:
    for seed in range(20):
        hidden = corrections(seed)
        cycle = 2.0 * hidden.std() * np.sin(2.0 * np.pi * TIME / 5.0)
        assert kept_after_a_period(hidden + cycle) > MOST_KEPT


@pytest.mark.parametrize("seed", range(5))
def test_one_large_correction_at_the_end_is_no_growing_oscillation(seed: int) -> None:
    signal, shape = corrections(seed), np.hanning(round(0.8 / DT))
    at = round(91.0 / DT)
    signal[at : at + len(shape)] += 40.0 * shape
    assert kept_after_a_period(signal) < MOST_KEPT


def test_drift_is_no_swing() -> None:
    drift = 0.5 * TIME + 3.0 * np.sin(0.1 * TIME)
    assert np.abs(without_drift(drift)).max() < 0.1 * 3.0
    assert kept_after_a_period(drift + limit_cycle(4.0)) > 0.9
    assert kept_after_a_period(np.zeros(len(TIME))) == 0.0


def test_a_signal_that_is_too_short_is_refused() -> None:
    with pytest.raises(ValueError, match="give at least 37"):
        kept_after_a_period(np.zeros(600))
