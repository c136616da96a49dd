"""Emergencies: what is driven, what is read from records, and the report."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from costeer.emergencies.design import (
    APPEARS_AT,
    SITUATIONS,
    Emergency,
    Settings,
    planned,
    scenario_of,
    setup_of,
    situations_of,
)
from costeer.emergencies.outcome import EmergencyRow, drive_of, outcome_of
from costeer.emergencies.report import write_report
from costeer.emergencies.run import drive_all, num_drives, prepare, worst_of
from costeer.loop.trial import simulate_trial
from costeer.plant.place import BARRIER, CAR, NO_CONTACT
from costeer.records.columns import TrialRecord
from costeer.scenarios.reading import checked
from costeer.study.rates import wilson_interval

QUICK = Emergency("manual", 1, 70 / 3.6, 3.0, True, 1)
OBSTACLE_HALF, CAR_HALF = 0.5, 2.25


def made_up(**changed: np.ndarray) -> TrialRecord:
    """A car that drives at 20 m/s past an obstacle at 100 m, 2 m to its left."""
    time = np.arange(0.0, 8.0, 1 / 60)
    zeros = np.zeros_like(time)
    columns = {
        "time": time,
        "longitudinal_position": 20.0 * time,
        "lateral_position": zeros - 2.0,
        "longitudinal_velocity": zeros + 20.0,
        "steering_wheel_angle": zeros,
        "steering_wheel_rate": zeros,
        "driver_torque": zeros,
        "haptic_gain": zeros + 1.0,
        "brake": zeros,
        "contact": zeros,
        "mode": np.full(len(time), "lane_keeping"),
        "consistent": np.ones(len(time), bool),
        "car_01_position": np.where(time < 1.0, math.nan, 100.0),
        "car_01_lateral": np.where(time < 1.0, math.nan, 0.0),
    }
    return TrialRecord({}, columns | changed, ())


def outcome(record: TrialRecord, alone: TrialRecord | None = None) -> EmergencyRow:
    drive = QUICK._replace(condition="strong-normal")
    row = outcome_of(drive, record, alone or made_up())
    assert row is not None
    return row


def test_who_drives_past_in_another_lane_has_the_distance_between_the_bodies() -> None:
    row = outcome(made_up())
    assert row.smallest_distance == pytest.approx(2.0 - (1.75 + 1.8) / 2.0)
    assert math.isnan(row.smallest_time)  # it was never in the way
    assert not row.collided
    assert math.isnan(row.reaction_time)


@pytest.mark.parametrize(
    ("place", "across", "contact", "hit"),
    [
        (97.3, 0.0, CAR, "obstacle"),
        (97.3, 1.9, CAR, "obstacle"),
        (97.3, 3.5, CAR, "car"),
        (90.0, 0.0, CAR, "car"),
        (97.3, 0.0, BARRIER, "barrier"),
        (97.3, 0.0, NO_CONTACT, ""),
    ],
)
def test_what_was_hit_is_what_is_touched_at_the_end(
    place: float, across: float, contact: float, hit: str
) -> None:
    # Half an obstacle and half a car are 2.75 m along and 1.775 m across.
    usual = made_up().columns
    position, contacts = usual["longitudinal_position"].copy(), usual["contact"].copy()
    position[-1], contacts[-1] = place, contact
    record = made_up(
        longitudinal_position=position,
        lateral_position=np.full(len(position), across),
        contact=contacts,
    )
    assert outcome(record).hit == hit


def test_smallest_time_is_gap_over_speed_while_the_obstacle_is_in_the_way() -> None:
    time = made_up().columns["time"]
    # In the way until 4 s, at 80 m: 20 m between the middles, 17.25 between bumpers.
    aside = np.where(time < 4.0, 0.0, -2.0)
    row = outcome(made_up(lateral_position=aside))
    gap = 100.0 - 20.0 * time[time < 4.0][-1] - OBSTACLE_HALF - CAR_HALF
    assert row.smallest_time == pytest.approx(gap / 20.0)


@pytest.mark.parametrize("signal", ["steering_wheel_angle", "brake"])
def test_reaction_is_when_the_drive_differs_from_the_one_without(signal: str) -> None:
    time = made_up().columns["time"]
    wobble = 0.3 * np.sin(time)  # in both drives: no reaction
    moved = wobble + np.where(time < 1.7, 0.0, 0.2)
    row = outcome(made_up(**{signal: moved}), made_up(**{signal: wobble}))
    assert row.reaction_time == pytest.approx(0.7, abs=1 / 60)


@pytest.mark.parametrize(
    ("mode", "consistent", "situation"),
    [
        ("lane_keeping", True, 1),
        ("lane_keeping", False, 2),
        ("lane_changing", True, 3),
        ("lane_changing", False, 4),
    ],
)
def test_situation_is_read_when_the_obstacle_appears(
    mode: str, consistent: bool, situation: int
) -> None:
    time = made_up().columns["time"]
    then = time >= 1.0  # before, it was otherwise
    record = made_up(
        mode=np.where(then, mode, "lane_keeping"),
        consistent=np.where(then, consistent, not consistent),
    )
    assert outcome(record).situation == situation


def test_a_method_without_a_verdict_is_not_called_inconsistent() -> None:
    none = np.ma.masked_all(len(made_up().columns["time"]), bool)
    assert outcome(made_up(consistent=none)).situation == 1


@pytest.mark.parametrize(
    ("lateral", "left"), [(0.84, False), (0.86, True), (-4.34, False), (-4.36, True)]
)
def test_who_has_a_side_over_an_outer_line_has_left_the_road(
    lateral: float, left: bool
) -> None:
    # Lines at 1.75 and -5.25 m, half a car is 0.9 m wide.
    time = made_up().columns["time"]
    y = np.where(time < 6.0, -2.0, lateral)
    assert outcome(made_up(lateral_position=y)).left_road is left


def test_a_study_that_cannot_be_has_no_folder(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="ibhs"):
        prepare(tmp_path / "a", Settings(method="ibsh"))
    assert not (tmp_path / "a").exists()


def test_every_planned_drive_can_be_and_is_found_again_from_its_row() -> None:
    settings = Settings(drivers=1)
    drives = planned(settings)
    assert len(set(drives)) == len(drives) == 2 * 4 * 2 * (2 + 4 + 4)
    assert num_drives(settings) == len(drives) + 2 * (2 + 4 + 4)
    for drive in drives:
        checked(scenario_of(drive))
    assert situations_of("manual") == (1, 3)
    assert set(situations_of("weak-rapid")) == set(SITUATIONS)


def test_the_obstacle_appears_as_far_ahead_as_was_asked_for() -> None:
    drive = QUICK._replace(time_to_collision=2.0)
    columns = simulate_trial(setup_of(Settings(), drive)).columns
    first = int(np.flatnonzero(np.isfinite(columns["car_01_position"]))[0])
    place = columns["longitudinal_position"][first]
    speed = columns["longitudinal_velocity"][first]
    gap = columns["car_01_position"][first] - place - OBSTACLE_HALF - CAR_HALF
    assert place == pytest.approx(APPEARS_AT, abs=1.0)
    assert gap / speed == pytest.approx(2.0, abs=0.03)
    record = simulate_trial(setup_of(Settings(), drive, False))
    assert "car_01_position" not in record.columns


@pytest.mark.parametrize(
    ("count", "low", "high"), [(0, 0.0, 0.2775), (5, 0.2366, 0.7634)]
)
def test_wilson_interval_is_the_published_one(
    count: int, low: float, high: float
) -> None:
    # Newcombe (1998), of 10.
    assert wilson_interval(count, 10) == pytest.approx((low, high), abs=1e-4)


def test_worst_have_the_most_time_and_stand_once_for_condition_and_situation() -> None:
    row = outcome(made_up())._replace(collided=True)
    rows = [
        row._replace(time_to_collision=1.5, participant=1),
        row._replace(time_to_collision=3.0, participant=2),
        row._replace(time_to_collision=4.0, collided=False),
        row._replace(meant_situation=3, time_to_collision=2.0),
    ]
    assert [each.time_to_collision for each in worst_of(rows)] == [3.0, 2.0]


@pytest.mark.slow
def test_report_holds_tables_figures_and_records_that_replay(tmp_path: Path) -> None:
    settings = Settings(drivers=1, conditions=("manual", "strong-normal"))
    prepare(tmp_path, settings)
    rows = drive_all(settings, 2, lambda _: None)
    assert [drive_of(row) for row in rows] == planned(settings)
    page = write_report(tmp_path, settings, rows).read_text("utf-8")
    assert page.count("<table") == 5
    assert page.count("<svg") == 2
    table = (tmp_path / "emergencies.csv").read_text("utf-8").splitlines()
    assert len(table) == len(rows) + 1
    kept = list((tmp_path / "worst").glob("*.parquet"))
    assert len(kept) == len(worst_of(rows)) > 0
    early = [row.collided for row in rows if row.time_to_collision == 1.5]
    late = [row.collided for row in rows if row.time_to_collision == 4.0]
    assert sum(early) > 2 * sum(late)


KEEPING = str(Path(__file__).parents[2] / "examples/methods/pi_keeping.py")


@pytest.mark.usefixtures("undrawn")
def test_a_method_of_a_file_has_its_name_and_what_it_never_comes_to(
    tmp_path: Path,
) -> None:
    settings = Settings(1, 1, ("strong-normal",), KEEPING)
    prepare(tmp_path / "e", settings)
    gain = math.nan  # it has none
    row = outcome(made_up(haptic_gain=np.full(480, gain)))
    rows = [row._replace(meant_situation=number) for number in SITUATIONS]
    text = write_report(tmp_path / "e", settings, rows).read_text("utf-8")
    assert "method pi-keeping 1" in text
    assert KEEPING not in text
    assert "No drive came to (2), (3), (4)" in text
    every = [r._replace(situation=r.meant_situation) for r in rows]
    assert "No drive came" not in write_report(
        tmp_path / "e", settings, every
    ).read_text("utf-8")
