"""Windows with head and speed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.intention.features import FEATURES, HEAD_YAW, full_windows
from costeer.training.datasets import brain4cars_head
from costeer.training.recordings import Recording
from tests.training.datasets.made import write, write_brain4cars_head

VELOCITY = FEATURES.index("longitudinal_velocity")
FRAMES = np.arange(151)


def read(folder: Path) -> list[Recording]:
    return brain4cars_head.read(folder / "brain4cars_head")


def test_the_head_is_over_90_degrees_from_the_median_left_positive(
    tmp_path: Path,
) -> None:
    write_brain4cars_head(tmp_path, 1)
    right, left = read(tmp_path)
    share = 0.6 / (np.pi / 2.0)
    assert right.features[:, HEAD_YAW].max() == pytest.approx(share)
    assert left.features[:, HEAD_YAW].min() == pytest.approx(-share)
    assert np.median(left.features[:, HEAD_YAW]) == 0.0


def test_a_lost_head_is_missing_and_the_window_stays(tmp_path: Path) -> None:
    yaw = np.where((FRAMES > 50) & (FRAMES < 60), np.nan, 0.3)
    write_brain4cars_head(tmp_path, 0, yaw=yaw)
    for run in read(tmp_path):
        lost = np.isnan(run.features[:, HEAD_YAW])
        # 9 frames of 0.04 s, and the way to and from them.
        assert lost.sum() / 60.0 == pytest.approx(0.4, abs=1.0 / 60.0)
        assert full_windows(run.features, run.absent)[180:].all()


def test_straight_windows_are_negative_to_their_end(tmp_path: Path) -> None:
    write_brain4cars_head(tmp_path, 0)
    for run in read(tmp_path):
        assert run.labels.known.all()
        assert not run.labels.positive.any()


def test_the_outer_lanes_have_one_run(tmp_path: Path) -> None:
    write_brain4cars_head(tmp_path, 0, "20141025_1", lane=1)
    write_brain4cars_head(tmp_path, 0, "20141026_2", lane=3)
    found = [(run.driver, int(run.side[0])) for run in read(tmp_path)]
    assert found == [("day 20141025", 1), ("day 20141026", -1)]


def test_a_lane_that_was_changed_to_was_there(tmp_path: Path) -> None:
    write_brain4cars_head(tmp_path, -1, lane=1)
    assert [int(run.side[0]) for run in read(tmp_path)] == [-1, 1]


def test_windows_without_head_or_speed_are_left_out_and_counted(
    tmp_path: Path,
) -> None:
    write_brain4cars_head(tmp_path, 0, "20141025_1")
    write_brain4cars_head(tmp_path, 0, "20141025_2", speed=np.nan)
    write_brain4cars_head(tmp_path, 0, "20141025_3", yaw=np.nan)
    runs = read(tmp_path)
    assert len(runs) == 2
    assert (
        "1 windows left out in which the head was never tracked, 1" in runs[0].notes[2]
    )


def test_a_window_begins_where_speed_does(tmp_path: Path) -> None:
    speed = np.where(FRAMES < 50, np.nan, 72.0)
    write_brain4cars_head(tmp_path, 1, speed=speed)
    for run in read(tmp_path):
        assert np.isfinite(run.features[:, VELOCITY]).all()
        assert len(run.side) == pytest.approx(100 * 2.4, abs=3)
        assert run.crossing[-1] == 1


def test_turns_are_left_out(tmp_path: Path) -> None:
    write_brain4cars_head(tmp_path, 0)
    write_brain4cars_head(tmp_path, 0, "20141025_2", label="lturn")
    assert len(read(tmp_path)) == 2


def test_a_window_that_only_one_table_has_is_refused(tmp_path: Path) -> None:
    write_brain4cars_head(tmp_path, 0)
    frames = tmp_path / "brain4cars_head" / "frames.csv.gz"
    other = {"label": "lchange", "sample": "b", "t": 0.0, "yaw": 0.1, "speed": 50.0}
    write(frames, other)
    with pytest.raises(ValueError, match=r"samples.csv has no row of lchange b"):
        read(tmp_path)
