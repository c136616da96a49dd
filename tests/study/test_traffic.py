"""Time to collision, gaps and headways have the values of their closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.study.analysis import Analysis, analyse
from costeer.study.definitions import MeasureParameters
from tests.study.worlds import SPEED, Columns, car, changing, mirrored, record, straight

LENGTH = 4.5  # of both cars: half of each lies between the middles and the gap
MIDDLE, RIGHT_LANE = -3.5, -7.0


def measured(columns: Columns, **road: float) -> Analysis:
    (found,) = analyse(record(columns, **road))
    return found


def values(columns: Columns, **road: float) -> dict[str, float]:
    return {name: one.value for name, one in measured(columns, **road).measures.items()}


def test_time_to_collision_is_gap_over_closing_speed() -> None:
    drive = straight()
    # 5 m/s slower and 400 m ahead: nearest at the end, after 60 s.
    gap = 400.0 - 5.0 * drive["time"]
    found = values(drive | car(1, gap + LENGTH, 0.0, SPEED - 5.0))
    assert found["time_to_collision_minimum"] == pytest.approx(100.0 / 5.0)
    # The gap falls evenly, so the 15th percentile is 15 % of the way up again.
    expected = (100.0 + 0.15 * 300.0) / 5.0
    assert found["time_to_collision_15th_percentile"] == pytest.approx(expected)


def test_a_gap_ends_at_the_rear_of_the_car_ahead_and_a_headway_at_its_front() -> None:
    found = values(straight() | car(1, 30.0 + LENGTH, 0.0, SPEED))
    assert found["time_gap_minimum"] == pytest.approx(30.0 / SPEED)
    assert found["time_gap_mean"] == pytest.approx(30.0 / SPEED)
    assert found["time_headway_minimum"] == pytest.approx((30.0 + LENGTH) / SPEED)
    assert found["time_headway_mean"] == pytest.approx((30.0 + LENGTH) / SPEED)


def test_who_keeps_the_distance_has_no_time_to_collision() -> None:
    found = measured(straight() | car(1, 30.0, 0.0, SPEED)).measures
    reason = "the car never came nearer to one ahead in its lane"
    assert found["time_to_collision_minimum"].reason == reason


def test_a_car_far_ahead_is_not_followed() -> None:
    found = measured(straight() | car(1, 200.0, 0.0, SPEED)).measures
    assert found["time_headway_mean"].reason == "no car was ahead by 6 s or less"
    assert found["time_headway_minimum"].value > 6.0


def test_the_nearest_car_of_the_own_lane_counts() -> None:
    cars = car(1, 60.0 + LENGTH, 0.0, SPEED) | car(2, 40.0 + LENGTH, 0.3, SPEED)
    beside = car(3, 10.0, MIDDLE, SPEED) | car(4, -20.0, 0.0, SPEED)
    found = values(straight() | cars | beside)
    assert found["time_gap_minimum"] == pytest.approx(40.0 / SPEED)


def test_a_car_counts_only_while_it_is_there() -> None:
    drive = straight()
    gone = np.where(drive["time"] < 30.0, np.nan, 30.0 + LENGTH)
    nearer = car(1, gone, 0.0, SPEED) | car(2, 50.0 + LENGTH, 0.0, SPEED)
    found = values(drive | nearer)
    half = (drive["time"] >= 30.0).mean()
    expected = (30.0 * half + 50.0 * (1.0 - half)) / SPEED
    assert found["time_gap_mean"] == pytest.approx(expected)


def test_the_leader_of_an_event_is_a_car_like_others() -> None:
    drive = straight(lateral=0.0)
    every = np.ones(drive["time"].size)
    lead = {
        "lead_distance": (30.0 + LENGTH) * every,
        "lead_velocity": (SPEED - 3.0) * every,
        "lead_lane": np.ma.masked_array(2 * every.astype(np.int8)),
    }
    assert values(drive | lead)["time_to_collision_minimum"] == pytest.approx(10.0)


def test_accepted_gaps_are_those_of_the_new_lane_at_the_start() -> None:
    drive = changing([(20.0, -1)])
    cars = car(1, 40.0 + LENGTH, MIDDLE, SPEED) | car(2, -(25.0 + LENGTH), MIDDLE, 25.0)
    others = car(3, 15.0, 0.0, SPEED) | car(4, -15.0, RIGHT_LANE, SPEED)
    (change,) = measured(drive | cars | others).lane_changes
    assert (change["from_lane"], change["to_lane"]) == (2, 1)
    assert change["lead_gap"] == pytest.approx(40.0)
    assert change["lead_time_gap"] == pytest.approx(40.0 / SPEED)
    assert change["lag_gap"] == pytest.approx(25.0)
    assert change["lag_time_gap"] == pytest.approx(25.0 / 25.0)
    assert change["lag_time_to_collision"] == pytest.approx(25.0 / (25.0 - SPEED))


def test_contacts_are_counted_by_kind() -> None:
    drive = straight()
    contact = np.zeros(drive["time"].size, np.int8)
    contact[100:150], contact[300:310], contact[-1] = 1, 1, 3
    found = values(drive | {"contact": contact})
    assert found["num_rumble_strip_contacts"] == 2
    assert found["num_barrier_collisions"] == 0
    assert found["num_car_collisions"] == 1


def test_the_mirrored_drive_has_the_same_measures() -> None:
    # No sample lies on a line, which belongs to the lane on its left.
    drive = changing([(20.005, -1), (40.005, 1)])
    drive |= car(1, 45.0, MIDDLE, SPEED) | car(2, -35.0, MIDDLE, 22.0)
    drive |= car(3, 90.0 - drive["time"], 0.0, SPEED - 1.0)
    drive["road_curvature"] = np.full(drive["time"].size, 1 / 600.0)
    here = measured(drive)
    there = measured(mirrored(drive, 3), overtaking_side=1.0)
    assert here.measures["num_lane_changes"].value == 2
    for name, one in here.measures.items():
        other = there.measures[name].value
        assert other == pytest.approx(one.value, rel=1e-9, nan_ok=True), name
    for row, other_row in zip(here.lane_changes, there.lane_changes, strict=True):
        assert other_row["direction"] == -row["direction"]  # type: ignore[operator]
        assert other_row["lead_gap"] == pytest.approx(row["lead_gap"], nan_ok=True)
        assert other_row["overshoot"] == pytest.approx(row["overshoot"])


def test_what_following_is_can_be_set() -> None:
    columns = straight() | car(1, 100.0 + LENGTH, 0.0, SPEED)
    (found,) = analyse(
        record(columns), parameters=MeasureParameters(following_headway=3.0)
    )
    assert found.measures["time_headway_mean"].reason
