"""Lane changes start and end where the closed form of their path says."""

from __future__ import annotations

from math import inf, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.study.crossings import LEFT, RIGHT, excursion
from costeer.study.definitions import DEFAULTS, MeasureParameters
from costeer.study.lanes import lanes
from costeer.study.segments import Segments, segment
from tests.records.mirror import mirrored
from tests.study.shapes import (
    WIDTH,
    Columns,
    changes,
    duration_above_yaw,
    peak_yaw,
)

# Half a quintic lane change lies before the crossing: these two cross at 13 and 33 s.
OVER_AND_BACK = [(10.0, 6.0, RIGHT), (30.0, 6.0, LEFT)]
# Linear interpolation between 60 Hz samples of a quintic path errs by less.
TOLERANCE = 1e-3


def cut(columns: Columns, parameters: MeasureParameters | None = None) -> Segments:
    found = segment(columns, parameters or MeasureParameters())
    assert isinstance(found, Segments)
    return found


@pytest.mark.parametrize("duration", [4.0, 6.0, 8.0])
def test_duration_is_the_closed_form_of_a_quintic_change(duration: float) -> None:
    (change,) = cut(changes([(10.0, duration, RIGHT)])).changes
    assert change.crossing_time == pytest.approx(10.0 + duration / 2, abs=1e-9)
    assert change.end_time - change.start_time == pytest.approx(
        duration_above_yaw(duration), abs=TOLERANCE
    )
    middle = (change.start_time + change.end_time) / 2
    assert middle == pytest.approx(change.crossing_time, abs=1e-9)


def test_the_yaw_threshold_is_a_parameter() -> None:
    parameters = MeasureParameters(yaw_threshold=radians(1.0))
    (change,) = cut(changes([(10.0, 6.0, RIGHT)]), parameters).changes
    assert change.end_time - change.start_time == pytest.approx(
        duration_above_yaw(6.0, radians(1.0)), abs=TOLERANCE
    )


@pytest.mark.parametrize("rate", [20.0, 50.0, 120.0])
def test_the_sampling_rate_hardly_matters(rate: float) -> None:
    (change,) = cut(changes([(10.0, 6.0, RIGHT)], rate=rate)).changes
    assert change.end_time - change.start_time == pytest.approx(
        # The error of interpolation goes with the square of the step.
        duration_above_yaw(6.0),
        abs=TOLERANCE * (60.0 / rate) ** 2,
    )


def test_changes_are_numbered_and_have_a_direction() -> None:
    found = cut(changes(OVER_AND_BACK)).changes
    assert [change.number for change in found] == [1, 2]
    assert [change.direction for change in found] == [RIGHT, LEFT]


@given(st.floats(-1e5, 1e5))
def test_a_shift_of_time_shifts_everything(shift: float) -> None:
    columns = changes(OVER_AND_BACK)
    here = cut(columns)
    there = cut(columns | {"time": columns["time"] + shift})
    assert there.lane_keeping == here.lane_keeping
    for a, b in zip(here.changes, there.changes, strict=True):
        # Times near 1e5 s are exact to 1e-11 s.
        assert b.start_time - shift == pytest.approx(a.start_time, abs=1e-9)
        assert b.end_time - shift == pytest.approx(a.end_time, abs=1e-9)


def test_a_mirrored_drive_has_mirrored_changes() -> None:
    columns = changes(OVER_AND_BACK)
    here, there = cut(columns).changes, cut(mirrored(columns)).changes
    for a, b in zip(here, there, strict=True):
        assert b.direction == -a.direction
        assert (b.start_time, b.crossing_time, b.end_time) == pytest.approx(
            (a.start_time, a.crossing_time, a.end_time), abs=1e-9
        )


def test_a_change_that_began_before_the_record_is_dropped() -> None:
    columns = {name: values[660:] for name, values in changes(OVER_AND_BACK).items()}
    found = cut(columns)
    assert len(found.changes) == 1
    (dropped,) = found.dropped
    assert dropped.start_time == -inf
    assert dropped.reason == "started before the record"


def test_a_change_that_does_not_end_is_dropped() -> None:
    columns = changes(OVER_AND_BACK, length=34.0)
    (dropped,) = cut(columns).dropped
    assert dropped.end_time == inf
    assert dropped.reason == "did not end within the record"


