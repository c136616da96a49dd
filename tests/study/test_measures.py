"""The rows of trials.csv and lane_changes.csv."""

from __future__ import annotations

from math import isnan, pi, sqrt

import numpy as np
import pytest

from costeer.records.columns import TrialRecord
from costeer.study.definitions import MeasureParameters
from costeer.study.measures import lane_change_rows, strength, trial_row
from costeer.study.trial_measures import prepare, trial_measures
from tests.records.mirror import mirrored
from tests.study.synthetic import CONDITIONS, synthetic_record

# Columns that spec and report rely on; more may follow.
TRIAL_COLUMNS = [
    "participant",
    "condition",
    "strength",
    "change_duration",
    "order",
    "sdlp",
    "swrr",
    "driver_torque_rms",
]
LANE_CHANGE_COLUMNS = [
    "participant",
    "condition",
    "strength",
    "change_duration",
    "index",
    "direction",
    "start_time",
    "crossing_time",
    "end_time",
    "duration",
    "overshoot",
    "steering_velocity_rms",
    "peak_steering_angle",
    "assisted",
]


@pytest.fixture(scope="module")
def manual() -> TrialRecord:
    return synthetic_record("manual", length=2500.0)


@pytest.fixture(scope="module")
def assisted() -> TrialRecord:
    return synthetic_record("weak-gentle", length=2500.0)


def without(record: TrialRecord, *names: str) -> TrialRecord:
    kept = {k: v for k, v in record.columns.items() if k not in names}
    return TrialRecord(record.metadata, kept)


def test_rows_begin_with_the_columns_of_the_study_folder(manual: TrialRecord) -> None:
    assert list(trial_row(manual))[: len(TRIAL_COLUMNS)] == TRIAL_COLUMNS
    row = lane_change_rows(manual)[0]
    assert list(row)[: len(LANE_CHANGE_COLUMNS)] == LANE_CHANGE_COLUMNS
    assert "num_lane_changes" in trial_row(manual)
    assert "detection_lead_time" in row


def test_every_record_gives_the_same_columns(
    manual: TrialRecord, assisted: TrialRecord
) -> None:
    bare = without(manual, "lateral_position", "intention", "event")
    assert list(trial_row(manual)) == list(trial_row(assisted)) == list(trial_row(bare))
    no_wheel = without(assisted, "steering_wheel_angle")
    for rows in (lane_change_rows(assisted), lane_change_rows(no_wheel)):
        assert list(rows[0]) == list(lane_change_rows(manual)[0])


def test_a_row_says_whose_trial_it_is(assisted: TrialRecord) -> None:
    row = trial_row(assisted, order=3)
    assert row["participant"] == 1
    assert row["condition"] == "weak-gentle"
    assert row["strength"] == "weak"
    assert row["change_duration"] == 8.0
    assert row["order"] == 3


def test_manual_driving_has_no_planned_duration(manual: TrialRecord) -> None:
    row = trial_row(manual)
    assert row["strength"] == "manual"
    assert isnan(float(str(row["change_duration"])))


@pytest.mark.parametrize(
    ("factor", "name"),
    [(1.0, "strong"), (0.4, "weak"), (0, "manual"), (0.7, "0.7"), (None, "manual")],
)
def test_strength_is_named_by_its_factor(factor: object, name: str) -> None:
    assert strength(factor) == name


@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_whole_trial_has_its_eight_lane_changes(condition: str) -> None:
    record = synthetic_record(condition)
    row, rows = trial_row(record), lane_change_rows(record)
    assert row["num_lane_changes"] == len(rows) == 8
    assert row["num_events"] == 4
    assert row["dropped_changes"] == ""
    assert [change["index"] for change in rows] == list(range(1, 9))
    assert [change["direction"] for change in rows] == [-1, 1] * 4
    assert all(change["assisted"] is (condition != "manual") for change in rows)
    assert row["num_missed"] == 0


def test_disputed_lane_changes_are_marked(assisted: TrialRecord) -> None:
    assert trial_row(assisted)["num_inconsistencies"] == 1
    assert [r["num_inconsistencies"] for r in lane_change_rows(assisted)] == [1, 0]


def test_dropped_crossings_are_named() -> None:
    record = synthetic_record(length=2500.0)
    crossing = lane_change_rows(record)[0]["crossing_time"]
    assert isinstance(crossing, float)
    start = int(crossing * 60) - 30
    late = {name: values[start:] for name, values in record.columns.items()}
    row = trial_row(TrialRecord(record.metadata, late))
    assert row["num_dropped_changes"] == 1
    assert row["dropped_changes"] == f"{crossing:.2f} s: started before the record"


