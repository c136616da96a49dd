"""Measures of one's own data, from records, frames, mappings and plain arrays."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import costeer
from costeer.study.measures import trial_row
from tests.study.synthetic import synthetic_record
from tests.training.synthetic import columns

TIME = np.arange(0.0, 120.0, 1.0 / 60.0)
SWAY = 0.1 * np.sin(2.0 * math.pi * 0.1 * TIME)
"""Twelve periods; at the ends the filter adds or takes a reversal at most."""


def test_measures_of_a_record_are_those_of_the_study() -> None:
    record = synthetic_record(length=2500.0)
    found, row = costeer.measures(record), trial_row(record)
    for name in ("sdlp", "swrr", "driver_torque_rms", "num_lane_changes"):
        assert found.value[name] == row[name]


def test_a_frame_a_mapping_and_a_record_give_the_same() -> None:
    record = synthetic_record(length=1500.0)
    expected = costeer.measures(record)
    bare = {"replan_gain": record.metadata.get("replan_gain")}
    assert bare["replan_gain"] in (None, 0.05)  # the usual one: nothing else is read
    pd.testing.assert_frame_equal(costeer.measures(record.to_frame()), expected)
    lists = {n: np.ma.asanyarray(v) for n, v in record.columns.items()}
    pd.testing.assert_frame_equal(costeer.measures(lists), expected)


def test_a_measure_that_is_missing_says_why() -> None:
    found = costeer.measures({"time": TIME, "steering_wheel_angle": SWAY})
    assert math.isnan(found.value["sdlp"])
    assert "lateral_position" in found.reason["sdlp"]
    assert found.reason["swrr"] == ""
    assert any("lane keeping is not known" in note for note in found.attrs["notes"])


def test_stretches_are_measured_apart() -> None:
    part = np.repeat([1, 2], TIME.size // 2)
    table = {"time": TIME, "steering_wheel_angle": SWAY * part, "sequence": part}
    found = costeer.measures(table)
    assert found.index.get_level_values("sequence").unique().tolist() == ["1", "2"]


def test_a_wider_lane_leaves_more_time_to_the_line() -> None:
    record = synthetic_record(length=1500.0)
    name = "line_crossing_time_median"
    narrow = costeer.measures(record, lane_width=3.5, car_width=1.8).value[name]
    assert costeer.measures(record, car_width=1.6).value[name] > narrow


def test_an_unknown_threshold_is_an_error_with_a_suggestion() -> None:
    with pytest.raises(ValueError, match="did you mean reversal_angle"):
        costeer.measures({"time": TIME}, reversal_angel=0.1)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"steering_wheel_angle": SWAY}, "no column 'time'"),
        ({"time": TIME, "yaw_angle": SWAY[1:]}, "differ in length"),
        (3.0, "float is no recording"),
    ],
)
def test_what_cannot_be_measured_is_refused(table: object, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        costeer.measures(table)  # type: ignore[arg-type]  # that is the point


def test_sdlp_is_the_sample_standard_deviation() -> None:
    # Of 1, 2, 3, 4 about 2.5: (2.25 + 0.25) * 2 / 3.
    assert costeer.sdlp([1, 2, 3, 4]) == pytest.approx(math.sqrt(5.0 / 3.0))
    assert costeer.sdlp([1, 2, 9, 3, 4], [1, 1, 0, 1, 1]) == pytest.approx(
        math.sqrt(5.0 / 3.0)
    )


@pytest.mark.parametrize("position", [[], [1.0], [1.0, math.nan]])
def test_sdlp_of_too_little_is_refused(position: list[float]) -> None:
    with pytest.raises(ValueError, match="are finite; give 2 or more"):
        costeer.sdlp(position)


def test_a_slow_sine_reverses_twice_a_period() -> None:
    # 0.1 Hz passes the low-pass; 6 periods a minute make 12 reversals, of the two
    # ends one or the other may be missing or cut: 2 in 2 min.
    for given in (60.0, TIME):
        rate = costeer.steering_wheel_reversal_rate(given, SWAY)
        assert rate == pytest.approx(12.0, abs=1.0)


def test_a_gap_wider_than_the_sine_counts_nothing() -> None:
    assert costeer.steering_wheel_reversal_rate(60.0, SWAY, gap=0.3) == 0.0


@pytest.mark.parametrize(
    ("time", "angle", "told"),
    [
        (60.0, [0.0, math.nan], "1 of 2 angles are finite"),
        ([0.0, 1.0, 2.0], [0.0, 1.0], "with 3 times"),
        (60.0, [0.0, 0.1], "no reversal rate"),
        (1.0, SWAY, "s pass between rows"),
    ],
)
def test_angles_that_give_no_rate_are_refused(
    time: object, angle: object, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        costeer.steering_wheel_reversal_rate(time, angle)  # type: ignore[arg-type]  # that is the point


def test_advice_serves_without_a_command_line_too() -> None:
    with pytest.raises(ValueError, match=r"rename yours \(on the command line, for"):
        costeer.measures({"t": TIME})
    with pytest.raises(ValueError, match=r"multiply it by 0\.001 \(on the command"):
        costeer.measures({"time": 1000.0 * TIME})


def contradictory(path: Path) -> Path:
    """A table with semicolons in which the yaw angle has the wrong sign."""
    drive = columns(1)
    moved = drive["longitudinal_velocity"] * drive["yaw_angle"] / 60.0
    drive["lateral_position"] = np.cumsum(moved)
    drive["yaw_angle"] = -drive["yaw_angle"]
    pd.DataFrame(drive).to_csv(path, sep=";", index=False)
    return path


def test_what_looks_wrong_in_a_file_is_a_warning_and_a_note(tmp_path: Path) -> None:
    path = contradictory(tmp_path / "drive.csv")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = costeer.measures(path)
    assert {each.category for each in told} == {costeer.ReadingWarning}
    assert {each.filename for each in told} == {__file__}
    words = [str(each.message) for each in told]
    assert any("semicolons between columns" in each for each in words)
    assert any("contradict each other in sign" in each for each in words)
    assert set(words) <= set(found.attrs["notes"])


def test_a_file_that_is_read_with_an_assumption_warns(tmp_path: Path) -> None:
    path = contradictory(tmp_path / "drive.csv")
    with pytest.warns(costeer.ReadingWarning, match=r"drive.csv: .*semicolons"):
        costeer.load_record(path)


def test_a_judgement_warns_too(tmp_path: Path) -> None:
    path = contradictory(tmp_path / "drive.csv")
    with pytest.warns(costeer.ReadingWarning) as told:
        costeer.evaluate("line-time", path)
    words = " ".join(str(each.message) for each in told)
    assert "semicolons between columns" in words
    assert "contradict each other in sign" in words
