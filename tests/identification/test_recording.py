"""Recordings that cannot be fitted are refused with the way out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from costeer.identification.fit import fit_driver
from costeer.identification.recording import NEEDED, doubts_of, drive_of
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, ColumnParameters
from costeer.records.columns import TrialRecord
from tests.identification.driving import (
    cut,
    manual_setup,
    recorded,
    with_columns,
)


def table(record: TrialRecord) -> TrialRecord:
    """As read from a CSV: only the columns that a fit needs, no metadata."""
    return TrialRecord({}, {name: record.columns[name] for name in NEEDED})


@pytest.mark.parametrize("name", NEEDED)
def test_a_missing_column_is_named(name: str) -> None:
    with pytest.raises(ValueError, match=f"no column {name}; a fit needs time"):
        drive_of(with_columns(recorded(1), **{name: None}))


def broken(name: str, change: Callable[[np.ndarray], object]) -> TrialRecord:
    record = recorded(1)
    values = record.columns[name].copy()
    change(values)
    return with_columns(record, **{name: values})


def test_a_gap_is_named_with_its_row() -> None:
    record = broken("driver_torque", lambda v: v.__setitem__(slice(40, 45), np.nan))
    with pytest.raises(
        ValueError, match=r"driver_torque is undefined in 5 of .* row 40"
    ):
        drive_of(record)


def test_assistance_is_seen_in_the_torque_and_in_the_metadata() -> None:
    record = broken("applied_torque", lambda v: v.__setitem__(100, 0.4))
    with pytest.raises(ValueError, match=r"assisted: applied_torque reaches 0\.4"):
        drive_of(record)
    strong = TrialRecord(
        {**recorded(1).metadata, "strength_factor": 1.0}, recorded(1).columns
    )
    with pytest.raises(ValueError, match="assisted: its strength_factor is 1"):
        drive_of(strong)


def test_another_rate_is_refused_with_the_rate_that_is_needed() -> None:
    record = cut(recorded(1), slice(None, None, 2))
    with pytest.raises(ValueError, match="30 rows a second, a fit needs 60"):
        drive_of(record)


def test_uneven_steps_are_refused_with_their_rows() -> None:
    record = broken("time", lambda v: v.__setitem__(slice(200, None), v[200:] + 0.01))
    with pytest.raises(ValueError, match="between rows 199 and 200"):
        drive_of(record)


def test_one_row_is_no_recording() -> None:
    with pytest.raises(ValueError, match="1 rows; a fit needs minutes"):
        drive_of(cut(recorded(1), slice(0, 1)))


def test_hands_off_the_wheel_are_seen() -> None:
    record = broken("driver_torque", lambda v: v.fill(0.0))
    with pytest.raises(ValueError, match="hands are off the wheel"):
        drive_of(record)


def test_degrees_are_refused_with_the_factor() -> None:
    record = broken("steering_wheel_angle", lambda v: v.__imul__(57.3))
    with pytest.raises(ValueError, match=r"looks like degrees.*multiply it by 0\.0174"):
        drive_of(record)


def test_a_stop_is_refused() -> None:
    record = broken("longitudinal_velocity", lambda v: v.__setitem__(500, 1.0))
    with pytest.raises(ValueError, match=r"falls to 3\.6 km/h"):
        drive_of(record)


def test_an_unknown_car_is_refused() -> None:
    with pytest.raises(ValueError, match="car 'tram' is not known; choose one of"):
        drive_of(recorded(1), "tram")


def test_too_little_lane_keeping_says_how_much_there_is_and_is_needed() -> None:
    with pytest.raises(
        ValueError, match=r"has 43\.\d s of lane keeping.*needs 60\.0 s"
    ):
        fit_driver(cut(recorded(1), slice(0, 3000)))


def test_a_plain_table_is_enough() -> None:
    drive = drive_of(table(recorded(1)))
    assert drive.head_yaw is None
    assert drive.free is None
    assert drive.car == drive_of(recorded(1)).car


def test_whole_numbers_are_taken_as_numbers() -> None:
    record = broken("driver_torque", lambda v: v.__setitem__(slice(None), np.round(v)))
    whole = with_columns(
        record, driver_torque=record.columns["driver_torque"].astype(int)
    )
    np.testing.assert_array_equal(
        drive_of(whole).driver_torque, drive_of(record).driver_torque
    )


def test_a_lost_head_keeps_its_last_place() -> None:
    record = broken("head_yaw", lambda v: v.__setitem__(slice(10, 20), np.nan))
    yaw = drive_of(record).head_yaw
    assert yaw is not None
    np.testing.assert_array_equal(yaw[10:20], yaw[9])


def test_a_head_that_is_never_seen_is_none() -> None:
    assert drive_of(broken("head_yaw", lambda v: v.fill(np.nan))).head_yaw is None


def test_without_events_a_near_leader_is_no_free_road() -> None:
    record = recorded(1)
    drive = drive_of(with_columns(record, event=None))
    gap = record.columns["lead_distance"]
    near = (gap > 0.0) & (gap <= 100.0)
    assert drive.free is not None
    np.testing.assert_array_equal(drive.free, ~near)
    assert near.any()


def test_a_trial_record_says_with_which_car_and_column_it_was_driven() -> None:
    own = (("car.mass", 2000.0), ("column.stiffness", 3.0))
    setup = manual_setup(1, 200.0)._replace(car="large", parameters=own)
    drive = drive_of(simulate_trial(setup))
    assert drive.car == CARS["large"]._replace(mass=2000.0)
    assert drive.column == ColumnParameters(stiffness=3.0)


def test_an_own_car_is_that_of_the_record_and_can_be_named_for_a_table(
    tmp_path: Path,
) -> None:
    estate = CARS["default"]._replace(mass=1720.0)
    record = simulate_trial(manual_setup(1, 200.0)._replace(car=estate))
    assert record.metadata["car"] == "own"
    assert drive_of(record).car == estate
    file = tmp_path / "estate.yaml"
    file.write_text("mass: 1720")
    assert drive_of(table(record)).car == CARS["default"]
    assert drive_of(table(record), str(file)).car == estate
    with pytest.raises(ValueError, match=r"car 'lorry' is not known.*NAME\.yaml"):
        drive_of(table(record), "lorry")


def test_a_yaw_from_0_to_2_pi_is_the_same_drive() -> None:
    whole = table(recorded(1))
    wrapped = with_columns(whole, yaw_angle=whole.columns["yaw_angle"] % (2.0 * np.pi))
    np.testing.assert_allclose(
        drive_of(wrapped).yaw_angle, whole.columns["yaw_angle"], atol=1e-12
    )
    assert doubts_of(wrapped) == ["yaw_angle runs from 0 to 2 pi: taken as -pi to pi"]


@pytest.mark.slow
def test_signs_that_contradict_each_other_are_told_with_the_fit() -> None:
    whole = table(recorded(1))
    flipped = with_columns(whole, yaw_angle=-whole.columns["yaw_angle"])
    assert doubts_of(whole) == []
    told = fit_driver(cut(flipped, slice(0, 12_000))).notes
    for words in ("yaw_angle and lateral_position contradict", "flip the one"):
        assert any(words in note for note in told)
