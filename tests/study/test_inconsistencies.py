"""Inconsistencies are counted, timed and followed until the gain is back."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.study.definitions import MeasureParameters
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies
from tests.study.synthetic import faded_gain

DT = 1.0 / 60.0


def trial(*disputes: tuple[float, float], length: float = 20.0) -> dict[str, NDArray]:
    """A trial inconsistent in these spans [s], with the gain of Eqs. (10) to (13)."""
    time = np.arange(round(length / DT)) * DT
    consistent = np.ones(time.size, dtype=bool)
    for start, end in disputes:
        consistent[(time >= start - 1e-9) & (time < end - 1e-9)] = False
    return {
        "time": time,
        "consistent": np.ma.MaskedArray(consistent, mask=False),
        "haptic_gain": faded_gain(consistent),
    }


def found(columns: dict[str, NDArray]) -> tuple[Inconsistency, ...]:
    result = find_inconsistencies(columns)
    assert not isinstance(result, str)
    return result


def test_one_undisturbed_inconsistency() -> None:
    (only,) = found(trial((5.0, 6.5)))
    assert only.start_time == pytest.approx(5.0)
    assert only.duration == pytest.approx(1.5)
    assert only.num_flips == 0
    assert only.frozen_time == 0.0
    # 1 - (1 + tanh(4 (1.5 - 1)))/2, a step later than the last inconsistent sample.
    assert only.gain_minimum == pytest.approx((1 - np.tanh(2.0)) / 2, abs=3e-3)
    # Back at 0.95 when (1 + tanh(4 (t - 1)))/2 is 0.949, 1.366 s after the return.
    assert only.recovery_time == pytest.approx(1.5 + 1.366, abs=2 * DT)


def test_a_short_one_that_hardly_moves_the_gain_is_over_at_once() -> None:
    (only,) = found(trial((5.0, 5.3)))
    assert only.recovery_time == pytest.approx(0.3)
    assert only.gain_minimum > 0.95
    assert only.num_flips == 0


def test_verdicts_that_flip_are_one_inconsistency() -> None:
    (only,) = found(trial((5.0, 6.1), (6.3, 6.5), (6.7, 8.0)))
    assert only.num_flips == 4
    assert only.duration == pytest.approx(1.1 + 0.2 + 1.3)


def test_a_flip_half_way_freezes_the_gain() -> None:
    # Switched at K_h of 0.4, the new fade needs 0.3 s or more to move at 0.05 per s.
    (only,) = found(trial((5.0, 6.05), (6.35, 8.0)))
    assert 0.3 < only.frozen_time < 1.0


def test_separate_ones_are_counted_apart() -> None:
    assert [each.start_time for each in found(trial((5.0, 6.5), (12.0, 13.5)))] == (
        pytest.approx([5.0, 12.0])
    )


def test_one_that_outlasts_the_record_has_no_recovery() -> None:
    (only,) = found(trial((19.0, 21.0)))
    assert isnan(only.recovery_time)
    assert only.duration == pytest.approx(1.0 - DT)
    (returning,) = found(trial((18.0, 19.5)))
    assert isnan(returning.recovery_time)
    assert returning.num_flips == 0


def test_a_consistent_trial_has_none() -> None:
    assert found(trial()) == ()


def test_manual_driving_has_no_verdict() -> None:
    columns = trial()
    columns["consistent"] = np.ma.MaskedArray(columns["consistent"], mask=True)
    assert find_inconsistencies(columns) == (
        "needs the column consistent, undefined throughout"
    )


@given(st.lists(st.tuples(st.floats(1, 25), st.floats(0.05, 3)), max_size=5))
def test_all_inconsistent_time_belongs_to_some_inconsistency(
    spans: list[tuple[float, float]],
) -> None:
    columns = trial(*((a, a + b) for a, b in spans), length=40.0)
    total = np.count_nonzero(~columns["consistent"]) * DT
    each = found(columns)
    # The record goes on for 12 s after the last one, so each sample has its step.
    assert sum(one.duration for one in each) == pytest.approx(total, abs=1e-9)
    assert all(one.num_flips % 2 == 0 for one in each)


def test_the_gain_that_ends_one_is_a_parameter() -> None:
    early = MeasureParameters(recovery_gain=0.5)
    (only,) = find_inconsistencies(trial((5.0, 6.5)), early)
    # (1 + tanh(4 (t - 1)))/2 passes one half after 1 s, a little sooner from K_h > 0.
    assert only.recovery_time == pytest.approx(2.5, abs=2 * DT)