def test_who_crosses_back_at_once_has_not_changed_lanes() -> None:
    # Crossings at 12 and 14.5 s; the second change starts as the first one ends.
    found = cut(changes([(10.0, 4.0, RIGHT), (12.5, 4.0, LEFT)]))
    assert found.changes == ()
    assert [dropped.reason for dropped in found.dropped] == [
        "crossed back within 3 s",
        "crossed back within 3 s",
    ]
    assert len(found.crossings) == 2


def test_who_stays_longer_has_changed_lanes_twice() -> None:
    found = cut(changes([(10.0, 4.0, RIGHT), (13.5, 4.0, LEFT)]))
    assert len(found.changes) == 2


def test_a_drift_across_the_line_is_no_lane_change() -> None:
    # 3.5 m in 40 s: at most 0.47 deg of yaw.
    assert peak_yaw(40.0) < radians(0.5)
    found = cut(changes([(10.0, 40.0, RIGHT)]))
    assert found.changes == ()
    assert "drifted across the line with the yaw under 0.5 deg" in (
        found.dropped[0].reason
    )


def keeping_times(columns: Columns) -> list[tuple[float, float]]:
    time = columns["time"]
    stretches = cut(columns).lane_keeping
    return [(time[rows.start], time[rows.stop - 1]) for rows in stretches]


def test_lane_keeping_is_the_left_lane_away_from_lane_changes() -> None:
    columns = changes(OVER_AND_BACK)
    first, second = cut(columns).changes
    (before, after) = keeping_times(columns)
    assert before[0] == 0.0
    assert before[1] == pytest.approx(first.start_time - 3.0, abs=1 / 60)
    assert before[1] < first.start_time - 3.0
    assert after[0] == pytest.approx(second.end_time + 3.0, abs=1 / 60)
    assert after[0] > second.end_time + 3.0
    assert after[1] == 60.0


def test_the_right_lane_is_not_lane_keeping() -> None:
    columns = changes([(10.0, 6.0, RIGHT)])
    assert len(keeping_times(columns)) == 1
    assert lanes(columns["lateral_position"], DEFAULTS)[-1] == 0


def test_events_are_not_lane_keeping() -> None:
    columns = changes(OVER_AND_BACK)
    event = np.where((columns["time"] >= 5.0) & (columns["time"] < 45.0), 1, 0)
    found = cut(columns | {"event": event})
    assert found.num_events == 1
    assert keeping_times(columns | {"event": event}) == [
        (0.0, pytest.approx(5.0 - 1 / 60)),
        (45.0, 60.0),
    ]


def test_a_dropped_crossing_is_not_lane_keeping_either() -> None:
    columns = changes([(10.0, 4.0, RIGHT), (12.5, 4.0, LEFT)])
    (before, after) = keeping_times(columns)
    assert before[1] < 10.0 - 2.0
    assert after[0] > 16.5 + 2.0


def test_a_record_without_crossings_is_all_lane_keeping() -> None:
    columns = changes([], offset=0.3)
    assert keeping_times(columns) == [(0.0, 60.0)]
    assert cut(columns).changes == ()


@pytest.mark.parametrize("name", ["lateral_position", "yaw_angle", "time"])
def test_what_is_missing_is_named(name: str) -> None:
    columns = changes([])
    del columns[name]
    assert segment(columns) == f"needs the column {name}, not recorded"


def test_gaps_and_empty_columns_are_named() -> None:
    columns = changes([])
    columns["yaw_angle"] = columns["yaw_angle"] * np.nan
    assert segment(columns) == "needs the column yaw_angle, undefined throughout"
    columns["yaw_angle"] = np.where(columns["time"] < 3, np.nan, 0.0)
    assert segment(columns) == "needs the column yaw_angle without gaps"


def test_an_excursion_is_interpolated() -> None:
    time = np.arange(7.0)
    signal = np.array([0.0, 0.0, 2.0, 4.0, 2.0, 0.0, 0.0])
    assert excursion(time, signal, 1.0, 3.0) == (1.5, 4.5)
    assert excursion(time, signal, 1.0, 0.5) is None
    # Between a sample below the threshold and one above it: on either side of it.
    assert excursion(time, signal, 1.0, 1.4) is None
    assert excursion(time, signal, 1.0, 1.6) == (1.5, 4.5)
    assert excursion(time, signal, 1.0, 4.4) == (1.5, 4.5)
    assert excursion(time, signal, 1.0, 4.6) is None
    assert excursion(time, signal - WIDTH, -9.0, 3.0) == (-inf, inf)
