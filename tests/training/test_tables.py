"""Tables that lack signals or lanes, or come at another rate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from costeer.intention.features import DISTANCE, FEATURES
from costeer.records.record import TrialRecord
from costeer.training.recordings import (
    Recording,
    read_recordings,
    recording,
    recordings_of,
    runs,
)
from costeer.training.tables import (
    absent_signals,
    measured_side,
    resampled,
)
from tests.training.synthetic import columns


def changed(**replaced: Any) -> dict[str, Any]:
    """A drive with some columns replaced, or left out if None."""
    merged = columns(1) | replaced
    return {name: values for name, values in merged.items() if values is not None}


def crossing_of(drive: dict[str, NDArray[Any]]) -> NDArray[np.int8]:
    return np.sign(np.diff(drive["lane"], prepend=drive["lane"][:1])).astype(np.int8)


def from_table(**replaced: Any) -> list[Recording]:
    record = TrialRecord(metadata={}, columns=changed(**replaced))
    return recordings_of(record, "drive.csv")


@pytest.mark.parametrize("name", [n for n in FEATURES if n != "longitudinal_velocity"])
def test_a_signal_without_a_column_is_absent(name: str) -> None:
    (made,) = from_table(**{name: None})
    assert made.absent == (name,)
    assert np.isnan(made.features[:, FEATURES.index(name)]).all()


def test_a_column_without_a_value_is_absent() -> None:
    nothing = np.full(len(columns(1)["time"]), np.nan)
    assert absent_signals(changed(head_yaw=nothing)) == ("head_yaw",)


@pytest.mark.parametrize("name", ["time", "longitudinal_velocity"])
def test_what_cannot_be_missing_is_named(name: str) -> None:
    with pytest.raises(ValueError, match=rf"drive.csv.* no column '?{name}"):
        from_table(**{name: None})


def test_without_lane_and_crossing_nothing_can_be_judged() -> None:
    with pytest.raises(ValueError, match="no column crossing and no column lane"):
        from_table(lane=None)


def test_without_lanes_the_side_of_the_distance_is_told_from_the_motion() -> None:
    drive = changed()
    # Between its changes the car is now in the left, now in the right lane.
    left = np.flatnonzero(drive["lane"] == 0)
    right = np.flatnonzero(drive["lane"] == 1)
    for rows, side in ((left, 1), (right, -1)):
        # The first stretch of that lane, up to its own change.
        end = np.flatnonzero(np.diff(rows) > 1)
        rows = rows[: end[0] + 1] if end.size else rows
        part = {name: values[rows] for name, values in drive.items()}
        assert measured_side("a", part) == side


def test_a_distance_to_no_known_side_is_refused() -> None:
    drive = changed(lane=None, yaw_angle=None, crossing=crossing_of(columns(1)))
    with pytest.raises(ValueError, match="cannot be told to which side"):
        runs("a", "a", drive)


def test_without_lanes_and_distance_both_sides_are_judged() -> None:
    drive = changed(
        lane=None,
        distance_to_adjacent_lane=None,
        crossing=crossing_of(columns(1)),
    )
    to_right, to_left = runs("a", "a", drive)
    assert set(to_right.side) == {-1}
    assert set(to_left.side) == {1}
    # Each crossing is the business of one side.
    assert to_right.intended[to_right.intended != 0].tolist() == [-1, -1]
    assert to_left.intended[to_left.intended != 0].tolist() == [1, 1]
    np.testing.assert_array_equal(to_right.features[:, 5], -to_left.features[:, 5])
    assert not (to_right.labels.positive & to_left.labels.positive).any()


def test_the_side_can_be_given() -> None:
    side = np.where(columns(1)["lane"] == 0, 1, -1)
    given = runs("a", "a", changed(adjacent_side=side))[0]
    told = runs("a", "a", changed())[0]
    np.testing.assert_array_equal(given.features, told.features)
    with pytest.raises(ValueError, match="adjacent_side is 0 in row 0"):
        runs("a", "a", changed(adjacent_side=0 * side))


def test_more_than_two_lanes_are_counted_from_the_right() -> None:
    wide = changed(lane=columns(1)["lane"] + 1)
    (made,) = runs("a", "a", wide)
    assert made.crossing[made.crossing != 0].tolist() == [-1, 1, -1, 1]
    with pytest.raises(ValueError, match=r"lane is 0.5 in row 0; give whole numbers"):
        runs("a", "a", changed(lane=columns(1)["lane"] + 0.5 - 1.0))


def test_the_lateral_position_gives_the_distance_on_two_lanes() -> None:
    drive = changed()
    # Measured from the left lane's centre: the line lies at -1.75 m.
    lateral = np.where(drive["lane"] == 1, 1.0, -1.0) * drive[FEATURES[DISTANCE]] - 1.75
    without = changed(distance_to_adjacent_lane=None, lateral_position=lateral)
    (made,) = runs("a", "a", without)
    assert made.absent == ()
    np.testing.assert_allclose(
        made.features[:, DISTANCE], drive[FEATURES[DISTANCE]], atol=1e-12
    )


def test_an_unknown_column_is_named_with_what_may_be_meant() -> None:
    drive = changed()
    (made,) = from_table(
        steering_angle=drive["steering_wheel_angle"], steering_wheel_angle=None
    )
    (told,) = [note for note in made.notes if "not used" in note]
    assert "not used: steering_angle" in told
    assert "did you mean steering_wheel_angle by steering_angle?" in told


def test_values_that_are_not_there_are_counted() -> None:
    speed = columns(1)["longitudinal_velocity"].copy()
    head = columns(1)["head_yaw"].copy()
    speed[100:103], head[5:9] = np.nan, np.nan
    (made,) = from_table(longitudinal_velocity=speed, head_yaw=head)
    told = "\n".join(made.notes)
    assert "longitudinal_velocity is not a finite number in 3 rows" in told
    assert "head_yaw is empty in 4 rows: taken as a lost head" in told


def test_short_stretches_are_counted() -> None:
    drive = changed()
    names = np.where(np.arange(len(drive["time"])) < 100, "a", "b")
    first, second = from_table(sequence=names)
    assert "1 of 2 stretches are shorter than a window" in "\n".join(first.notes)
    assert second.notes == ()


def at_ten_hertz(drive: dict[str, Any]) -> dict[str, Any]:
    thin = {name: values[::6] for name, values in drive.items()}
    thin["crossing"] = crossing_of(thin)
    return thin


def test_another_rate_is_brought_to_60_hz_without_a_look_ahead() -> None:
    drive = changed()
    made = resampled("a", at_ten_hertz(drive))
    assert np.allclose(np.diff(made["time"]), 1.0 / 60.0)
    late = np.interp(made["time"] - 0.1, drive["time"], drive["yaw_angle"])
    # Straight lines between rows 0.1 s apart of a motion of 0.3 Hz at the most.
    np.testing.assert_allclose(made["yaw_angle"], late, atol=2e-3)
    assert np.sum(made["crossing"] != 0) == 4


def test_resampled_distance_does_not_run_across_a_crossing() -> None:
    side = np.where(columns(1)["lane"] == 0, 1, -1)
    drive = changed(adjacent_side=side, lane=None)
    distance = drive["distance_to_adjacent_lane"]
    # As on a wider road: after a crossing the next line is far away.
    drive["distance_to_adjacent_lane"] = np.where(side == 1, distance + 3.0, distance)
    drive["crossing"] = crossing_of(columns(1))
    thin = {name: values[::6] for name, values in drive.items()}
    thin["crossing"] = np.sign(-np.diff(thin["adjacent_side"], prepend=-1))
    made = resampled("a", thin)["distance_to_adjacent_lane"]
    between = (made > 2.0) & (made < 3.0)
    assert not between.any()


def test_a_table_of_10_hz_is_read_when_asked(tmp_path: Path) -> None:
    path = tmp_path / "slow.csv"
    pd.DataFrame(at_ten_hertz(changed())).to_csv(path, index=False)
    with pytest.raises(ValueError, match="resample"):
        read_recordings([path])
    (made,) = read_recordings([path], resample=True)
    assert np.count_nonzero(made.intended) == 4
    assert np.isfinite(made.features).all()


def test_times_rounded_to_ten_milliseconds_are_resampled(tmp_path: Path) -> None:
    drive = changed()
    path = tmp_path / "rounded.csv"
    pd.DataFrame(drive | {"time": drive["time"].round(2)}).to_csv(path, index=False)
    with pytest.raises(ValueError, match="--resample"):
        read_recordings([path])
    (made,) = read_recordings([path], resample=True)
    assert any("unevenly sampled, steps up to 0.02 s" in note for note in made.notes)
    assert np.count_nonzero(made.intended) == 4


def test_a_repeated_time_is_left_out_when_resampled(tmp_path: Path) -> None:
    drive = pd.DataFrame(changed())
    path = tmp_path / "twice.csv"
    pd.concat([drive[:101], drive[100:]]).to_csv(path, index=False)
    with pytest.raises(ValueError, match=r"delete row 101, .*--drop-repeated"):
        read_recordings([path])
    (made,) = read_recordings([path], resample=True)
    assert any("1 rows repeat the time" in note for note in made.notes)


def test_rows_without_a_sequence_are_one_stretch_that_is_named(tmp_path: Path) -> None:
    drive = pd.DataFrame(changed())
    path = tmp_path / "empty.csv"
    drive.assign(sequence=[1.0] * 2000 + [np.nan] * (len(drive) - 2000)).to_csv(path)
    first, second = read_recordings([path])
    assert (first.name, second.name) == (f"{path}:1.0", f"{path}:empty")
    assert any("sequence is empty in" in note for note in first.notes)


@pytest.mark.parametrize("sequence", [True, False])
def test_participants_that_look_like_dates_are_drivers(
    sequence: bool, tmp_path: Path
) -> None:
    drive = pd.DataFrame(changed())
    days = ("2021-03-01", "2021-03-02")
    parts = [drive.assign(participant=d, sequence=k // 2) for k, d in enumerate(days)]
    table = pd.concat(parts)
    path = tmp_path / "days.csv"
    table.drop(columns=[] if sequence else "sequence").to_csv(path, index=False)
    found = read_recordings([path])
    assert [each.driver for each in found] == list(days)


def test_a_lane_with_gaps_is_not_needed_beside_crossings() -> None:
    drive = changed(adjacent_side=np.where(columns(1)["lane"] == 0, 1, -1))
    drive["crossing"] = crossing_of(columns(1))
    whole = recording("a", "a", drive)
    drive["lane"] = np.where(drive["time"] < 1.0, np.nan, drive["lane"])
    made = recording("a", "a", drive)
    np.testing.assert_array_equal(made.crossing, whole.crossing)
    assert any("lane is empty in some rows" in note for note in made.notes)


def test_the_distance_follows_from_the_position_when_resampled_too() -> None:
    drive = changed(distance_to_adjacent_lane=None)
    across = np.where(drive["lane"] == 1, 0.0, -3.5)
    drive |= {"lateral_position": across}
    slow = {name: values[::3] for name, values in drive.items()}
    (made,) = recordings_of(TrialRecord({}, slow), "drive.csv", resample=True)
    assert made.absent == ()
    known = made.features[:, FEATURES.index("distance_to_adjacent_lane")]
    np.testing.assert_allclose(known, 1.75)


def test_a_bend_is_taken_off_a_resampled_table_too() -> None:
    across = np.where(columns(1)["lane"] == 1, 0.0, -3.5)
    bend = np.linspace(-0.002, 0.002, len(across))
    drive = changed(lateral_position=across, road_curvature=bend)
    angle = FEATURES.index("steering_wheel_angle")
    (whole,) = recordings_of(TrialRecord({}, drive), "drive.csv")
    (straight,) = from_table()
    taken = whole.side * (straight.features - whole.features)[:, angle]
    slow = {name: values[::3] for name, values in drive.items()}
    flat = {name: v for name, v in slow.items() if name != "road_curvature"}
    made, without = (
        recordings_of(TrialRecord({}, each), "drive.csv", resample=True)[0]
        for each in (slow, flat)
    )
    late = made.side * (without.features - made.features)[:, angle]
    # Straight lines between rows 50 ms apart: in 0.05 s the angle for the bend changes
    # by 1e-4 rad, and by 1 part in 100 where the car changes lanes within the bend.
    np.testing.assert_allclose(late, taken[: len(late)], atol=2e-3)
    assert np.abs(taken).max() > 0.05


def test_a_table_with_bends_tells_whose_car_they_are_taken_for() -> None:
    bend = np.full(len(columns(1)["time"]), 0.002)
    told = "asks of costeer's default car"
    assert any(told in note for note in from_table(road_curvature=bend)[0].notes)
    assert not any(
        told in note for note in from_table(road_curvature=0 * bend)[0].notes
    )
    about = {"seed": 1, "participant": 1}
    record = TrialRecord(about, changed(road_curvature=bend))
    assert not any(told in note for note in recordings_of(record, "a")[0].notes)
