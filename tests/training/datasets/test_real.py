"""The real sets, where COSTEER_DATA names their folder; nothing of them is copied."""

from __future__ import annotations

import functools
import os
from pathlib import Path

import numpy as np
import pytest

from costeer.intention.features import FEATURES, full_windows
from costeer.training.datasets.catalogue import DATASETS, read_dataset
from costeer.training.recordings import Recording

pytestmark = pytest.mark.slow

YAW = FEATURES.index("yaw_angle")
HEAD = FEATURES.index("head_yaw")
DISTANCE = FEATURES.index("distance_to_adjacent_lane")


def data() -> Path:
    named = os.environ.get("COSTEER_DATA")
    if not named:
        pytest.skip("set COSTEER_DATA to the folder of the real sets")
    return Path(named)


@functools.cache
def read(name: str) -> list[Recording]:
    if not (data() / name).is_dir():
        pytest.skip(f"COSTEER_DATA has no folder {name}")
    return read_dataset(name, data())


def before(runs: list[Recording], column: int, seconds: float) -> list[np.ndarray]:
    """The last seconds before each crossing to the side of its run."""
    found = [
        run.features[max(0, row - round(60 * seconds)) : row, column]
        for run in runs
        for row in np.flatnonzero(run.intended)
    ]
    return [each for each in found if np.isfinite(each).any()]


@pytest.mark.parametrize("name", ["ngsim_lc", "ngsim_commonroad", "r3_driving"])
def test_cars_point_to_the_side_they_cross_to(name: str) -> None:
    means = [np.nanmean(each) for each in before(read(name), YAW, 2.0)]
    # Raw tracks and city junctions leave a few that do not.
    assert np.mean(np.array(means) < 0.0) > 0.95


@pytest.mark.parametrize("name", ["ngsim_commonroad", "r3_driving"])
def test_the_line_is_reached_at_the_crossing(name: str) -> None:
    last = [each[-1] for each in before(read(name), DISTANCE, 0.1)]
    assert -0.1 < np.median(last) < 0.25
    start = [each[0] for each in before(read(name), DISTANCE, 3.0)]
    assert np.median(start) > 1.2


def test_heads_turn_to_the_side_that_cars_change_to() -> None:
    looks = before(read("brain4cars_head"), HEAD, 4.0)
    further = [np.nanmin(each) + np.nanmax(each) < 0.0 for each in looks]
    # The set's description: a glance in 84 %, and in 15 % of straight windows.
    assert np.mean(further) > 0.7


def test_followers_keep_between_the_lines_of_their_lane() -> None:
    runs = read("ngsim_i80_following")
    distance = np.concatenate([run.features[:, DISTANCE] for run in runs])
    assert np.mean((distance > 0.3) & (distance < 3.36)) > 0.99
    # Nobody drives on average to one side, if the lines are where they should be.
    assert abs(np.mean(distance) - 1.83) < 0.1
    assert not any(run.crossing.any() for run in runs)


@pytest.mark.parametrize("name", DATASETS)
def test_most_samples_of_a_set_can_be_used(name: str) -> None:
    runs = read(name)
    full = np.concatenate([full_windows(run.features, run.absent) for run in runs])
    assert full.mean() > 0.45
    assert len({run.name for run in runs}) == len(runs)
    assert all(len({*map(len, run[2:6])}) == 1 for run in runs)
