"""Lane changes, lane keeping and triggers on roads of other lanes, and on curves."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from costeer.study.analysis import Analysis, analyse
from costeer.study.definitions import MeasureParameters
from costeer.study.detection import Detection, detect
from costeer.study.lanes import adjacent_side
from costeer.study.measures import prepared
from costeer.study.segments import Segments
from costeer.study.trigger_costs import trigger_costs
from tests.study.worlds import LANE, SPEED, Columns, changing, record, straight

THREE = MeasureParameters(num_lanes=3.0)


def cut(columns: Columns, **road: float) -> Segments:
    found = prepared(record(columns, **road)).segments
    assert isinstance(found, Segments)
    return found


def measured(columns: Columns, **road: float) -> Analysis:
    (found,) = analyse(record(columns, **road))
    return found


def test_lane_changes_on_three_lanes_are_found_with_their_lanes() -> None:
    columns = changing([(5.0, -1), (17.0, -1), (30.0, 1), (45.0, 1)])
    found = cut(columns)
    lanes = [(each.lane - each.direction, each.lane) for each in found.changes]
    assert lanes == [(2, 1), (1, 0), (0, 1), (1, 2)]
    times = [each.crossing_time for each in found.changes]
    assert times == pytest.approx([8.0, 20.0, 33.0, 48.0])
    assert not found.dropped


def test_two_lanes_in_one_go_are_two_changes_and_no_crossing_back() -> None:
    found = cut(changing([(10.0, -1), (12.0, -1)]))
    assert [each.lane for each in found.changes] == [1, 0]
    assert not found.dropped


def test_overshoot_is_from_the_centre_of_the_lane_led_to() -> None:
    columns = changing([(5.0, -1), (25.0, -1)])
    time = columns["time"]
    for start, beyond in ((11.0, 0.2), (31.0, 0.3)):
        swing = np.clip((time - start) / 4.0, 0.0, 1.0)
        columns["lateral_position"] -= beyond * np.sin(pi * swing) ** 2
    rows = measured(columns).lane_changes
    assert [row["overshoot"] for row in rows] == pytest.approx([0.2, 0.3], abs=1e-3)


def test_a_change_that_goes_on_to_the_next_lane_has_no_overshoot() -> None:
    first, second = measured(changing([(10.0, -1), (12.0, -1)])).lane_changes
    assert np.isnan(float(str(first["overshoot"])))
    assert second["overshoot"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("lane", [0, 1, 2])
def test_sdlp_of_a_sine_about_any_lane_of_a_curve(lane: int) -> None:
    columns = straight(lateral=(lane - 2) * LANE)
    columns["lateral_position"] += 0.3 * np.sin(2 * pi * 0.1 * columns["time"])
    columns["road_curvature"] = np.full(columns["time"].size, 1 / 500.0)
    found = measured(columns).measures["sdlp"].value
    assert found == pytest.approx(0.3 / sqrt(2), rel=1e-3)


def test_under_right_hand_traffic_lane_keeping_is_in_the_right_lane() -> None:
    columns = straight(lateral=-LANE)
    found = measured(columns, num_lanes=2.0, overtaking_side=1.0)
    assert not found.measures["sdlp"].reason
    other = measured(columns, num_lanes=2.0, overtaking_side=-1.0)
    assert "never in the left lane" in other.measures["sdlp"].reason


def test_lanes_are_as_wide_as_the_record_says() -> None:
    columns = straight(lateral=-1.6)
    assert not cut(columns, num_lanes=2.0).crossings
    columns["lateral_position"] = np.where(columns["time"] < 30, -1.4, -1.6)
    assert not cut(columns, num_lanes=2.0).crossings
    assert len(cut(columns, num_lanes=2.0, lane_width=3.0).crossings) == 1


def test_the_inference_looks_to_the_overtaking_side_if_there_is_a_lane() -> None:
    assert [adjacent_side(THREE, lane) for lane in (0, 1, 2)] == [1, -1, -1]
    right_hand = THREE._replace(overtaking_side=1.0)
    assert [adjacent_side(right_hand, lane) for lane in (0, 1, 2)] == [1, 1, -1]


def triggered(at: float) -> Columns:
    """A drive from the middle lane to the left one with a trigger."""
    columns = changing([(20.0, 1)], lateral=-LANE)
    flags = np.abs(columns["time"] - at) < 0.1
    return columns | {"intention": flags, "crossing_probability": flags * 1.0}


def test_a_return_from_the_middle_lane_is_missed_by_a_look_to_the_right() -> None:
    found = detect(triggered(21.0), THREE)
    assert isinstance(found, Detection)
    (trigger,) = found.triggers
    assert (trigger.direction, trigger.verdict) == (-1, "false")
    assert len(found.crossings) == 1


def test_a_false_trigger_in_the_middle_lane_is_measured_from_its_centre() -> None:
    columns = triggered(5.0)
    columns["lateral_position"] = columns["lateral_position"] - 0.4 * (
        np.abs(columns["time"] - 8.0) < 1.0
    )
    (false, _) = trigger_costs(prepared(record(columns)))
    assert false["kind"] == "false"
    assert false["largest_deviation"] == pytest.approx(0.4)


def test_a_constant_curve_asks_for_the_angle_of_the_steady_car() -> None:
    columns = straight()
    radius = 500.0
    columns["road_curvature"] = np.full(columns["time"].size, 1 / radius)
    # The steady single-track car, from its equilibrium of forces and moments: the
    # axles carry m v²/R in the ratio of their distances, by slip angles F/C.
    mass, front, rear, ratio = 1500.0, 1.10, 1.60, 16.0
    force = mass * SPEED**2 / radius
    slip_front = force * rear / (front + rear) / 110e3
    slip_rear = force * front / (front + rear) / 120e3
    wheel = ratio * ((front + rear) / radius + slip_front - slip_rear)
    columns["steering_wheel_angle"] = np.full(columns["time"].size, wheel + 0.01)
    found = measured(columns).measures
    assert found["steering_beyond_curve_rms"].value == pytest.approx(0.01)
    assert found["steering_beyond_curve_peak"].value == pytest.approx(0.01)


def test_old_records_were_driven_on_the_papers_road() -> None:
    columns = changing([(20.0, -1)])
    old = record(columns)._replace(metadata={})
    (found,) = analyse(old)
    (crossing,) = prepared(old).segments.crossings  # type: ignore[union-attr]
    assert crossing.lane == 0
    assert found.measures["num_lane_changes"].value == 1