def test_torque_is_of_the_whole_course(manual: TrialRecord) -> None:
    phase = 2 * pi * manual.columns["time"]
    torque = 0.5 * np.sin(phase)
    record = TrialRecord(manual.metadata, manual.columns | {"driver_torque": torque})
    # 128 s of a sine of 1 Hz; what is left over is under a period.
    assert trial_row(record)["driver_torque_rms"] == pytest.approx(
        0.5 / sqrt(2), rel=0.01
    )


def test_triggers_are_counted_per_kilometre(manual: TrialRecord) -> None:
    position = manual.columns["longitudinal_position"]
    intention = np.zeros(position.size, dtype=bool)
    intention[100:110] = True
    record = TrialRecord(manual.metadata, manual.columns | {"intention": intention})
    row = trial_row(record)
    distance = (position[-1] - position[0]) / 1000.0
    assert row["num_false_triggers"] == 1
    assert row["num_missed"] == 2
    assert row["false_triggers_per_km"] == pytest.approx(1 / distance)
    assert row["missed_per_km"] == pytest.approx(2 / distance)
    assert row["detection_lead_time"] == 0.0


def measured(record: TrialRecord) -> dict[str, str]:
    """Reasons by measure."""
    found = trial_measures(prepare(record.columns))
    return {name: measure.reason for name, measure in found.items()}


def test_what_cannot_be_computed_says_why(
    manual: TrialRecord, assisted: TrialRecord
) -> None:
    assert not any(measured(assisted).values())
    reasons = measured(manual)
    assert reasons["recovery_time"].startswith("needs the columns consistent, haptic")
    bare = measured(without(manual, "yaw_angle", "driver_torque"))
    assert bare["sdlp"] == bare["num_lane_departures"]
    assert bare["sdlp"] == "needs the column yaw_angle, not recorded"
    assert bare["driver_torque_rms"] == "needs the column driver_torque, not recorded"
    no_wheel = measured(without(manual, "steering_wheel_angle"))
    assert no_wheel["swrr"] == "needs the column steering_wheel_angle, not recorded"
    still = {"longitudinal_position": manual.columns["time"] * 0.0}
    standing = measured(TrialRecord(manual.metadata, manual.columns | still))
    assert standing["missed_per_km"] == "the car did not move"
    nowhere = measured(without(manual, "longitudinal_position"))
    assert "longitudinal_position" in nowhere["missed_per_km"]


def test_a_measure_over_no_events_says_so(assisted: TrialRecord) -> None:
    columns = {name: values[:1200] for name, values in assisted.columns.items()}
    reasons = measured(TrialRecord(assisted.metadata, columns))
    assert reasons["recovery_time"] == "no inconsistency"
    assert reasons["detection_lead_time"] == "the driver crossed no line on purpose"


def test_values_and_reasons_exclude_each_other(manual: TrialRecord) -> None:
    for measure in trial_measures(prepare(manual.columns)).values():
        assert isnan(measure.value) == bool(measure.reason)


def test_the_records_own_replan_gain_is_used(assisted: TrialRecord) -> None:
    # With a gain of 0.4 half-way begins at 0.8, and less of a fade can be frozen.
    columns = dict(assisted.columns)
    stuck = columns["haptic_gain"].copy()
    disputed = ~columns["consistent"].data
    stuck[disputed] = 0.5
    columns["haptic_gain"] = stuck
    low = TrialRecord(assisted.metadata | {"replan_gain": 0.05}, columns)
    high = TrialRecord(assisted.metadata | {"replan_gain": 0.4}, columns)
    assert float(str(trial_row(low)["frozen_time"])) > 1.0
    assert float(str(trial_row(high)["frozen_time"])) == 0.0
    said_nothing = TrialRecord({}, columns)
    parameters = MeasureParameters(replan_gain=0.4)
    assert trial_row(said_nothing, parameters=parameters)["frozen_time"] == 0.0


def test_a_mirrored_trial_has_the_same_lane_change_measures(
    manual: TrialRecord,
) -> None:
    other = TrialRecord(manual.metadata, mirrored(manual.columns))
    here, there = lane_change_rows(manual), lane_change_rows(other)
    for a, b in zip(here, there, strict=True):
        assert b["direction"] == -int(str(a["direction"]))
        for name in ("duration", "overshoot", "steering_velocity_rms"):
            assert b[name] == pytest.approx(a[name], rel=1e-9)
