"""Who learns and from which samples."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    NUM_INPUTS,
    NUM_SCALED,
    VARIANTS,
    WINDOW_LENGTH,
    approach_series,
    full_windows,
)
from costeer.training.augmentation import ALL_SIGNALS
from costeer.training.dataset import (
    DatasetParameters,
    batches,
    interesting,
    shown,
    split_by_driver,
    windows,
)
from costeer.training.recordings import lacking
from costeer.training.scaling import scaling
from costeer.training.simulation import FIRST_PARTICIPANT, simulate_recordings
from tests.training.synthetic import drive, drives

PARAMETERS = DatasetParameters()
ALL_NEEDED = np.zeros(NUM_FEATURES)
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


def test_windows_end_where_their_label_says() -> None:
    recordings = drives(3)
    data = windows(recordings, PARAMETERS)
    truth = np.concatenate([r.labels.positive for r in recordings])
    known = np.concatenate([r.labels.known for r in recordings])
    np.testing.assert_array_equal(data.positive, truth[data.ends])
    assert known[data.ends].all()


def test_no_window_reaches_into_another_recording() -> None:
    recordings = drives(3)
    data = windows(recordings, PARAMETERS)
    starts = np.cumsum([0, *(len(r.side) for r in recordings)])
    first = np.searchsorted(starts, data.ends - WINDOW_LENGTH + 1, side="right")
    last = np.searchsorted(starts, data.ends, side="right")
    np.testing.assert_array_equal(first, last)


def test_weights_restore_natural_prevalence() -> None:
    recordings = drives(6)
    data = windows(recordings, PARAMETERS)
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
    data = windows(recordings, PARAMETERS)
    assert not np.isin(data.ends, np.arange(500, 520 + WINDOW_LENGTH - 1)).any()


def test_windows_of_one_kind_are_refused() -> None:
    quiet = [drive(1, num_changes=0)]
    with pytest.raises(ValueError, match="hold 0 that precede a crossing"):
        windows(quiet, PARAMETERS)


def test_a_signal_that_never_changes_is_named() -> None:
    recordings = drives(3)
    for made in recordings:
        made.features[:, 0] = 0.0
    with pytest.raises(ValueError, match="head_yaw never changes"):
        scaling(recordings, ALL_NEEDED)


def test_without_a_valid_sample_there_is_no_scale() -> None:
    made = drive(1)
    made.features[:, 0] = np.nan
    with pytest.raises(ValueError, match="head_yaw never changes"):
        scaling([made], ALL_NEEDED)
    with pytest.raises(ValueError, match="yaw_angle never changes"):
        scaling([lacking(drive(1), ["yaw_angle"])], ALL_NEEDED)


def test_a_signal_that_is_not_needed_may_be_missing() -> None:
    made = lacking(drive(1), ["head_yaw"])
    scale = scaling([made], np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert scale.mean[0] == 0.0
    assert scale.scale[0] == 1.0
    assert (scale.scale > 0.0).all()


def test_scaling_is_of_the_samples_that_have_the_signal() -> None:
    recordings = drives(3)
    recordings[0].features[100:200, 0] = np.nan
    recordings[1] = lacking(recordings[1], ["yaw_angle"])
    scale = scaling(recordings, ALL_NEEDED)
    heads = np.concatenate([r.features[:, 0] for r in recordings])
    with_yaw = np.concatenate([recordings[i].features for i in (0, 2)])
    approach = approach_series(with_yaw)
    assert scale.mean.shape == scale.scale.shape == (NUM_SCALED,)
    # Sums of thousands of numbers in another order.
    assert scale.mean[0] == pytest.approx(np.nanmean(heads), rel=1e-9)
    assert scale.scale[0] == pytest.approx(np.nanstd(heads), rel=1e-9)
    assert scale.scale[5] == pytest.approx(with_yaw[:, 5].std(), rel=1e-9)
    assert scale.mean[6] == pytest.approx(approach.mean(), rel=1e-9)
    assert scale.scale[6] == pytest.approx(approach.std(), rel=1e-9)


def test_windows_keep_the_signals_in_their_units() -> None:
    recordings = drives(2)
    recordings[1] = lacking(recordings[1], ["head_yaw"])
    data = windows(recordings, PARAMETERS)
    rows = np.concatenate([r.features for r in recordings]).astype(np.float32)
    first = len(recordings[0].features)
    rows[first:, 0] = np.nan
    np.testing.assert_array_equal(data.features, rows)
    assert (data.ends >= first).any()


def test_a_head_that_is_lost_or_absent_costs_no_window() -> None:
    whole = windows(drives(3), PARAMETERS)
    recordings = [lacking(r, ["head_yaw"]) for r in drives(3)]
    for made in recordings:
        made.features[:, 0] = np.minimum(made.features[:, 0], 0.1)
    lost = drives(3)
    lost[0].features[900:1000, 0] = np.nan
    assert windows(recordings, PARAMETERS).ends.size == whole.ends.size
    data = windows(lost, PARAMETERS)
    here = np.arange(900, 1000 + WINDOW_LENGTH)
    assert np.isin(data.ends, here).sum() >= len(here) // (6 * 3)


def test_a_drive_with_all_signals_is_shown_on_a_wider_road_too() -> None:
    whole, blind = drive(1), lacking(drive(2), ["head_yaw"])
    found = [(r.name, r.absent) for r in shown([whole, blind])]
    assert found == [
        ("drive 1", ()),
        ("drive 2", ("head_yaw",)),
        ("drive 1 to the right", ()),
        ("drive 1 to the left", ()),
    ]


def test_a_pass_shows_each_window_once() -> None:
    recordings = drives(3)
    data = windows(recordings, PARAMETERS)
    size = len(data.ends) // 4
    drawn = batches(data, scaling(recordings, ALL_NEEDED), size, seed=1)
    seen = list(itertools.islice(drawn, 4))
    last = np.concatenate([batch.inputs[:, -1] for batch in seen])
    assert len(np.unique(last, axis=0)) == 4 * size
    assert seen[0].inputs.shape == (size, WINDOW_LENGTH, NUM_INPUTS)
    assert seen[0].positive.shape == (size,)


def test_a_batch_holds_windows_as_the_network_takes_them() -> None:
    recordings = drives(3)
    data, scale = windows(recordings, PARAMETERS), scaling(recordings, ALL_NEEDED)
    batch = next(batches(data, scale, 40, seed=1, augmentation=ALL_SIGNALS))
    assert (batch.inputs[..., NUM_SCALED:] == 0.0).all()
    signals = batch.inputs[..., :NUM_FEATURES] * scale.scale[:6] + scale.mean[:6]
    rows = data.features[data.ends[:, None] + np.arange(1 - WINDOW_LENGTH, 1)]
    for window, truth, weight in zip(
        signals, batch.positive, batch.weight, strict=True
    ):
        gaps = np.abs(rows - window).max(axis=(1, 2))
        (place,) = np.flatnonzero(gaps < 1e-4)  # float32 of numbers near 20
        assert (data.positive[place], data.weight[place]) == (truth, weight)


def test_batches_show_the_variants_that_are_asked_for() -> None:
    recordings = drives(3)
    data, scale = windows(recordings, PARAMETERS), scaling(recordings, np.ones(6))
    motion = ALL_SIGNALS._replace(full=0.0, motion=1.0, no_acceleration=0.0)
    batch = next(batches(data, scale, 40, seed=1, augmentation=motion))
    flags = batch.inputs[..., NUM_SCALED:]
    absent = [float(name in VARIANTS["motion"]) for name in FEATURES]
    assert (flags == absent).all()


def test_simulated_drivers_are_not_those_of_studies_and_are_reproducible() -> None:
    once = simulate_recordings(2, seed=1, jobs=2)
    again = simulate_recordings(2, seed=1, jobs=1)
    names = [r.driver for r in once]
    assert names == [f"1-{FIRST_PARTICIPANT}", f"1-{FIRST_PARTICIPANT + 1}"]
    for one, other in zip(once, again, strict=True):
        np.testing.assert_array_equal(one.features, other.features)
        assert one.absent == ()
        assert np.count_nonzero(one.intended) > 0
