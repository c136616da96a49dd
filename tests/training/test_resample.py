"""60 Hz without a look ahead."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.training.resample import (
    delayed,
    grid,
    held,
    sample_at,
    slope,
)

RATES = st.sampled_from([5.0, 10.0, 25.0, 30.0, 60.0])
NO_JUMPS = np.zeros(40, bool)


def rows(rate: float, num: int = 40) -> np.ndarray:
    return 3.0 + np.arange(num) / rate


@given(RATES)
def test_a_ramp_stays_a_ramp_one_period_late(rate: float) -> None:
    time = rows(rate)
    made = grid("a", time)
    samples = made.start + np.arange(len(made.latest)) / 60.0
    found = delayed(made, 2.0 * time, NO_JUMPS)
    # Times are rounded to a millionth of a sample.
    np.testing.assert_allclose(found, 2.0 * (samples - 1.0 / rate), atol=1e-5)


@given(RATES)
def test_samples_end_with_the_last_row_and_begin_when_two_are_known(
    rate: float,
) -> None:
    time = rows(rate)
    made = grid("a", time)
    last = made.start + (len(made.latest) - 1) / 60.0
    assert last == pytest.approx(time[-1], abs=1e-9)
    assert 0.0 <= made.start - time[1] + 1e-9 < 1.0 / 60.0 + 2e-9
    assert sample_at(made, time[-1]) == len(made.latest) - 1


@given(RATES, st.integers(1, 38), st.floats(-5.0, 5.0))
def test_what_comes_later_changes_nothing_before(
    rate: float, row: int, step: float
) -> None:
    time = rows(rate)
    made = grid("a", time)
    samples = made.start + np.arange(len(made.latest)) / 60.0
    values = np.sin(np.arange(40.0))
    other = np.where(np.arange(40) >= row, values + step, values)
    before = samples < time[row] - 1e-6
    np.testing.assert_array_equal(
        delayed(made, values, NO_JUMPS)[before], delayed(made, other, NO_JUMPS)[before]
    )
    np.testing.assert_array_equal(held(made, values)[before], held(made, other)[before])


def test_a_jump_is_not_interpolated() -> None:
    time = rows(10.0)
    values = np.where(np.arange(40) < 20, 0.0, 3.0)
    found = delayed(grid("a", time), values, np.arange(40) == 20)
    assert set(found) == {0.0, 3.0}
    smooth = delayed(grid("a", time), values, NO_JUMPS)
    assert len(set(smooth)) == 7


def test_a_missing_row_is_missing_as_long_as_it_is_needed() -> None:
    values = np.where(np.arange(40) == 20, np.nan, 1.0)
    found = np.isnan(delayed(grid("a", rows(10.0)), values, NO_JUMPS))
    # Five samples on the way to it, itself, five on the way from it.
    assert np.flatnonzero(found).tolist() == list(range(115, 126))


def test_a_crossing_is_at_the_first_sample_that_is_not_before_it() -> None:
    made = grid("a", np.arange(0.0, 2.0, 0.1).round(1))
    assert made.start == pytest.approx(0.1)
    assert [sample_at(made, t) for t in (0.1, 0.11, 0.2, 0.0)] == [0, 1, 6, -6]


def test_a_gap_and_times_that_do_not_rise_are_refused() -> None:
    time = np.array([0.0, 0.1, 0.2, 0.5, 0.6])
    with pytest.raises(ValueError, match=r"a: 0.3 s pass between rows 2 and 3"):
        grid("a", time)
    with pytest.raises(ValueError, match="a: time does not increase in row 2"):
        grid("a", np.array([0.0, 0.1, 0.1, 0.2]))


UNEVEN = [
    np.round(np.arange(200) / 60.0, 2),
    np.cumsum(np.random.default_rng(1).uniform(0.01, 0.05, 200)),
    np.delete(np.arange(80) / 20.0, [20, 21, 50]),
]


@pytest.mark.parametrize("time", UNEVEN)
def test_uneven_rows_give_even_samples_as_late_as_the_longest_step(
    time: np.ndarray,
) -> None:
    made = grid("a", time)
    samples = made.start + np.arange(len(made.latest)) / 60.0
    found = delayed(made, 2.0 * time, np.zeros(time.size, bool))
    late = 2.0 * (samples - np.diff(time).max())
    np.testing.assert_allclose(found, late, atol=1e-5)
    assert (time[made.latest] <= samples + 1e-6).all()
    assert samples[-1] == pytest.approx(time[-1])


@pytest.mark.parametrize("time", UNEVEN)
@pytest.mark.parametrize("row", [1, 30, 60])
def test_of_uneven_rows_too_what_comes_later_changes_nothing(
    time: np.ndarray, row: int
) -> None:
    made, none = grid("a", time), np.zeros(time.size, bool)
    samples = made.start + np.arange(len(made.latest)) / 60.0
    values = np.sin(np.arange(time.size))
    other = np.where(np.arange(time.size) >= row, 9.0, values)
    before = samples < time[row] - 1e-6
    np.testing.assert_array_equal(
        delayed(made, values, none)[before], delayed(made, other, none)[before]
    )
    np.testing.assert_array_equal(held(made, values)[before], held(made, other)[before])


def test_the_slope_is_that_of_half_the_span_ago() -> None:
    time = np.arange(0.0, 3.0, 0.1)
    found = slope(time, time**2, 0.5)
    assert np.isnan(found[:5]).all()
    # A line through a parabola has the slope at the middle of its rows.
    np.testing.assert_allclose(found[5:], 2.0 * (time[5:] - 0.25), atol=1e-9)
    assert np.isnan(slope(time[:4], time[:4], 0.5)).all()
