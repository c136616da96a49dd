"""Files are measured as they come: records, tables, real recordings."""

from __future__ import annotations

import csv
import gzip
import json
import os
from math import radians
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from costeer.records.record import write_record
from costeer.study.analysis import Analysis, analyse_file, as_json
from costeer.study.definitions import MeasureParameters
from costeer.study.measures import lane_change_rows, trial_row
from costeer.study.recordings import Adaptation
from tests.study.synthetic import synthetic_record

EXAMPLES = Path(__file__).parents[2] / "examples" / "steering"
UDACITY = Adaptation(
    renames={
        "t": "time",
        "angle": "steering_wheel_angle",
        "torque": "driver_torque",
        "speed": "longitudinal_velocity",
    },
    sequence="part",
)
COMMA = Adaptation(
    renames={
        "t": "time",
        "steering_angle_deg": "steering_wheel_angle",
        "speed": "longitudinal_velocity",
    },
    scales={"steering_wheel_angle": radians(1.0)},
)


def real_data(folder: str) -> Path:
    root = os.environ.get("COSTEER_DATA")
    if root is None:
        pytest.skip("set COSTEER_DATA to the folder of the real recordings")
    path = Path(root) / folder
    if not path.is_dir():
        pytest.skip(f"COSTEER_DATA has no folder {folder}")
    return path


def rate_of(analysis: Analysis) -> float:
    return analysis.measures["swrr"].value


def test_a_trial_record_gives_what_the_tables_hold(tmp_path: Path) -> None:
    record = synthetic_record("strong-rapid", length=2500.0)
    write_record(tmp_path / "trial.parquet", record)
    (found,) = analyse_file(tmp_path / "trial.parquet")
    row, changes = trial_row(record), lane_change_rows(record)
    assert {name: found.measures[name].value for name in row if name in found.measures}
    for name in row.keys() & found.measures.keys():
        assert found.measures[name].value == row[name]
    for told, change in zip(found.lane_changes, changes, strict=True):
        assert told | change == told
    assert found.sampling.rate == pytest.approx(60.0)
    assert found.notes == ()


def test_time_and_angle_are_enough_for_the_reversal_rate(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    time = np.arange(0, 60, 0.05)
    angle = np.radians(4.0) * np.sin(2 * np.pi * 0.2 * time)
    with path.open("w") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "steering_wheel_angle"])
        writer.writerows(zip(time, angle, strict=True))
    (found,) = analyse_file(path)
    # Two per period of 5 s; at the ends one may be lost.
    assert rate_of(found) == pytest.approx(24.0, abs=1.0)
    assert found.measures["sdlp"].reason.startswith("needs the columns lateral_pos")
    assert found.lane_changes == []
    assert "swrr is of the whole recording" in found.notes[0]


def test_a_table_with_position_gives_lane_changes(tmp_path: Path) -> None:
    record = synthetic_record(length=2500.0)
    names = ("time", "lateral_position", "yaw_angle", "steering_wheel_angle")
    table = pa.table({name: record.columns[name] for name in names})
    pq.write_table(table, tmp_path / "t.parquet")
    (found,) = analyse_file(tmp_path / "t.parquet")
    assert len(found.lane_changes) == 2
    assert found.measures["sdlp"].reason == ""
    assert found.notes == (
        "there is no column event, so no overtaking events are left out",
    )


def test_real_steering_of_the_udacity_car() -> None:
    (found,) = analyse_file(EXAMPLES / "udacity.csv", UDACITY)
    assert found.sequence == "3"
    assert found.sampling.rate == pytest.approx(20.0, abs=0.01)
    # Counted by the authors' program on these 60 s, at 60 Hz: 19 reversals.
    assert rate_of(found) == pytest.approx(reference("udacity60"), abs=0.5)
    # The data set's own description: half of |torque| above 0.6 to 0.7 N·m.
    assert 0.7 < found.measures["driver_torque_rms"].value < 1.2


