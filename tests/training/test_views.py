"""Recordings seen otherwise: as on a road with more lanes, or without some signals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.intention.features import DISTANCE, FEATURES, approach_series
from costeer.training.labels import labels
from costeer.training.recordings import Recording, lacking, recording, wide_views
from tests.training.synthetic import LANE_WIDTH, RATE, columns, drive

SIGNED = ("head_yaw", "steering_wheel_angle", "yaw_angle")
ONE_STEP = 0.03
"""Farther than the car moves sideways in 1/60 s, at most at 1.4 m/s [m]."""


def views(seed: int = 1) -> tuple[Recording, Recording]:
    """The run to the right and the run to the left of a drive with four crossings."""
    right, left = wide_views(drive(seed))
    return right, left


def crossings(seen: Recording, direction: int) -> NDArray[np.intp]:
    return np.flatnonzero(seen.crossing == direction)


def test_each_run_looks_to_its_side_throughout() -> None:
    right, left = views()
    assert set(right.side) == {-1}
    assert set(left.side) == {1}
    assert [right.name, left.name] == ["drive 1 to the right", "drive 1 to the left"]
    assert right.driver == left.driver == drive(1).driver


def test_where_the_side_agrees_a_sample_is_unchanged() -> None:
    made = drive(1)
    agreed = [made.side == seen.side for seen in views()]
    for seen, same in zip(views(), agreed, strict=True):
        assert 0 < same.sum() < same.size
        np.testing.assert_array_equal(seen.features[same], made.features[same])
    assert (agreed[0] ^ agreed[1]).all()


def test_the_run_to_the_right_sees_signals_as_measured_the_other_in_a_mirror() -> None:
    measured, (right, left) = columns(1), views()
    for place, name in enumerate(FEATURES):
        if place == DISTANCE:
            continue
        turn = -1.0 if name in SIGNED else 1.0
        np.testing.assert_array_equal(right.features[:, place], measured[name])
        np.testing.assert_array_equal(left.features[:, place], turn * measured[name])


@pytest.mark.parametrize("place", [0, 1])
def test_the_distance_runs_out_at_a_crossing_and_begins_anew(place: int) -> None:
    seen = views()[place]
    distance, side = seen.features[:, DISTANCE], int(seen.side[0])
    towards, away = crossings(seen, side), crossings(seen, -side)
    assert towards.size == away.size == 2
    # Over the line on this side: a lane's width to the next line.
    assert (distance[towards - 1] < ONE_STEP).all()
    assert (distance[towards] > LANE_WIDTH - ONE_STEP).all()
    # Over the line on the other side: that line is now the one on this side.
    assert (distance[away - 1] > LANE_WIDTH - ONE_STEP).all()
    assert (distance[away] < ONE_STEP).all()


@pytest.mark.parametrize("place", [0, 1])
def test_the_distance_shrinks_by_the_velocity_towards_the_line(place: int) -> None:
    seen = views()[place]
    within = np.diff(seen.features[:, DISTANCE]) * RATE
    no_crossing = seen.crossing[1:] == 0
    # Yaw angles are made for 20 m/s, the car drives 19 to 21: 5 % of 1.4 m/s.
    np.testing.assert_allclose(
        within[no_crossing], -approach_series(seen.features)[1:][no_crossing], atol=0.1
    )
    assert np.ptp(within[no_crossing]) > 2.0


@given(st.integers(0, 10**6))
def test_no_line_is_farther_than_a_lane_is_wide(seed: int) -> None:
    for seen in views(seed):
        distance = seen.features[:, DISTANCE]
        assert distance.min() >= 0.0
        assert distance.max() <= LANE_WIDTH


def test_both_lines_of_a_lane_are_a_lane_width_apart() -> None:
    right, left = views()
    total = right.features[:, DISTANCE] + left.features[:, DISTANCE]
    np.testing.assert_allclose(total, LANE_WIDTH, rtol=0, atol=1e-12)
    wider = sum(s.features[:, DISTANCE] for s in wide_views(drive(1), 3.75))
    np.testing.assert_allclose(wider, 3.75, rtol=0, atol=1e-12)


def test_a_crossing_to_one_side_is_no_positive_of_the_run_to_the_other() -> None:
    whole = drive(1)
    for seen in views():
        side = int(seen.side[0])
        for crossing in crossings(seen, side):
            assert seen.labels.positive[crossing - 120 : crossing].all()
        for crossing in crossings(seen, -side):
            assert not seen.labels.positive[crossing - 180 : crossing].any()
    right, left = (seen.labels.positive for seen in views())
    assert not (right & left).any()
    np.testing.assert_array_equal(right | left, whole.labels.positive)


def test_a_run_knows_all_crossings_and_has_to_find_those_to_its_side() -> None:
    made = drive(1)
    made.intended[crossings(made, -1)[0]] = 0  # one that the driver did not mean
    for seen in wide_views(made):
        side = seen.side[0]
        np.testing.assert_array_equal(seen.crossing, made.crossing)
        np.testing.assert_array_equal(seen.intended != 0, made.intended == side)
        np.testing.assert_array_equal(np.unique(seen.intended), np.sort([0, side]))
        np.testing.assert_array_equal(seen.labels.known, made.labels.known)


def in_a_mirror(measured: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    turned = {name: -measured[name] for name in SIGNED}
    return measured | turned | {"lane": 1 - measured["lane"]}


def test_a_mirrored_drive_swaps_the_runs() -> None:
    right, left = views()
    mirrored = wide_views(recording("driver 1", "drive 1", in_a_mirror(columns(1))))
    for seen, other in zip((left, right), mirrored, strict=True):
        np.testing.assert_array_equal(other.features, seen.features)
        np.testing.assert_array_equal(other.labels.positive, seen.labels.positive)
        np.testing.assert_array_equal(other.crossing, -seen.crossing)
        np.testing.assert_array_equal(other.side, -seen.side)


def test_labels_are_those_of_a_drive_that_looks_to_one_side() -> None:
    for seen in views():
        told = labels(seen.crossing, seen.side)
        np.testing.assert_array_equal(seen.labels.positive, told.positive)
        np.testing.assert_array_equal(seen.labels.known, told.known)


def test_a_lost_head_is_lost_in_both_runs_and_the_recording_stays() -> None:
    made = drive(1)
    made.features[100:130, 0] = np.nan
    before = made.features.copy()
    for seen in wide_views(made):
        lost = np.flatnonzero(np.isnan(seen.features).any(axis=1))
        np.testing.assert_array_equal(lost, np.arange(100, 130))
    np.testing.assert_array_equal(made.features, before)


def test_a_recording_that_lacks_signals_is_the_same_drive() -> None:
    made = drive(1)
    seen = lacking(lacking(made, ["yaw_angle"]), ("head_yaw",))
    assert seen.absent == ("head_yaw", "yaw_angle")
    assert lacking(seen, ("head_yaw",)).absent == seen.absent
    assert seen._replace(absent=()) == made
    assert lacking(made, ()).absent == ()
