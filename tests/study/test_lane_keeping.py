"""Keeping the lane: deviation, time to the line and departures in closed form."""

from __future__ import annotations

from math import inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.study.crossings import LEFT, RIGHT
from costeer.study.definitions import DEFAULTS
from costeer.study.lane_keeping import (
    lane_departures,
    lateral_speed,
    sdlp,
    time_to_line_crossing,
    times_to_line_crossing,
)
from costeer.study.segments import Segments, segment
from costeer.study.trial_measures import prepare, trial_measures
from tests.study.shapes import Columns, changes

# Half the lane minus half the car: the centre may move so far before a wheel is on
# the line, (3.5 - 1.8) / 2.
ROOM = 0.85


def weaving(amplitude: float, offset: float = 0.0, period: float = 10.0) -> Columns:
    columns = changes([], length=60.0)
    phase = 2 * pi * columns["time"] / period
    position = offset + amplitude * np.sin(phase)
    return columns | {"lateral_position": position}


def cut(columns: Columns) -> Segments:
    found = segment(columns)
    assert isinstance(found, Segments)
    return found


@given(st.floats(0.01, 0.8), st.floats(-0.5, 0.5))
def test_sdlp_of_a_sine_is_its_amplitude_over_root_two(
    amplitude: float, offset: float
) -> None:
    columns = weaving(amplitude, offset)
    # n - 1 instead of n, and one sample more than whole periods: both below 1/3600.
    assert sdlp(columns, cut(columns)).value == pytest.approx(
        amplitude / sqrt(2), rel=3e-4
    )


def test_sdlp_has_one_mean_for_all_stretches() -> None:
    # 0.3 m left before the overtaking, 0.3 m right after it: two means would say 0.
    columns = changes([(30.0, 4.0, RIGHT), (50.0, 4.0, LEFT)], length=84.0, offset=0.3)
    after = columns["time"] >= 52.5
    columns["lateral_position"] = columns["lateral_position"] - 0.6 * after
    # The jump is in the second lane change; both stretches last about 26 s.
    assert sdlp(columns, cut(columns)).value == pytest.approx(0.3, rel=0.01)


def test_sdlp_divides_by_one_less_than_the_samples() -> None:
    columns = {name: values[:2] for name, values in changes([]).items()}
    columns["lateral_position"] = np.array([0.0, 0.2])
    columns["time"] = np.array([0.0, 1.0])
    assert sdlp(columns, cut(columns)).value == pytest.approx(0.2 / sqrt(2), rel=1e-12)


def test_without_lane_keeping_there_is_no_sdlp() -> None:
    columns = changes([], offset=-3.5)
    found = sdlp(columns, cut(columns))
    assert np.isnan(found.value)
    assert "never in the left lane" in found.reason
    speed = lateral_speed(columns)
    for measure in times_to_line_crossing(columns, speed, cut(columns)):
        assert "never in the left lane" in measure.reason


@pytest.mark.parametrize("direction", [LEFT, RIGHT])
def test_time_to_line_crossing_is_gap_over_speed(direction: int) -> None:
    position = direction * np.array([0.0, 0.45, 0.85, 1.2])
    times = time_to_line_crossing(position, np.full(4, 0.2 * direction))
    np.testing.assert_allclose(times, [4.25, 2.0, 0.0, 0.0], atol=1e-12)
    away = time_to_line_crossing(position, np.full(4, -0.2 * direction))
    np.testing.assert_allclose(away, [4.25, 6.5, 8.5, 10.25], atol=1e-12)


def test_without_lateral_speed_the_line_is_never_reached() -> None:
    assert time_to_line_crossing(np.zeros(1), np.zeros(1))[0] == inf


def test_least_and_median_time_are_of_lane_keeping_only() -> None:
    columns = changes([(30.0, 4.0, RIGHT), (50.0, 4.0, LEFT)], length=84.0)
    drift = 0.01 * columns["time"]
    columns["lateral_position"] = columns["lateral_position"] + drift
    least, median = times_to_line_crossing(
        columns, lateral_speed(columns), cut(columns)
    )
    # Drifting left at 0.01 m/s, 84 s to the end; in the changes it would be under 1 s.
    assert least.value == pytest.approx((ROOM - 0.84) / 0.01, abs=1e-6)
    assert 10.0 < median.value < 80.0


def departures(columns: Columns) -> list[tuple[float, float]]:
    found = lane_departures(columns, lateral_speed(columns), cut(columns))
    time = columns["time"]
    return [(time[rows.start], time[rows.stop - 1]) for rows in found]


@pytest.mark.parametrize(("peak", "number"), [(0.84, 0), (0.86, 12)])
def test_a_departure_is_a_wheel_over_the_line(peak: float, number: int) -> None:
    # Six periods, each with a peak on either side.
    assert len(departures(weaving(peak))) == number


def test_the_outer_lines_count_too() -> None:
    on_the_verge = weaving(0.1, offset=-3.5 - 0.8)
    assert len(departures(on_the_verge)) == 6


