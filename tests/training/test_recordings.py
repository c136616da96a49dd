"""Recordings from records and tables, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from costeer.intention.features import FEATURES
from costeer.plant.parameters import CARS
from costeer.records.record import TrialRecord
from costeer.training.recordings import read_recordings, recording, recordings_of
from tests.training.synthetic import columns, drive


def changed(**replaced: Any) -> dict[str, Any]:
    """A drive with some columns replaced, or left out if None."""
    merged = columns(1) | replaced
    return {name: values for name, values in merged.items() if values is not None}


def test_crossings_follow_from_the_lane() -> None:
    made = recording("a", "a", columns(1, num_changes=4))
    assert made.intended[made.intended != 0].tolist() == [-1, 1, -1, 1]


def test_a_crossing_column_has_the_word() -> None:
    crossing = np.zeros(len(columns(1)["time"]), np.int8)
    crossing[1000] = -1
    made = recording("a", "a", changed(crossing=crossing))
    assert np.flatnonzero(made.intended).tolist() == [1000]


def test_a_crossing_that_the_driver_did_not_mean_is_no_target_of_triggers() -> None:
    free = recording("a", "a", columns(1))
    wish = np.zeros(len(free.side), np.int8)
    first = int(np.flatnonzero(free.intended)[0])
    wish[first - 60 : first + 60] = -1
    made = recording("a", "a", changed(driver_intention=wish))
    assert np.flatnonzero(made.intended).tolist() == [first]
    np.testing.assert_array_equal(made.labels.positive, free.labels.positive)


def test_people_mean_all_their_crossings() -> None:
    free = recording("a", "a", columns(1))
    nulls = np.ma.masked_all(len(free.side), np.int8)
    made = recording("a", "a", changed(driver_intention=nulls))
    np.testing.assert_array_equal(made.intended, free.intended)


def test_an_untracked_head_makes_the_sample_invalid() -> None:
    tracked = np.ones(len(columns(1)["time"]), bool)
    tracked[50:60] = False
    made = recording("a", "a", changed(head_yaw_valid=tracked))
    lost = np.flatnonzero(np.isnan(made.features[:, 0]))
    np.testing.assert_array_equal(lost, np.arange(50, 60))


@pytest.mark.parametrize("name", [n for n in FEATURES if n != "longitudinal_velocity"])
def test_a_missing_input_is_named_as_absent_and_all_else_stays(name: str) -> None:
    made, whole = recording("a", "a", changed(**{name: None})), drive(1)
    assert made.absent == (name,)
    place = FEATURES.index(name)
    assert np.isnan(made.features[:, place]).all()
    np.testing.assert_array_equal(
        np.delete(made.features, place, axis=1),
        np.delete(whole.features, place, axis=1),
    )
    np.testing.assert_array_equal(made.labels.positive, whole.labels.positive)


def test_a_recording_with_all_inputs_lacks_none() -> None:
    assert recording("a", "a", columns(1)).absent == ()


@pytest.mark.parametrize("name", ["time", "longitudinal_velocity"])
def test_a_missing_input_that_no_variant_lacks_is_refused_by_name(name: str) -> None:
    with pytest.raises(ValueError, match=rf"drive.csv.* no column '?{name}"):
        recording("a", "drive.csv", changed(**{name: None}))


def test_a_missing_lane_is_named_where_nothing_else_tells_of_crossings() -> None:
    with pytest.raises(ValueError, match=r"drive.csv has no column .*lane"):
        recording("a", "drive.csv", changed(lane=None))


def test_another_rate_is_refused_with_its_step() -> None:
    thinned = {name: values[::6] for name, values in columns(1).items()}
    with pytest.raises(ValueError, match=r"0\.1 s lie between rows 0 and 1"):
        recording("a", "a", thinned)


def test_a_gap_is_refused_where_it_is() -> None:
    time = columns(1)["time"].copy()
    time[700:] += 0.5
    with pytest.raises(ValueError, match="between rows 699 and 700"):
        recording("a", "a", changed(time=time))


def table(tmp_path: Path) -> Path:
    """Two sequences of two participants in one CSV."""
    parts = []
    for label, participant in (("x", 7), ("y", 8)):
        part = pd.DataFrame(columns(participant, num_changes=1))
        parts.append(part.assign(sequence=label, participant=participant))
    path = tmp_path / "drives.csv"
    pd.concat(parts).to_csv(path, index=False)
    return path


def test_sequences_of_a_table_are_separate_stretches(tmp_path: Path) -> None:
    first, second = read_recordings([table(tmp_path)])
    assert [first.driver, second.driver] == ["7", "8"]
    alone = recording("7", "x", columns(7, num_changes=1))
    np.testing.assert_allclose(first.features, alone.features, rtol=1e-12)
    np.testing.assert_array_equal(second.intended != 0, second.intended == -1)


def test_a_record_knows_its_driver() -> None:
    record = TrialRecord(metadata={"seed": 5, "participant": 2}, columns=columns(1))
    (made,) = recordings_of(record, "file")
    assert made.driver == "5-2"


def test_without_sequence_and_participant_the_file_is_the_driver() -> None:
    (made,) = recordings_of(TrialRecord(metadata={}, columns=columns(1)), "drive.csv")
    assert made.driver == "drive.csv"


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("lane", 0.5, "a: lane is 0.5 in row 7; give whole"),
        ("lane", -1, "a: lane is -1 in row 7; give whole"),
        ("adjacent_side", 0, "a: adjacent_side is 0 in row 7; give -1 (right) or +1"),
        ("crossing", 3, "a: crossing is 3 in row 7; give -1 (right), 0 or +1 (left)"),
        ("crossing", np.nan, "a: crossing is nan in row 7; give -1 (right), 0 or"),
        ("head_yaw", "abc", "a: column 'head_yaw' is 'abc' in row 7, expected a"),
        ("time", "0:07", "a: column 'time' is '0:07' in row 7, expected a number"),
    ],
)
def test_a_value_that_cannot_be_is_named_with_its_row(
    column: str, value: Any, said: str
) -> None:
    num = len(columns(1)["time"])
    table = changed(crossing=np.zeros(num))
    values = np.array(table.get(column, np.ones(num)), object)
    values[7] = value
    table[column] = values.astype(str if isinstance(value, str) else float)
    with pytest.raises(ValueError, match=f"^{re.escape(said)}"):
        recording("a", "a", table)


@pytest.mark.parametrize("lane", [0.5, -1.0, np.nan])
def test_a_lane_that_cannot_be_is_named_where_it_tells_of_crossings(
    lane: float,
) -> None:
    lanes = columns(1)["lane"].astype(float)
    lanes[7] = lane
    said = rf"^a: lane is {lane:g} in row 7; give whole"
    with pytest.raises(ValueError, match=said):
        recording("a", "a", changed(lane=lanes))


def test_degrees_are_noticed() -> None:
    degrees = np.degrees(np.asarray(columns(1)["yaw_angle"])) + 5.0
    (told,) = recording("a", "a", changed(yaw_angle=degrees)).notes
    assert told.startswith("a: yaw_angle looks like degrees, expected rad; if so, mul")
    assert recording("a", "a", columns(1)).notes == ()


def test_a_record_of_three_lanes_says_to_which_side_it_was_measured() -> None:
    road = {"num_lanes": 3.0, "overtaking_side": -1.0}
    about = {"seed": 1, "participant": 1, "configuration": {"road": road}}
    drive_on_three = columns(1)
    rows = np.arange(len(drive_on_three["time"])) * 3 // len(drive_on_three["time"])
    drive_on_three["lane"] = (2 - rows).astype(np.int8)  # left, middle, right
    (made,) = recordings_of(TrialRecord(about, drive_on_three), "a")
    # The middle lane's neighbour is that for overtaking; the last has only the other.
    assert [int(made.side[rows == third][0]) for third in (0, 1, 2)] == [-1, -1, 1]
    about["configuration"] = {"road": road | {"overtaking_side": 1.0}}
    (turned,) = recordings_of(TrialRecord(about, drive_on_three), "a")
    assert [int(turned.side[rows == third][0]) for third in (0, 1, 2)] == [-1, 1, 1]


ANGLE = FEATURES.index("steering_wheel_angle")


def test_a_record_in_bends_is_judged_by_the_car_that_was_driven() -> None:
    bend = np.full(len(columns(1)["time"]), 0.002)
    along = changed(road_curvature=bend)
    straight = recording("a", "a", columns(1))
    for car in ("default", "large"):
        about = {"seed": 1, "participant": 1, "car": car}
        (made,) = recordings_of(TrialRecord(about, along), "a")
        taken = -straight.side * (straight.features - made.features)[:, ANGLE]
        model, speed = CARS[car], along["longitudinal_velocity"]
        # By the slip angles of the axles: m a kappa v² / (L C), not by K_us.
        length = model.front_distance + model.rear_distance
        push = model.mass * 0.002 * speed**2 / length
        front = push * model.rear_distance / model.front_cornering_stiffness
        rear = push * model.front_distance / model.rear_cornering_stiffness
        asked = model.steering_ratio * (length * 0.002 + front - rear)
        np.testing.assert_allclose(taken, asked, rtol=1e-9)
