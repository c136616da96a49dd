"""One lane change: durations by speed, overshoot and steering in closed form."""

from __future__ import annotations

from math import atan, isnan, pi, radians, sqrt

import numpy as np
import pytest

from costeer.study.crossings import LEFT, RIGHT
from costeer.study.lane_keeping import lateral_speed
from costeer.study.manoeuvres import (
    duration_sensitivity,
    is_assisted,
    overshoot,
    peak_steering_angle,
    rms,
    settling,
    speed_measures,
    steering_velocity_rms,
)
from costeer.study.segments import LaneChange, Segments, segment
from tests.records.mirror import mirrored
from tests.study.shapes import (
    Columns,
    changes,
    duration_above_speed,
    duration_above_yaw,
)


def only_change(columns: Columns) -> LaneChange:
    found = segment(columns)
    assert isinstance(found, Segments)
    (change,) = found.changes
    return change


@pytest.mark.parametrize("duration", [4.0, 6.0, 8.0])
@pytest.mark.parametrize("direction", [LEFT, RIGHT])
def test_speed_measures_are_those_of_a_quintic(duration: float, direction: int) -> None:
    offset = 0.0 if direction == RIGHT else -3.5
    columns = changes([(10.0, duration, direction)], offset=offset)
    found = speed_measures(columns, lateral_speed(columns), only_change(columns))
    # Speed is the central difference of 60 Hz positions: 1e-3 s and 1e-4 m/s.
    expected = duration_above_speed(duration, 0.1)
    assert found["duration_by_speed"] == pytest.approx(expected, abs=2e-3)
    assert found["onset_to_crossing"] == pytest.approx(expected / 2, abs=1e-3)
    assert found["peak_lateral_speed"] == pytest.approx(
        1.875 * 3.5 / duration, abs=1e-3
    )


def test_an_onset_before_the_record_is_not_known() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    change = only_change(columns)
    late = {name: values[11 * 60 :] for name, values in columns.items()}
    found = speed_measures(late, lateral_speed(late), change)
    assert isnan(found["duration_by_speed"])
    assert isnan(found["onset_to_crossing"])


def test_duration_is_given_for_other_thresholds_too() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    found = duration_sensitivity(columns, only_change(columns))
    for name, degrees in (
        ("duration_quarter_degree", 0.25),
        ("duration_one_degree", 1.0),
    ):
        expected = duration_above_yaw(6.0, radians(degrees))
        # Interpolation between 60 Hz samples.
        assert found[name] == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("direction", [LEFT, RIGHT])
def test_a_quintic_settles_when_its_yaw_falls_to_a_third_of_a_degree(
    direction: int,
) -> None:
    offset = 0.0 if direction == RIGHT else -3.5
    columns = changes([(10.0, 6.0, direction)], offset=offset)
    found = settling(columns, only_change(columns))
    calm, published = (duration_above_yaw(6.0, radians(d)) for d in (0.3, 0.5))
    assert found["settled_time"] == pytest.approx(13.0 + calm / 2, abs=2e-3)
    expected = (calm + published) / 2
    assert found["duration_until_settled"] == pytest.approx(expected, abs=2e-3)


def swinging(until: float) -> Columns:
    """A change from 10 to 16 s, then a yaw of 0.4 deg to and fro, 1 s each way."""
    columns = changes([(10.0, 6.0, RIGHT)])
    time = columns["time"]
    after = (time > 16.0) & (time < until)
    swing = radians(0.4) * np.sin(pi * (time - 16.0))
    return columns | {"yaw_angle": np.where(after, swing, columns["yaw_angle"])}


def test_who_swings_has_ended_by_yaw_and_settles_later() -> None:
    still, swings = changes([(10.0, 6.0, RIGHT)]), swinging(20.0)
    change = only_change(swings)
    assert change.end_time == only_change(still).end_time
    # The last half swing falls below 0.3 deg where sin = 3/4.
    last = 20.0 - np.arcsin(0.75) / pi
    assert settling(swings, change)["settled_time"] == pytest.approx(last, abs=2e-3)


def test_two_seconds_must_be_in_the_record() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    change, whole = only_change(columns), settling(columns, only_change(columns))
    for margin, known in ((0.05, True), (-0.05, False)):
        rows = columns["time"] <= whole["settled_time"] + 2.0 + margin
        short = {name: values[rows] for name, values in columns.items()}
        assert isnan(settling(short, change)["settled_time"]) != known


def test_who_goes_back_before_settling_has_no_time() -> None:
    columns = changes([(10.0, 6.0, RIGHT), (16.5, 6.0, LEFT)])
    segments = segment(columns)
    assert isinstance(segments, Segments)
    first, second = segments.changes
    assert isnan(settling(columns, first)["settled_time"])
    assert settling(columns, second)["settled_time"] > second.end_time


