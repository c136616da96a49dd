"""Who learns and from which samples."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.intention.features import WINDOW_LENGTH
from costeer.training.dataset import (
    FIRST_PARTICIPANT,
    DatasetParameters,
    batches,
    full_windows,
    interesting,
    scaling,
    simulate_recordings,
    split_by_driver,
    windows,
)
from tests.training.synthetic import drive, drives

PARAMETERS = DatasetParameters()
SHORT = [drive(driver, num_changes=1) for driver in range(12)]


@given(st.integers(3, 12), st.integers(0, 10**6))
def test_no_driver_is_in_two_parts_and_none_is_lost(num: int, seed: int) -> None:
    recordings = SHORT[:num] + SHORT[:num]
    parts = split_by_driver(recordings, seed, PARAMETERS)
    names = [{r.driver for r in part} for part in parts]
    for one, other in itertools.combinations(names, 2):
        assert not one & other
    assert set.union(*names) == {r.driver for r in recordings}
    assert all(names)
    assert sum(len(part) for part in parts) == 2 * num


def test_the_split_depends_on_the_seed_only() -> None:
    once = split_by_driver(SHORT, 1, PARAMETERS)
    again = split_by_driver(SHORT[::-1], 1, PARAMETERS)
    other = split_by_driver(SHORT, 2, PARAMETERS)
    assert {r.driver for r in once.test} == {r.driver for r in again.test}
    assert {r.driver for r in once.test} != {r.driver for r in other.test}


def test_two_drivers_are_too_few() -> None:
    with pytest.raises(ValueError, match=r"2 driver.*at least 3"):
        split_by_driver(SHORT[:2], 1, PARAMETERS)


def test_a_window_is_full_after_180_valid_samples() -> None:
    features = np.zeros((600, 6))
    features[250, 3] = np.nan
    full = np.flatnonzero(full_windows(features))
    np.testing.assert_array_equal(
        full, np.concatenate([np.arange(179, 250), np.arange(430, 600)])
    )


def test_windows_end_where_their_label_says() -> None:
    recordings = drives(3)
    scale = scaling(recordings)
    data = windows(recordings, *scale, PARAMETERS)
    truth = np.concatenate([r.labels.positive for r in recordings])
    known = np.concatenate([r.labels.known for r in recordings])
    np.testing.assert_array_equal(data.positive, truth[data.ends])
    assert known[data.ends].all()


def test_no_window_reaches_into_another_recording() -> None:
    recordings = drives(3)
    data = windows(recordings, *scaling(recordings), PARAMETERS)
    starts = np.cumsum([0, *(len(r.side) for r in recordings)])
    first = np.searchsorted(starts, data.ends - WINDOW_LENGTH + 1, side="right")
    last = np.searchsorted(starts, data.ends, side="right")
    np.testing.assert_array_equal(first, last)


def test_weights_restore_natural_prevalence() -> None:
    recordings = drives(6)
    data = windows(recordings, *scaling(recordings), PARAMETERS)
    truth = np.concatenate([r.labels.positive for r in recordings])
    usable = np.concatenate(
        [full_windows(r.features) & r.labels.known for r in recordings]
    )
    natural = truth[usable].mean()
    weighted = np.average(data.positive, weights=data.weight)
    # Strides of 6 and 18 samples cut stretches of hundreds: a few percent at the edges.
    assert weighted == pytest.approx(natural, rel=0.05)
    assert data.positive.mean() > 1.1 * natural


def test_all_positives_are_of_interest() -> None:
    made = drive(1)
    assert interesting(made, PARAMETERS)[made.labels.positive].all()


def test_a_glance_far_from_any_lane_change_is_of_interest() -> None:
    made = drive(1, num_changes=1)
    rows = slice(30, 40)
    assert not interesting(made, PARAMETERS)[rows].any()
    made.features[rows, 0] = -0.5
    assert interesting(made, PARAMETERS)[rows].all()


def test_invalid_samples_are_in_no_window() -> None:
    recordings = drives(3)
    recordings[0].features[500:520] = np.nan
    data = windows(recordings, *scaling(recordings), PARAMETERS)
    assert not np.isin(data.ends, np.arange(500, 520 + WINDOW_LENGTH - 1)).any()


def test_windows_of_one_kind_are_refused() -> None:
    quiet = [drive(1, num_changes=0)]
    scale = scaling(drives(2))
    with pytest.raises(ValueError, match="hold 0 that precede a crossing"):
        windows(quiet, *scale, PARAMETERS)


def test_a_signal_that_never_changes_is_named() -> None:
    recordings = drives(3)
    for made in recordings:
        made.features[:, 0] = 0.0
    with pytest.raises(ValueError, match="head_yaw never changes"):
        scaling(recordings)


def test_without_a_valid_sample_there_is_no_scale() -> None:
    made = drive(1)
    made.features[:, 0] = np.nan
    with pytest.raises(ValueError, match="no sample"):
        scaling([made])


def test_a_pass_shows_each_window_once() -> None:
    recordings = drives(3)
    data = windows(recordings, *scaling(recordings), PARAMETERS)
    size = len(data.ends) // 4
    shown = list(itertools.islice(batches(data, size, seed=1), 4))
    last = np.concatenate([batch[:, -1] for batch, _, _ in shown])
    assert len(np.unique(last, axis=0)) == 4 * size
    window, truth, _ = shown[0]
    assert window.shape == (size, WINDOW_LENGTH, 6)
    assert truth.shape == (size,)


def test_simulated_drivers_are_not_those_of_studies_and_are_reproducible() -> None:
    once = simulate_recordings(2, seed=1, jobs=2)
    again = simulate_recordings(2, seed=1, jobs=1)
    names = [r.driver for r in once]
    assert names == [f"1-{FIRST_PARTICIPANT}", f"1-{FIRST_PARTICIPANT + 1}"]
    for one, other in zip(once, again, strict=True):
        np.testing.assert_array_equal(one.features, other.features)
        assert np.count_nonzero(one.intended) > 0
