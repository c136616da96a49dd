"""Replays: the page gets every row of the record, or the user is told what lacks."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from costeer.records.record import COLUMN_NAMES, MODES, Column, TrialRecord
from costeer.records.row import ROW_COLUMNS
from costeer.web.app import replay_app
from costeer.web.replay import NEEDED, Replay, replay_of
from tests.study.synthetic import synthetic_record
from tests.web.attacks import EVIL_HTML
from tests.web.served import fetch, page_files, served

MARKERS = [
    {"time": 2.0, "kind": "paused", "text": "wheel lost"},
    {"time": 1.0, "kind": "method", "before": "ibhs", "after": "manual"},
    {"kind": "no time"},
    "no marker",
]


@pytest.fixture(scope="module")
def record() -> TrialRecord:
    plain = synthetic_record("weak-normal", length=900.0)
    alone = np.arange(len(plain.columns["time"])) % 3 > 0
    lead_lane = np.ma.MaskedArray(np.ones(len(alone), np.int8), mask=alone)
    columns = plain.columns | {"lead_lane": lead_lane}
    return TrialRecord(plain.metadata | {"markers": MARKERS}, columns)


@pytest.fixture(scope="module")
def replay(record: TrialRecord) -> Replay:
    return replay_of(record, "trial.parquet")


def rows_of(replay: Replay) -> dict[str, np.ndarray]:
    """The block as the page reads it: column after column by name."""
    names = replay.hello["columns"]
    assert isinstance(names, list)
    rows = np.frombuffer(replay.rows, "<f8").reshape(-1, len(names))
    return {name: rows[:, place] for place, name in enumerate(names)}


def changed(record: TrialRecord, **columns: np.ndarray) -> TrialRecord:
    return TrialRecord({}, record.columns | columns)


def test_all_columns_of_the_loop_are_there(replay: Replay) -> None:
    assert set(rows_of(replay)) == set(ROW_COLUMNS)


def test_numbers_are_those_of_the_record_and_gaps_are_nan(
    record: TrialRecord, replay: Replay
) -> None:
    rows = rows_of(replay)
    for name in COLUMN_NAMES:
        if name != "mode":
            column = record.columns[name]
            gaps = np.ma.getmaskarray(column)
            wanted = np.where(gaps, np.nan, np.ma.getdata(column).astype(float))
            np.testing.assert_array_equal(rows[name], wanted, err_msg=name)
    assert 0 < np.isnan(rows["lead_lane"]).sum() < len(rows["lead_lane"])


def test_modes_are_numbers(record: TrialRecord, replay: Replay) -> None:
    modes = np.array(MODES)[rows_of(replay)["mode"].astype(int)]
    np.testing.assert_array_equal(modes, record.columns["mode"])
    assert MODES == ("manual", "lane_keeping", "lane_changing")
    word = np.full(len(modes), "parking")
    other = replay_of(changed(record, mode=word), "t")
    assert np.isnan(rows_of(other)["mode"]).all()


def test_hello_describes_the_trial(record: TrialRecord, replay: Replay) -> None:
    hello, time = replay.hello, record.columns["time"]
    assert (hello["mode"], hello["title"]) == ("replay", "trial.parquet")
    assert hello["duration"] == time[-1] - time[0]
    # Differences of times that grow to 50 s are rounded at 1e-14 s.
    assert hello["rate"] == pytest.approx(60.0, abs=1e-6)
    assert (hello["condition"], hello["method"]) == ("weak-normal", "ibhs")
    assert hello["road"] == {
        "lane_width": 3.5,
        "num_lanes": 2.0,
        "length": 8000.0,
        "overtaking_side": -1.0,
    }


def test_the_page_is_told_what_jumps_between_two_samples(replay: Replay) -> None:
    assert replay.hello["stepped"] == [
        "lane",
        "target_lane",
        "consistent",
        "intention",
        "mode",
        "event",
        "driver_intention",
        "lead_lane",
        "head_yaw_valid",
        "torque_fault",
        "contact",
        "driver_indicator",
        "crossing_side",
    ]


def test_columns_of_the_method_are_shown(record: TrialRecord) -> None:
    phase = Column("method_phase", "-", "string", "", stepped=True, labels=("a", "b"))
    values = np.where(np.arange(len(record.columns["time"])) < 2, "a", "b")
    columns = record.columns | {"method_phase": values}
    replay = replay_of(TrialRecord(record.metadata, columns, (phase,)), "t")
    assert rows_of(replay)["method_phase"][:4].tolist() == [0.0, 0.0, 1.0, 1.0]
    assert "method_phase" in replay.hello["stepped"]  # type: ignore[operator]  # a list


def test_markers_come_by_time_with_their_fields_and_in_words(replay: Replay) -> None:
    assert replay.hello["markers"] == [
        {
            "time": 1.0,
            "kind": "method",
            "before": "ibhs",
            "after": "manual",
            "text": "method: ibhs → manual",
        },
        {
            "time": 2.0,
            "kind": "paused",
            "note": "wheel lost",
            "text": "paused: wheel lost",
        },
    ]


def test_road_and_car_are_those_of_the_record(record: TrialRecord) -> None:
    told = {"road": {"length": 500.0}, "car": {"width": 2.0, "rear_distance": 2.0}}
    about = record.metadata | {"car": "compact", "configuration": told}
    hello = replay_of(TrialRecord(about, record.columns), "t").hello
    road, car = hello["road"], hello["car"]
    assert isinstance(road, dict)
    assert road["length"] == 500.0
    # The compact car's front axle is 1 m before its centre of gravity.
    assert car == {"width": 2.0, "wheelbase": 3.0, "steering_ratio": 17.0}


def test_a_table_with_the_needed_columns_is_shown(record: TrialRecord) -> None:
    bare = TrialRecord({}, {name: record.columns[name] for name in NEEDED})
    replay = replay_of(bare, "drive.csv")
    assert set(rows_of(replay)) == set(NEEDED)
    assert replay.hello["conditions"] == []


@pytest.mark.parametrize("name", NEEDED)
def test_a_missing_column_is_named(record: TrialRecord, name: str) -> None:
    rest = {k: v for k, v in record.columns.items() if k != name}
    with pytest.raises(ValueError, match=f"no column {name}; a replay needs time, lo"):
        replay_of(TrialRecord({}, rest), "t")


def test_values_that_cannot_be_shown_are_refused(record: TrialRecord) -> None:
    num_rows = len(record.columns["time"])
    gap = record.columns["yaw_angle"].copy()
    gap[3] = np.nan
    with pytest.raises(ValueError, match="yaw_angle is nan in row 3"):
        replay_of(changed(record, yaw_angle=gap), "t")
    with pytest.raises(ValueError, match="yaw_angle holds text"):
        replay_of(changed(record, yaw_angle=np.full(num_rows, "x")), "t")
    with pytest.raises(ValueError, match="time does not increase"):
        replay_of(changed(record, time=np.zeros(num_rows)), "t")
    with pytest.raises(ValueError, match="fewer than two rows"):
        replay_of(TrialRecord({}, {n: v[:1] for n, v in record.columns.items()}), "t")


def test_the_server_gives_hello_and_record(replay: Replay, tmp_path: Path) -> None:
    static = page_files(tmp_path)
    with served(lambda access: replay_app(replay, access, static)) as running:
        hello = json.loads(fetch(running, "/api/hello").body)
        record = fetch(running, "/api/record")
        page, socket = fetch(running, "/"), fetch(running, "/ws")
    assert (hello["type"], hello["role"], hello["mode"]) == (
        "hello",
        "driver",
        "replay",
    )
    assert hello["columns"] == replay.hello["columns"]
    assert record.body == replay.rows
    assert record.headers["Content-Type"] == "application/octet-stream"
    assert (page.status, socket.status) == (200, 404)


@pytest.mark.parametrize(
    "value", [math.nan, math.inf, -1e308, EVIL_HTML[0], None, [1.0], True]
)
def test_description_that_cannot_be_drawn_is_replaced_by_what_is_usual(
    record: TrialRecord, value: object
) -> None:
    names = ("lane_width", "num_lanes", "length", "overtaking_side")
    about = {
        "configuration": {
            "road": dict.fromkeys(names, value),
            "car": dict.fromkeys(("width", "front_distance", "steering_ratio"), value),
        },
        "torque_limit": value,
        "condition": value,
        "method": value,
    }
    hello = replay_of(TrialRecord(about, record.columns), "t").hello
    usual = replay_of(TrialRecord({}, record.columns), "t").hello
    for name in ("road", "car", "torque_limit"):
        assert hello[name] == usual[name]
    assert hello["condition"] == (value if isinstance(value, str) else "")


def test_number_that_is_infinite_is_a_gap(record: TrialRecord) -> None:
    torque = record.columns["driver_torque"].copy()
    torque[3] = np.inf
    rows = rows_of(replay_of(changed(record, driver_torque=torque), "t"))
    assert np.isnan(rows["driver_torque"][3])
