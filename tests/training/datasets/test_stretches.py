"""From one drive to the runs to both sides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from costeer.intention.features import FEATURES, full_windows
from costeer.training.datasets.stretches import (
    Crossing,
    Stretch,
    both_runs,
    cut,
    pieces,
)
from tests.training.datasets.made import CROSSING, VELOCITY, WIDTH, drive

DISTANCE = FEATURES.index("distance_to_adjacent_lane")
YAW = FEATURES.index("yaw_angle")
HEAD = FEATURES.index("head_yaw")


def stretch(side: int = 1, **other: Any) -> Stretch:
    made = drive(side)
    return Stretch(
        driver="a",
        name="a",
        time=made.time,
        signals={
            "longitudinal_velocity": np.full(len(made.time), VELOCITY),
            "longitudinal_acceleration": np.zeros(len(made.time)),
            "yaw_angle": made.yaw,
        },
        to_left=WIDTH / 2.0 - made.inside,
        to_right=WIDTH / 2.0 + made.inside,
        crossings=[Crossing(CROSSING, side)],
    )._replace(**other)


def test_the_run_to_the_left_is_the_mirror_of_that_to_the_right() -> None:
    here, there = both_runs(stretch(1)), both_runs(stretch(-1))
    for one, other in ((here[0], there[1]), (here[1], there[0])):
        np.testing.assert_array_equal(one.features, other.features)
        np.testing.assert_array_equal(one.labels, other.labels)
        np.testing.assert_array_equal(one.intended, -other.intended)
        np.testing.assert_array_equal(one.side, -other.side)


@pytest.mark.parametrize("side", [1, -1])
def test_before_a_crossing_the_distance_falls_to_zero_and_yaw_points_there(
    side: int,
) -> None:
    towards = both_runs(stretch(side))[int(side == 1)]
    (row,) = np.flatnonzero(towards.intended)
    assert (towards.side == side).all()
    before = towards.features[row - 90 : row]
    assert (np.diff(before[:, DISTANCE]) < 0.0).all()
    # 0.1 s late at about 1.35 m/s.
    assert before[-1, DISTANCE] == pytest.approx(0.135, abs=0.03)
    assert (before[:, YAW] < 0.0).all()


def test_the_other_run_sees_the_distance_grow_and_is_negative() -> None:
    away = both_runs(stretch(1))[0]
    (row,) = np.flatnonzero(away.crossing)
    assert away.crossing[row] == 1
    assert not away.intended.any()
    assert not away.labels.positive.any()
    assert away.labels.known[:row].all()
    assert (np.diff(away.features[row - 90 : row, DISTANCE]) > 0.0).all()


def test_after_a_crossing_the_distance_is_that_in_the_new_lane() -> None:
    away, towards = both_runs(stretch(1))
    for run in (away, towards):
        distance = run.features[:, DISTANCE]
        assert distance[-1] == pytest.approx(WIDTH / 2.0)
        assert distance.min() >= 0.0
        assert distance.max() <= WIDTH
        (jump,) = np.flatnonzero(np.abs(np.diff(distance)) > 1.0)
        (row,) = np.flatnonzero(run.crossing)
        # The car is seen in the new lane one row and the delay later.
        assert 0 < jump + 1 - row <= 12


def test_positives_are_the_three_seconds_before_the_crossing() -> None:
    towards = both_runs(stretch(-1))[0]
    (row,) = np.flatnonzero(towards.intended)
    assert np.flatnonzero(towards.labels.positive).tolist() == [*range(row - 180, row)]
    assert np.flatnonzero(~towards.labels.known)[0] == len(towards.side) - 180


def test_known_lane_keeping_after_the_end_is_known() -> None:
    keeping = both_runs(stretch(1, crossings=[], keeps_lane=True))
    assert all(run.labels.known.all() for run in keeping)
    assert not any(run.labels.positive.any() for run in keeping)


def test_signals_that_are_not_given_are_absent_and_empty() -> None:
    run = both_runs(stretch(1, to_left=None, to_right=None))[0]
    assert run.absent == (
        "head_yaw",
        "steering_wheel_angle",
        "distance_to_adjacent_lane",
    )
    assert np.isnan(run.features[:, [HEAD, DISTANCE]]).all()
    assert full_windows(run.features, run.absent)[180:].all()


def test_a_run_ends_with_the_crossing_into_the_last_lane() -> None:
    made = drive(1)
    (away, towards) = both_runs(stretch(1, lane_left=~made.crossed))
    assert len(away.side) > len(towards.side)
    (row,) = np.flatnonzero(towards.intended)
    # The new lane is seen with the next row, at most 0.1 s later.
    assert 0 < len(towards.side) - row <= 7
    assert towards.labels.known.all()


def test_without_a_lane_on_a_side_there_is_no_run_to_it() -> None:
    none = np.zeros(len(drive(0).time), bool)
    runs = both_runs(stretch(1, crossings=[], lane_right=none))
    assert [run.name for run in runs] == ["a:left"]


def test_a_stretch_without_a_full_window_gives_nothing() -> None:
    short = cut(stretch(), drive(1).time < 3.0)
    assert [len(each.time) for each in short] == [30]
    assert both_runs(short[0]) == []
    assert both_runs(cut(stretch(), drive(1).time == 3.0)[0]) == []


def test_parts_keep_their_rows_and_crossings() -> None:
    time = drive(1).time
    parts = cut(stretch(keeps_lane=True), (time < 4.0) | (time > 6.0), time == 12.0)
    spans = [(part.time[0], part.time[-1]) for part in parts]
    assert spans == [(0.0, 3.9), (6.1, 11.9), (12.0, 15.9)]
    assert [len(part.crossings) for part in parts] == [0, 1, 0]
    assert [part.keeps_lane for part in parts] == [False, False, True]
    assert [part.name for part in parts] == ["a/0", "a/1", "a/2"]
    assert pieces(np.zeros(3, bool)) == []


def test_a_signal_by_another_name_is_refused() -> None:
    with pytest.raises(ValueError, match=r"no signal 'speed'; give head_yaw, longitud"):
        both_runs(stretch(1, signals={"speed": np.zeros(160)}))
    with pytest.raises(ValueError, match=r"yaw_angle has 3 rows and time 160"):
        both_runs(stretch(1, signals={"yaw_angle": np.zeros(3)}))