def reference(sequence: str) -> float:
    folder = Path(__file__).parents[1] / "data" / "swrr_reference"
    with (folder / "swrr_reference.csv").open() as file:
        wanted = {"sequence": sequence, "gap_deg": "3", "lowpass_hz": "0.6"}
        rows = [r for r in csv.DictReader(file) if wanted.items() <= r.items()]
    (row,) = rows
    return float(row["swrr_per_min"])


def test_real_steering_in_degrees_and_unevenly_sampled() -> None:
    (found,) = analyse_file(EXAMPLES / "comma2k19.csv", COMMA)
    assert found.sampling.rate == pytest.approx(83.0, abs=0.5)
    assert any("unevenly sampled" in note for note in found.notes)
    assert not any("looks like" in note for note in found.notes)
    # A motorway: few reversals. In degrees taken for radians there are many.
    assert rate_of(found) <= 6.0
    (wrong,) = analyse_file(EXAMPLES / "comma2k19.csv", COMMA._replace(scales={}))
    assert rate_of(wrong) > 20.0
    assert any("looks like degrees" in note for note in wrong.notes)


def test_the_whole_udacity_recordings_are_measured() -> None:
    path = real_data("udacity_steering") / "ch2_20hz.csv.gz"
    found = analyse_file(path, UDACITY)
    assert [each.sequence for each in found] == ["2", "3"]
    for each in found:
        assert 5.0 < rate_of(each) < 40.0
    # Part 3 begins with the 60 s of the reference and goes on for 39 s.
    reversals = rate_of(found[1]) * found[1].num_rows / 20.0 / 60.0
    assert reversals > reference("udacity60")


def test_the_whole_comma_recording_gives_the_authors_rate() -> None:
    path = real_data("comma2k19_example") / "can_80hz.csv.gz"
    (found,) = analyse_file(path, COMMA)
    # The reference is of these 60 s at 60 Hz: the same reversals, in 59.98 s.
    assert rate_of(found) == pytest.approx(reference("comma60"), abs=0.01)


def test_the_wrong_stretch_is_named(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("time,sequence\n0,a\n0.1,a\n0,b\n9,b\n")
    with pytest.raises(ValueError, match=r"t\.csv: sequence b: 9 s pass"):
        analyse_file(tmp_path / "t.csv")


def test_a_slow_recording_is_noted(tmp_path: Path) -> None:
    with gzip.open(tmp_path / "t.csv.gz", "wt") as file:
        file.write("time,steering_wheel_angle\n")
        file.writelines(f"{row / 5},{row % 2}\n" for row in range(100))
    (found,) = analyse_file(tmp_path / "t.csv.gz")
    assert any("5 samples per second are few" in note for note in found.notes)


def test_parameters_reach_the_measures() -> None:
    coarse = MeasureParameters(reversal_angle=radians(30.0))
    (found,) = analyse_file(EXAMPLES / "udacity.csv", UDACITY, coarse)
    assert rate_of(found) < 3.0


def test_json_has_null_for_what_is_not_known() -> None:
    (entry,) = as_json(analyse_file(EXAMPLES / "udacity.csv", UDACITY))
    text = json.dumps(entry, allow_nan=False)
    measures = json.loads(text)["measures"]
    assert measures["sdlp"]["value"] is None
    assert "lateral_position" in measures["sdlp"]["reason"]
    assert "reason" not in measures["swrr"]


def test_json_holds_the_lane_changes(tmp_path: Path) -> None:
    write_record(tmp_path / "t.parquet", synthetic_record(length=2500.0))
    (entry,) = as_json(analyse_file(tmp_path / "t.parquet"))
    changes = json.loads(json.dumps(entry, allow_nan=False))["lane_changes"]
    assert [change["index"] for change in changes] == [1, 2]
    assert changes[0]["change_duration"] is None
    assert changes[0]["assisted"] is False
