"""Steering reversals: as the authors' program counts them, and as sines demand."""

from __future__ import annotations

import csv
import gzip
from collections import defaultdict
from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from costeer.study.definitions import MeasureParameters
from costeer.study.reversals import (
    count_reversals,
    low_passed,
    steering_wheel_reversal_rate,
)

REFERENCE = Path(__file__).parents[1] / "data" / "swrr_reference"
RATE = 60.0


@cache
def sequences() -> dict[str, np.ndarray]:
    angles: dict[str, list[float]] = defaultdict(list)
    with gzip.open(REFERENCE / "sequences.csv.gz", "rt") as file:
        for row in csv.DictReader(file):
            angles[row["sequence"]].append(float(row["angle_deg"]))
    return {name: np.array(values) for name, values in angles.items()}


def reference_rows() -> list[dict[str, str]]:
    with (REFERENCE / "swrr_reference.csv").open() as file:
        return list(csv.DictReader(file))


def test_there_are_ninety_reference_rates() -> None:
    assert len(reference_rows()) == 90


@pytest.mark.parametrize(
    "row",
    reference_rows(),
    ids=lambda row: f"{row['sequence']}-{row['gap_deg']}-{row['lowpass_hz']}",
)
def test_rate_equals_that_of_the_authors_program(row: dict[str, str]) -> None:
    # metric_ReversalRate_VTEC.m in GNU Octave 7.3. Everything in degrees here: the
    # raw angle has steps of 0.1 deg, and ties are decided by the last bit.
    parameters = MeasureParameters(
        reversal_angle=float(row["gap_deg"]), reversal_cutoff=float(row["lowpass_hz"])
    )
    angle = sequences()[row["sequence"]]
    rate = float(row["rate_hz"])
    filtered = low_passed(angle, rate, parameters.reversal_cutoff)
    found = steering_wheel_reversal_rate([angle], rate, parameters)
    assert count_reversals(filtered, parameters.reversal_angle) == int(
        row["n_reversals"]
    )
    # The reference is printed with eight decimals.
    assert found.value == pytest.approx(float(row["swrr_per_min"]), abs=5.1e-9)


def sine(num_periods: int, amplitude: float, frequency: float = 0.25) -> np.ndarray:
    time = np.arange(round(num_periods / frequency * RATE) + 1) / RATE
    return np.asarray(amplitude * np.sin(2 * pi * frequency * time))


@pytest.mark.parametrize("num_periods", [1, 3, 10])
def test_a_sine_reverses_twice_a_period(num_periods: int) -> None:
    assert count_reversals(sine(num_periods, 2.0), gap=3.0) == 2 * num_periods - 1
    assert count_reversals(sine(num_periods, 4.0), gap=3.0) == 2 * num_periods


def test_a_gap_must_be_exceeded() -> None:
    zigzag = np.tile([0.0, 3.0], 5)
    assert count_reversals(zigzag, gap=3.0) == 0
    assert count_reversals(zigzag, gap=np.nextafter(3.0, 0.0)) == 8


def test_the_low_pass_halves_a_sine_at_its_cutoff() -> None:
    # Two passes of 1/√2. The ends of the record are left out: the filter needs a few
    # periods to forget how it was started.
    filtered = low_passed(sine(60, 1.0, frequency=0.6), RATE, 0.6)
    inside = filtered[1000:-1000]
    assert inside.max() == pytest.approx(0.5, abs=1e-4)


def test_without_cutoff_the_angle_is_left_alone() -> None:
    angle = sine(2, 1.0)
    assert low_passed(angle, RATE, 0.0) is angle


def test_the_low_pass_does_not_shift_an_impulse() -> None:
    impulse = np.zeros(601)
    impulse[300] = 1.0
    filtered = low_passed(impulse, RATE, 0.6)
    # Symmetric but for what the start of the filter leaves after 5 s.
    np.testing.assert_allclose(filtered, filtered[::-1], atol=1e-6)


angles = npst.arrays(
    np.float64, st.integers(1, 60), elements=st.integers(-8, 8).map(float)
)


@given(angles, st.integers(1, 6))
def test_mirrored_steering_reverses_as_often(angle: np.ndarray, gap: int) -> None:
    assert count_reversals(-angle, gap) == count_reversals(angle, gap)


@given(angles, st.integers(1, 6))
def test_an_offset_does_not_matter(angle: np.ndarray, gap: int) -> None:
    assert count_reversals(angle + 5.0, gap) == count_reversals(angle, gap)


@given(angles, st.integers(1, 6))
def test_degrees_or_radians_do_not_matter(angle: np.ndarray, gap: int) -> None:
    # A factor of two is exact; a true radian would move ties.
    assert count_reversals(angle / 64, gap / 64) == count_reversals(angle, gap)


@given(angles, st.integers(1, 6))
def test_a_larger_gap_never_counts_more(angle: np.ndarray, gap: int) -> None:
    assert count_reversals(angle, gap + 1) <= count_reversals(angle, gap)


def test_stretches_are_filtered_alone_and_summed() -> None:
    first, second = sine(10, np.radians(4.0)), sine(5, np.radians(4.0))
    both = steering_wheel_reversal_rate([first, second], RATE)
    minutes = (first.size - 1 + second.size - 1) / RATE / 60
    single = [
        steering_wheel_reversal_rate([angle], RATE).value * (angle.size - 1) / RATE / 60
        for angle in (first, second)
    ]
    assert both.value == pytest.approx(sum(single) / minutes, rel=1e-12)
    assert both.unit == "1/min"


def test_stretches_too_short_to_filter_are_left_out() -> None:
    angle = sine(10, np.radians(4.0))
    alone = steering_wheel_reversal_rate([angle], RATE)
    assert steering_wheel_reversal_rate([angle, angle[:6]], RATE) == alone
    assert "long enough" in steering_wheel_reversal_rate([angle[:6]], RATE).reason
    assert "long enough" in steering_wheel_reversal_rate([], RATE).reason


def test_too_slow_a_recording_has_no_rate() -> None:
    found = steering_wheel_reversal_rate([sine(10, 1.0)], rate=1.0)
    assert np.isnan(found.value)
    assert "1 samples per second are too few" in found.reason


def test_a_cutoff_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="below 30 Hz"):
        low_passed(sine(10, 1.0), RATE, 30.0)
    with pytest.raises(ValueError, match="5 samples are too few"):
        low_passed(np.zeros(5), RATE, 0.6)
