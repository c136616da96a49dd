"""The quirks of the three NGSIM sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.intention.features import FEATURES
from costeer.training.datasets import (
    ngsim_commonroad,
    ngsim_i80_following,
    ngsim_lc,
)
from costeer.training.recordings import Recording
from tests.training.datasets.made import (
    CROSSING,
    VELOCITY,
    drive,
    write_events,
    write_ngsim_commonroad,
    write_ngsim_i80_following,
    write_ngsim_lc,
)

DISTANCE = FEATURES.index("distance_to_adjacent_lane")
YAW = FEATURES.index("yaw_angle")


def names(runs: list[Recording]) -> list[str]:
    return [run.name.split(":", 1)[1] for run in runs]


def read_lc(folder: Path) -> list[Recording]:
    return ngsim_lc.read(folder / "ngsim_lc")


def read_commonroad(folder: Path) -> list[Recording]:
    return ngsim_commonroad.read(folder / "ngsim_commonroad")


def read_i80(folder: Path) -> list[Recording]:
    return ngsim_i80_following.read(folder / "ngsim_i80_following")


def test_lane_keeping_is_negative_to_its_end(tmp_path: Path) -> None:
    write_ngsim_lc(tmp_path, 0)
    for run in read_lc(tmp_path):
        assert run.labels.known.all()
        assert not run.labels.positive.any()
        assert not run.crossing.any()


def test_sequences_that_hardly_moved_or_moved_two_lanes_are_left_out(
    tmp_path: Path,
) -> None:
    place = drive(1).place
    write_ngsim_lc(tmp_path, 1, "a", v=10.0)
    write_ngsim_lc(tmp_path, 1, "b", v=11.0, y=0.25 * place)
    write_ngsim_lc(tmp_path, -1, "c", v=12.0, y=place)
    write_ngsim_lc(tmp_path, 1, "d", v=13.0, y=1.5 * place)
    runs = read_lc(tmp_path)
    assert names(runs) == ["a:right", "a:left"]
    assert "3 because their label does not fit" in runs[0].notes[1]


def test_a_sequence_that_repeats_a_longer_one_is_left_out(tmp_path: Path) -> None:
    tail = slice(20, None)
    write_ngsim_lc(
        tmp_path,
        1,
        "a",
        t=drive(1).time[:-20],
        v=np.arange(160.0)[tail],
        vlat=drive(1).sideways[tail],
        psi=drive(1).yaw[tail],
        y=drive(1).place[tail],
    )
    write_ngsim_lc(tmp_path, 1, "b", v=np.arange(160.0))
    write_ngsim_lc(tmp_path, 1, "c", v=np.arange(160.0) + 0.5)
    runs = read_lc(tmp_path)
    assert names(runs) == ["b:right", "b:left", "c:right", "c:left"]
    assert runs[0].notes[1].startswith("1 sequences left out because they repeat")


def test_an_unknown_label_is_refused(tmp_path: Path) -> None:
    write_ngsim_lc(tmp_path, 1, "a", label="X")
    with pytest.raises(ValueError, match=r"a has the label 'X'; give L, R .* or K"):
        read_lc(tmp_path)


def test_the_leftmost_lane_has_no_lane_to_its_left(tmp_path: Path) -> None:
    write_ngsim_commonroad(tmp_path, 0, lane=0)
    assert names(read_commonroad(tmp_path)) == ["US101-7-0:right"]


def test_to_the_right_of_the_fifth_lane_is_one_if_a_vehicle_was_seen_there(
    tmp_path: Path,
) -> None:
    write_ngsim_commonroad(tmp_path, 0, lane=4)
    assert names(read_commonroad(tmp_path)) == ["US101-7-0:left"]
    write_ngsim_commonroad(tmp_path, 0, lane=5, track="US101-8-0")
    found = names(read_commonroad(tmp_path))
    assert found == ["US101-7-0:right", "US101-7-0:left", "US101-8-0:left"]


def test_a_vehicle_of_another_scenario_tells_nothing(tmp_path: Path) -> None:
    write_ngsim_commonroad(tmp_path, 0, lane=4)
    write_ngsim_commonroad(tmp_path, 0, lane=5, track="US101-8-0", src="other")
    assert "US101-7-0:right" not in names(read_commonroad(tmp_path))


def test_in_a_street_a_lane_is_there_if_a_vehicle_was_seen_in_it(
    tmp_path: Path,
) -> None:
    write_ngsim_commonroad(tmp_path, 0, lane=1, track="Lanker-1-0", site="Lanker")
    assert names(read_commonroad(tmp_path)) == ["Lanker-1-0:left"]
    write_ngsim_commonroad(tmp_path, 0, lane=2, track="Lanker-2-0", site="Lanker")
    assert "Lanker-1-0:right" in names(read_commonroad(tmp_path))


def test_crossings_to_and_fro_are_cut_out(tmp_path: Path) -> None:
    write_ngsim_commonroad(tmp_path, 0)
    write_events(tmp_path, "US101-7-0", [(7.95, 1), (8.95, -1)], "True")
    write_events(tmp_path, "US101-7-0", [(12.05, 1)], "False")
    runs = [run for run in read_commonroad(tmp_path) if run.side[0] == 1]
    # 60 Hz from 0.1 s to 7.9 s, and from 9.1 s to 15.9 s.
    assert [len(run.side) for run in runs] == [469, 409]
    assert [np.flatnonzero(run.crossing).size for run in runs] == [0, 1]
    assert not runs[0].labels.known[-180:].any()


def test_rows_outside_every_lane_are_cut_out(tmp_path: Path) -> None:
    outside = (drive(0).time > 7.0) & (drive(0).time < 8.0)
    lane, distance = np.where(outside, -1, 2), np.where(outside, np.nan, 1.8)
    write_ngsim_commonroad(tmp_path, 0, lane, d_left=distance, d_right=distance)
    runs = read_commonroad(tmp_path)
    assert len(runs) == 4
    assert all(np.isfinite(run.features[:, DISTANCE]).all() for run in runs)


def test_a_stretch_ends_where_a_distance_jumps_without_a_crossing(
    tmp_path: Path,
) -> None:
    width = np.where(drive(0).time < 8.0, 1.8, 3.0)
    write_ngsim_commonroad(tmp_path, 0, d_right=width)
    runs = [run for run in read_commonroad(tmp_path) if run.side[0] == -1]
    assert [set(run.features[:, DISTANCE]) for run in runs] == [{1.8}, {3.0}]


def test_one_number_at_one_site_is_one_driver(tmp_path: Path) -> None:
    for track in ("US101-7-0", "US101-7-1", "US101-8-0"):
        write_ngsim_commonroad(tmp_path, 0, track=track)
    drivers = [run.driver for run in read_commonroad(tmp_path)]
    assert drivers == ["US101-7"] * 4 + ["US101-8"] * 2


def test_followers_keep_12_feet_between_lines_left_of_the_edge(
    tmp_path: Path,
) -> None:
    write_ngsim_i80_following(tmp_path, lane=2)
    right, left = read_i80(tmp_path)
    np.testing.assert_allclose(
        right.features[:, DISTANCE] + left.features[:, DISTANCE], 3.66
    )
    # In the middle at 0 s, the first sample shows 0.5 s later, 0.1 m to the left.
    assert left.features[0, DISTANCE] == pytest.approx(1.83 - 0.1)
    assert (np.diff(left.features[:, DISTANCE]) < 0.0).all()


def test_a_follower_who_drifts_to_the_left_yaws_to_the_left(tmp_path: Path) -> None:
    write_ngsim_i80_following(tmp_path, lane=2)
    right, left = read_i80(tmp_path)
    np.testing.assert_allclose(left.features[:, YAW], -np.arctan(0.2 / VELOCITY))
    np.testing.assert_allclose(right.features[:, YAW], np.arctan(0.2 / VELOCITY))


def test_a_follower_never_crosses_and_lane_1_has_none_to_its_left(
    tmp_path: Path,
) -> None:
    write_ngsim_i80_following(tmp_path, lane=1)
    (right,) = read_i80(tmp_path)
    assert right.side[0] == -1
    assert not right.crossing.any()
    assert not right.labels.known[-180:].any()


def test_a_gap_in_the_frames_cuts_a_follower(tmp_path: Path) -> None:
    frames = 510.0 + np.arange(60) + 87.0 * (np.arange(60) >= 20)
    write_ngsim_i80_following(tmp_path, frame_id=frames)
    # The second part lasts 3.9 s, less 0.5 s for the yaw and 0.1 s for the delay.
    assert [len(run.side) for run in read_i80(tmp_path)] == [199] * 2


def test_one_stray_frame_is_no_reason_to_stop(tmp_path: Path) -> None:
    frames = 510.0 + np.arange(60) + 5.0 * (np.arange(60) >= 59)
    write_ngsim_i80_following(tmp_path, frame_id=frames)
    assert len(read_i80(tmp_path)) == 2


def test_the_crossing_without_lines_is_at_the_largest_lateral_speed(
    tmp_path: Path,
) -> None:
    write_ngsim_lc(tmp_path, -1)
    run = read_lc(tmp_path)[0]
    (row,) = np.flatnonzero(run.intended)
    assert 0.1 + row / 60.0 == pytest.approx(CROSSING, abs=1e-9)
