"""What holds of every set: signs, mirror, units, errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from costeer.intention.features import FEATURES, full_windows
from costeer.training.datasets.catalogue import DATASETS, FILES, read_dataset
from costeer.training.recordings import Recording
from tests.training.datasets import made

WRITERS: dict[str, Callable[..., None]] = {
    name: getattr(made, f"write_{name}") for name in DATASETS
}
CHANGES = ("ngsim_lc", "ngsim_commonroad", "r3_driving", "brain4cars_head")
PLACES = ("ngsim_commonroad", "r3_driving")
ANGLES = {"brain4cars_head": "head_yaw"}


def runs(name: str, folder: Path, side: int) -> dict[int, Recording]:
    """The runs of one drive, by their side."""
    WRITERS[name](folder, side)
    return {int(run.side[0]): run for run in read_dataset(name, folder)}


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("name", CHANGES)
def test_before_a_crossing_the_run_to_its_side_turns_right(
    tmp_path: Path, name: str, side: int
) -> None:
    run = runs(name, tmp_path, side)[side]
    (row,) = np.flatnonzero(run.intended)
    assert run.intended[row] == side
    before = run.features[row - 120 : row]
    angle = before[:, FEATURES.index(ANGLES.get(name, "yaw_angle"))]
    assert angle.min() < -0.05
    assert angle.max() < 0.01
    assert run.labels.positive[row - 120 : row].all()


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("name", PLACES)
def test_before_a_crossing_the_distance_falls_to_zero(
    tmp_path: Path, name: str, side: int
) -> None:
    run = runs(name, tmp_path, side)[side]
    (row,) = np.flatnonzero(run.intended)
    distance = run.features[:, FEATURES.index("distance_to_adjacent_lane")]
    # The lines of one set shake by a millimetre.
    assert (np.diff(distance[row - 90 : row]) < 1e-3).all()
    assert 0.0 < distance[row - 1] < 0.25
    assert distance[row + 12] > 3.0
    assert distance[-1] == pytest.approx(made.WIDTH / 2.0, abs=0.01)


@pytest.mark.parametrize("name", CHANGES)
def test_a_mirrored_world_gives_the_same_network_inputs(
    tmp_path: Path, name: str
) -> None:
    left = runs(name, tmp_path / "left", 1)
    right = runs(name, tmp_path / "right", -1)
    assert {*left} == {*right} == {-1, 1}
    for side in (-1, 1):
        np.testing.assert_allclose(
            left[side].features, right[-side].features, atol=1e-9
        )
        np.testing.assert_array_equal(left[side].labels, right[-side].labels)


@pytest.mark.parametrize("name", CHANGES)
def test_the_crossing_is_where_it_was_made(tmp_path: Path, name: str) -> None:
    run = runs(name, tmp_path, 1)[1]
    (row,) = np.flatnonzero(run.crossing)
    if name == "brain4cars_head":
        assert row == len(run.side) - 1
    else:
        # The first sample is at 0.1 s; one set notes crossings between two frames.
        assert 0.1 + row / 60.0 == pytest.approx(made.CROSSING, abs=0.06)


@pytest.mark.parametrize("name", DATASETS)
def test_what_a_set_lacks_is_empty_and_the_rest_is_in_si_units(
    tmp_path: Path, name: str
) -> None:
    WRITERS[name](tmp_path, 2 if name == "ngsim_i80_following" else 1)
    for run in read_dataset(name, tmp_path):
        lacks = np.isnan(run.features).all(axis=0)
        assert tuple(np.array(FEATURES)[lacks]) == run.absent
        velocity = run.features[:, FEATURES.index("longitudinal_velocity")]
        assert np.allclose(velocity, made.VELOCITY)
        assert full_windows(run.features, run.absent).any()
        assert "late" in run.notes[0]


@pytest.mark.parametrize("name", DATASETS)
def test_a_missing_file_is_named_with_the_way_out(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    with pytest.raises(ValueError, match=rf"has no {name}/{FILES[name][0]}.*; name"):
        read_dataset(name, tmp_path)


def test_an_unknown_set_and_a_missing_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no set 'highd'; choose ngsim_lc, .*loader"):
        read_dataset("highd", tmp_path)
    with pytest.raises(ValueError, match=r"gone' is no folder; name the one that hold"):
        read_dataset("ngsim_lc", tmp_path / "gone")