def test_a_lane_change_is_no_departure() -> None:
    assert departures(changes([(10.0, 8.0, RIGHT), (30.0, 8.0, LEFT)])) == []


def test_a_slow_end_of_a_lane_change_is_no_departure() -> None:
    # A change of 3.5 m planned 0.5 m short of the centre ends 1.3 s before its yaw
    # is zero; there the car is still 0.6 m off, or 1.1 m with the offset.
    columns = changes([(10.0, 12.0, RIGHT)], offset=0.5)
    assert departures(columns) == []


@pytest.mark.parametrize(("side", "number"), [(RIGHT, 0), (LEFT, 1)])
def test_who_is_over_a_line_at_the_end_may_be_changing_lanes(
    side: int, number: int
) -> None:
    # The left lane of two: to the right there is a lane, to the left the verge.
    columns = changes([])
    time = columns["time"]
    columns["lateral_position"] = side * np.clip(0.2 * (time - time[-1] + 5.0), 0, 1)
    assert len(departures(columns)) == number
    back = {name: np.append(each, each[:1]) for name, each in columns.items()}
    back["time"][-1] = 2.0 * time[-1] - time[-2]
    assert len(departures(back)) == 1


def test_a_lane_change_cut_by_the_record_is_no_departure() -> None:
    # Crosses at 14 s and would settle at 18 s; the record ends, or starts, between.
    columns = changes([(10.0, 8.0, RIGHT)])
    time = columns["time"]
    before = {name: values[time < 14.5] for name, values in columns.items()}
    after = {name: values[time > 13.5] for name, values in columns.items()}
    for part in (before, after):
        assert len(cut(part).dropped) == 1
        assert departures(part) == []


def test_crossing_the_line_and_back_is_a_departure() -> None:
    # At 0.5 m beyond the line it turns: the wheels stay on the line all the while.
    columns = changes([(10.0, 4.0, RIGHT), (11.5, 4.0, LEFT)])
    assert -2.65 < columns["lateral_position"].min() < -1.75
    assert len(departures(columns)) == 1


def test_a_drift_across_the_line_is_a_departure() -> None:
    assert len(departures(changes([(10.0, 40.0, RIGHT)]))) == 1


def test_the_lane_driven_in_is_measured_if_wanted() -> None:
    wander = 0.2 * np.sin(np.arange(1200) / 60.0)
    right = {name: v[:1200] for name, v in changes([], offset=-3.5).items()}
    left = right | {"lateral_position": wander}
    right["lateral_position"] = wander - 3.5
    any_lane = DEFAULTS._replace(any_lane=1.0)
    here, there = (trial_measures(prepare(c, any_lane)) for c in (left, right))
    for name in ("sdlp", "line_crossing_time_minimum", "lane_keeping_duration"):
        assert here[name].value == pytest.approx(there[name].value, rel=1e-9)
    assert trial_measures(prepare(left))["sdlp"] == here["sdlp"]


@pytest.mark.parametrize("rate", [10.0, 20.0, 50.0, 60.0, 100.0])
@pytest.mark.parametrize("step", [0.01, 0.005, 1e-9])
def test_a_rounded_position_gives_the_time_of_the_whole_one(
    rate: float, step: float
) -> None:
    # Least of (0.85 - 0.2 sin) / (0.2 w cos) is sqrt(0.85^2 - 0.2^2) / (0.2 w).
    time = np.arange(0.0, 120.0, 1.0 / rate)
    sway = 0.2 * np.sin(2.0 * np.pi * 0.02 * time)
    columns = {
        "time": time,
        "lateral_position": np.round(sway / step) * step,
        "yaw_angle": np.zeros(time.size),
    }
    found = trial_measures(prepare(columns))["line_crossing_time_minimum"]
    assert found.value == pytest.approx(np.sqrt(0.85**2 - 0.2**2) / 0.02513, rel=0.05)


def test_a_car_that_stands_still_sideways_has_no_time_to_the_line() -> None:
    time = np.arange(0.0, 20.0, 0.05)
    noise = 1e-16 * np.random.default_rng(1).normal(size=time.size)
    columns = {"time": time, "lateral_position": 0.1 + noise, "yaw_angle": 0.0 * time}
    found = trial_measures(prepare(columns))
    for name in ("line_crossing_time_minimum", "line_crossing_time_median"):
        assert "the car does not move sideways" in found[name].reason


@pytest.mark.parametrize("num_rows", [2, 10, 59])
def test_too_few_rows_give_no_value_but_a_reason(num_rows: int) -> None:
    columns = {name: values[:num_rows] for name, values in changes([]).items()}
    found = trial_measures(prepare(columns))
    for name in ("sdlp", "swrr", "line_crossing_time_minimum", "mean_speed"):
        assert np.isnan(found[name].value)
    assert f"{num_rows} rows are too short" in found["sdlp"].reason
