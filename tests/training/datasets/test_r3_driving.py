"""Which rows of the instrumented car count, and which crossings are lane changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.intention.features import FEATURES
from costeer.training.datasets import r3_driving
from costeer.training.recordings import Recording
from tests.training.datasets.made import drive, write, write_r3_driving

DISTANCE = FEATURES.index("distance_to_adjacent_lane")
TIME = drive(0).time
LATE = (TIME > 10.0) & (TIME < 11.0)


def read(folder: Path) -> list[Recording]:
    return r3_driving.read(folder / "r3_driving")


def rightwards(folder: Path) -> list[Recording]:
    return [run for run in read(folder) if run.side[0] == -1]


@pytest.mark.parametrize("late", [0.0, 0.2, 0.4])
def test_distances_change_lane_with_the_crossing_however_late_the_lines_do(
    tmp_path: Path, late: float
) -> None:
    write_r3_driving(tmp_path, 1, late=late)
    write_r3_driving(tmp_path / "prompt", 1, late=0.0)
    for one, prompt in zip(read(tmp_path), read(tmp_path / "prompt"), strict=True):
        np.testing.assert_allclose(one.features, prompt.features, atol=1e-9)


@pytest.mark.parametrize(
    ("clean", "late", "samples"),
    [("False", 0.3, [325, 253]), ("True", 5.0, [325])],
    ids=["not clean", "no jump soon"],
)
def test_what_is_no_lane_change_is_cut_out_with_3_s_around_it(
    tmp_path: Path, clean: str, late: float, samples: list[int]
) -> None:
    write_r3_driving(tmp_path, 1, clean=clean, late=late)
    runs = rightwards(tmp_path)
    assert not any(run.crossing.any() for run in runs)
    # Rows from 0.0 to 5.5 s, and from 11.6 s to 15.9 s or to the jump, which leaves
    # less than a window; each but its first period.
    assert [len(run.side) for run in runs] == samples


def test_a_line_that_is_far_away_is_not_crossed(tmp_path: Path) -> None:
    write_r3_driving(tmp_path, 1, left0=drive(1).inside - 3.0)
    assert not any(run.crossing.any() for run in read(tmp_path))


@pytest.mark.parametrize(
    "lost",
    [
        {"v": np.where(LATE, 4.0, 20.0)},
        {"v": np.where(TIME == 10.5, 60.0, 20.0)},
        {"left0": np.where(LATE, -1.0, -1.8)},
        {"right0": np.where(LATE, 4.0, 1.8)},
        {
            "left0_slope": np.where(LATE, 0.4, 0.0),
            "right0_slope": np.where(LATE, 0.4, 0.0),
        },
        {"left0": np.where(LATE, -1.875, -1.8), "right0": np.where(LATE, 1.875, 1.8)},
        {"right0": np.where(TIME > 10.5, 2.4, 1.8)},
    ],
    ids=["slow", "glitch", "narrow", "wide", "turning", "lost", "jump"],
)
def test_rows_that_are_not_along_seen_lines_end_the_stretch(
    tmp_path: Path, lost: dict[str, np.ndarray]
) -> None:
    shake = 0.001 * (np.round(TIME * 10.0) % 2)
    lines = {"left0": np.full(160, -1.8), "right0": np.full(160, 1.8)} | lost
    still = (lines["left0"] == -1.875) & (lines["right0"] == 1.875)
    lines |= {key: lines[key] + shake * ~still for key in ("left0", "right0")}
    write_r3_driving(tmp_path, 0, left1=-5.4, right1=5.4, **lines)
    assert len(rightwards(tmp_path)) == 2


def test_lines_that_stand_still_are_not_seen(tmp_path: Path) -> None:
    write_r3_driving(tmp_path, 0, left0=-1.8, right0=1.8)
    assert read(tmp_path) == []


def test_a_lane_is_there_if_the_next_line_is_a_lane_further_for_most_of_the_time(
    tmp_path: Path,
) -> None:
    flicker = np.where(np.arange(160) % 5 == 0, 2.2, 5.4)
    write_r3_driving(tmp_path, 0, left1=-2.5, right1=flicker)
    assert [int(run.side[0]) for run in read(tmp_path)] == [-1]


def test_both_lanes_of_a_lane_change_are_there(tmp_path: Path) -> None:
    write_r3_driving(tmp_path, 1, left1=-2.5, right1=2.5)
    right, left = read(tmp_path)
    assert right.side[0] == -1
    # To the left from 5 s before the crossing to it, to the right until 5 s after.
    assert len(left.side) == pytest.approx(300, abs=8)
    assert len(right.side) == pytest.approx(300, abs=8)
    assert left.intended.sum() == 1


def test_a_scenario_is_a_driver(tmp_path: Path) -> None:
    for scenario in ("scenario_001", "scenario_002"):
        write_r3_driving(tmp_path, 0, scenario)
    assert [run.driver for run in read(tmp_path)] == [
        *["scenario_001"] * 2,
        *["scenario_002"] * 2,
    ]


def test_a_crossing_at_the_last_frame_is_no_lane_change(tmp_path: Path) -> None:
    write_r3_driving(tmp_path, 0)
    entry = {"scenario": "scenario_001", "t_cross": 15.95, "side": "L", "clean": "True"}
    write(tmp_path / "r3_driving" / "crossings.csv", entry)
    assert not any(run.crossing.any() for run in read(tmp_path))