def test_a_slow_change_has_no_duration_above_one_degree() -> None:
    # 3.5 m in 25 s: at most 0.75 deg.
    columns = changes([(10.0, 25.0, RIGHT)])
    found = duration_sensitivity(columns, only_change(columns))
    assert isnan(found["duration_one_degree"])
    assert found["duration_quarter_degree"] > 10.0


def ringing(beyond: float) -> Columns:
    """A change 3.5 m + `beyond` wide, and back by `beyond` after it."""
    columns = changes([(10.0, 6.0, RIGHT)])
    factor = (3.5 + beyond) / 3.5
    back = np.clip((columns["time"] - 16.0) / 4.0, 0.0, 1.0)
    position = factor * columns["lateral_position"]
    position = position + beyond * (1 - np.cos(pi * back)) / 2
    return columns | {"lateral_position": position}


@pytest.mark.parametrize("beyond", [0.1, 0.4])
def test_overshoot_is_the_distance_at_the_first_extremum(beyond: float) -> None:
    # The extremum lies on a sample.
    columns = ringing(beyond)
    assert overshoot(columns, only_change(columns)) == pytest.approx(
        abs(beyond), abs=1e-9
    )


def test_stopping_short_of_the_centre_counts_likewise() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    columns["lateral_position"] = columns["lateral_position"] * 3.3 / 3.5
    assert overshoot(columns, only_change(columns)) == pytest.approx(0.2, abs=1e-9)


def test_overshoot_is_the_same_in_the_mirror() -> None:
    columns = ringing(0.3)
    other = mirrored(columns)
    assert overshoot(other, only_change(other)) == pytest.approx(0.3, abs=1e-9)


def test_overshoot_needs_an_extremum() -> None:
    columns = changes([(10.0, 6.0, RIGHT)], length=15.9)
    assert isnan(overshoot(columns, only_change(columns)))


def steered(columns: Columns, amplitude: float, frequency: float) -> Columns:
    phase = 2 * pi * frequency * columns["time"]
    return columns | {
        "steering_wheel_angle": amplitude * np.sin(phase),
        "steering_wheel_rate": amplitude * 2 * pi * frequency * np.cos(phase),
    }


def test_steering_is_measured_from_start_to_end() -> None:
    columns = steered(changes([(10.0, 6.0, RIGHT)]), 0.1, 10.0)
    change = only_change(columns)
    outside = columns["time"] < change.start_time
    columns["steering_wheel_rate"] = np.where(
        outside, 9.0, columns["steering_wheel_rate"]
    )
    columns["steering_wheel_angle"] = np.where(
        outside, 9.0, columns["steering_wheel_angle"]
    )
    # 46 periods of a sine less a fraction of one, six samples each.
    assert peak_steering_angle(columns, change) == pytest.approx(
        0.1 * sqrt(3) / 2, rel=1e-9
    )
    assert steering_velocity_rms(columns, change) == pytest.approx(
        0.1 * 20 * pi / sqrt(2), rel=0.01
    )


def test_the_steering_rate_is_derived_where_it_is_not_recorded() -> None:
    columns = steered(changes([(10.0, 6.0, RIGHT)]), 0.1, 0.5)
    change = only_change(columns)
    recorded = steering_velocity_rms(columns, change)
    del columns["steering_wheel_rate"]
    # Central differences of a 0.5 Hz sine at 60 Hz: (2π/120)²/6.
    assert steering_velocity_rms(columns, change) == pytest.approx(recorded, rel=1e-3)


def test_a_change_is_assisted_if_a_path_was_followed_in_it() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    change = only_change(columns)
    time = columns["time"]
    mode = np.full(time.size, "lane_keeping", dtype="<U13")
    assert not is_assisted(columns, change)
    assert not is_assisted(columns | {"mode": mode}, change)
    mode[(time > 10.0) & (time < 12.0)] = "lane_changing"
    assert is_assisted(columns | {"mode": mode}, change)
    mode[time > change.start_time] = "lane_keeping"
    assert not is_assisted(columns | {"mode": mode}, change)


def test_root_mean_square() -> None:
    assert rms(np.array([3.0, -4.0])) == pytest.approx(sqrt(12.5))
    assert isnan(rms(np.zeros(0)))


def test_yaw_of_the_shapes_is_that_of_their_path() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    slope = np.gradient(columns["lateral_position"], columns["longitudinal_position"])
    assert columns["yaw_angle"].min() == pytest.approx(-atan(-slope.min()), rel=1e-4)
