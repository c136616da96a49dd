"""What false and missed triggers cost, on drives whose answers are known."""

from __future__ import annotations

from math import asin, isnan, pi, radians, sqrt, tan

import numpy as np
import pytest

from costeer.study.crossings import LEFT, RIGHT
from costeer.study.detection import EARLY, FALSE, TRUE
from costeer.study.trial_measures import prepare
from costeer.study.trigger_costs import COST_COLUMNS, Row, trigger_costs
from costeer.study.trigger_episodes import MISSED
from tests.records.mirror import mirrored
from tests.study.shapes import SPEED, Columns, changes
from tests.study.synthetic import faded_gain

DT = 1.0 / 60.0

# Crossings at 13 s to the right and 33 s to the left, yaw from 10.3 to 15.7 s or so.
PLAN = [(10.0, 6.0, RIGHT), (30.0, 6.0, LEFT)]
MEANT = ((8.0, 17.0, RIGHT), (28.0, 37.0, LEFT))
FALSE_AT = 45.0


def inside(columns: Columns, start: float, end: float) -> np.ndarray:
    time = columns["time"]
    return (time >= start - 1e-9) & (time < end - 1e-9)


def drive(
    *triggers: float,
    bump: float = 0.0,
    disputes: tuple[tuple[float, float], ...] = (),
    meant: tuple[tuple[float, float, int], ...] = MEANT,
) -> Columns:
    """Two lane changes, and from 45 to 49 s a sine-squared bump to the right [m]."""
    columns = changes(PLAN)
    time = columns["time"]
    phase = pi * np.clip(time - FALSE_AT, 0.0, 4.0) / 4.0
    speed = SPEED * np.tan(columns["yaw_angle"])
    speed -= bump * pi / 4.0 * np.sin(2.0 * phase)
    intention, decision = np.zeros(time.size, bool), np.zeros(time.size, np.int8)
    for instant in triggers:
        intention |= inside(columns, instant, instant + 0.1)
    for start, end, direction in meant:
        decision[inside(columns, start, end)] = direction
    consistent = np.ones(time.size, bool)
    for start, end in disputes:
        consistent &= ~inside(columns, start, end)
    position = columns["lateral_position"] - bump * np.sin(phase) ** 2
    return columns | {
        "lateral_position": position,
        "yaw_angle": np.arctan2(speed, SPEED),
        "intention": intention,
        "crossing_probability": intention.astype(float),
        "driver_intention": np.ma.MaskedArray(decision, mask=False),
        "mode": np.full(time.size, "lane_keeping"),
        "driver_torque": np.zeros(time.size),
        "applied_torque": np.zeros(time.size),
        "torque_agreement": np.zeros(time.size),
        "consistent": np.ma.MaskedArray(consistent, mask=False),
        "haptic_gain": faded_gain(consistent),
        "target_lane": np.ma.MaskedArray((position > -1.75).astype(int), mask=False),
    }


def changed(
    columns: Columns, name: str, start: float, end: float, value: float
) -> None:
    columns[name][inside(columns, start, end)] = value


def rows(columns: Columns) -> list[Row]:
    return trigger_costs(prepare(columns))


def row(columns: Columns, kind: str) -> Row:
    (only,) = [each for each in rows(columns) if each["kind"] == kind]
    return only


def number(found: Row, name: str) -> float:
    value = found[name]
    assert isinstance(value, float)
    return value


@pytest.mark.parametrize(
    ("bump", "wheel", "left"),
    # The line is 0.85 m from a wheel of a 1.8 m wide car, 1.75 m from its middle.
    [(0.5, False, False), (0.9, True, False), (2.0, True, True)],
)
def test_a_false_trigger_costs_the_deviation_that_follows_it(
    bump: float, wheel: bool, left: bool
) -> None:
    found = row(drive(FALSE_AT, bump=bump), FALSE)
    assert found["largest_deviation"] == pytest.approx(bump)
    assert found["initial_deviation"] == pytest.approx(0.0, abs=1e-9)
    assert (found["wheel_over_line"], found["left_lane"]) == (wheel, left)


def test_what_is_before_the_trigger_or_10_s_after_it_is_no_cost() -> None:
    columns = drive(FALSE_AT)
    changed(columns, "driver_torque", 44.0, 45.0, 9.0)
    changed(columns, "driver_torque", 46.0, 47.0, -2.0)
    changed(columns, "driver_torque", 55.1, 60.0, 9.0)
    found = row(columns, FALSE)
    assert (found["start_time"], found["end_time"]) == pytest.approx((45.0, 55.0))
    assert found["peak_driver_torque"] == 2.0
    # 2 N·m in one second of ten; a sample more or less is a thousandth.
    assert found["driver_torque_rms"] == pytest.approx(2.0 * sqrt(0.1), rel=2e-3)


def test_only_guidance_that_disagrees_opposes() -> None:
    columns = drive(FALSE_AT)
    changed(columns, "applied_torque", 46.0, 48.0, -3.0)
    changed(columns, "torque_agreement", 46.0, 48.0, -1.0)
    changed(columns, "applied_torque", 48.0, 50.0, -4.0)
    assert row(columns, FALSE)["peak_opposing_torque"] == 3.0
    assert row(drive(FALSE_AT), FALSE)["peak_opposing_torque"] == 0.0


def test_recovery_is_from_the_trigger_until_the_gain_is_back() -> None:
    found = row(drive(FALSE_AT, disputes=((45.5, 47.0),)), FALSE)
    assert found["inconsistent"] is True
    assert found["replanned"] is True
    # Eq. (10) after 1.5 s, and Eq. (11) back at 0.95 after 1.366 s.
    least = (1.0 - np.tanh(4.0 * 0.5)) / 2.0
    assert found["gain_minimum"] == pytest.approx(least, abs=3e-3)
    assert found["time_to_recover"] == pytest.approx(0.5 + 1.5 + 1.366, abs=2 * DT)


def test_a_short_dispute_does_not_replan_and_none_has_no_recovery() -> None:
    short = row(drive(FALSE_AT, disputes=((45.5, 46.7),)), FALSE)
    assert (short["inconsistent"], short["replanned"]) == (True, False)
    none = row(drive(FALSE_AT), FALSE)
    assert (none["inconsistent"], none["replanned"]) == (False, False)
    assert none["gain_minimum"] == 1.0
    assert isnan(number(none, "time_to_recover"))


def test_the_last_dispute_of_the_episode_counts_also_beyond_its_end() -> None:
    columns = drive(FALSE_AT, disputes=((45.5, 47.0), (54.0, 55.5)))
    found = row(columns, FALSE)
    assert found["time_to_recover"] == pytest.approx(9.0 + 1.5 + 1.366, abs=2 * DT)
    cut = drive(FALSE_AT, disputes=((54.0, 61.0),))
    assert isnan(number(row(cut, FALSE), "time_to_recover"))


def test_a_bump_is_over_when_the_car_is_straight_and_near_the_centre() -> None:
    columns = drive(FALSE_AT, bump=1.0)
    changed(columns, "target_lane", 45.0, 46.0, 0)
    # Straight again when pi/4 sin(pi x / 2) is the speed of 0.5 deg, x s before 49 s.
    before = 2.0 / pi * asin(SPEED * tan(radians(0.5)) / (pi / 4.0))
    found = row(columns, FALSE)
    assert found["time_to_settle"] == pytest.approx(4.0 - before, abs=2 * DT)


def test_a_car_is_not_settled_while_the_system_aims_elsewhere() -> None:
    columns = drive(FALSE_AT)
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(0.0)
    changed(columns, "target_lane", 45.0, 52.0, 0)
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(7.0, abs=DT)
    # Settled for 0.4 s only is not settled.
    changed(columns, "target_lane", 46.0, 46.4, 1)
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(7.0, abs=DT)
    changed(columns, "target_lane", 46.4, 46.6, 1)
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(1.0, abs=DT)


def test_a_car_that_runs_straight_beside_the_centre_is_not_settled() -> None:
    columns = drive(FALSE_AT)
    columns["lateral_position"][inside(columns, 45.0, 50.0)] = 0.5
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(5.0, abs=DT)
    columns["lateral_position"][inside(columns, 46.0, 50.0)] = 0.29
    assert row(columns, FALSE)["time_to_settle"] == pytest.approx(1.0, abs=DT)


def test_who_settles_after_the_next_trigger_did_not_settle_from_the_first() -> None:
    columns = drive(45.0, 48.0)
    changed(columns, "target_lane", 45.0, 50.0, 0)
    first, second = (e for e in rows(columns) if e["kind"] == FALSE)
    assert isnan(number(first, "time_to_settle"))
    assert second["time_to_settle"] == pytest.approx(2.0, abs=DT)


def test_an_episode_ends_where_the_driver_means_to_leave() -> None:
    columns = drive(24.0)
    changed(columns, "target_lane", 24.0, 40.0, 1)
    found = row(columns, FALSE)
    (back,) = [e for e in rows(columns) if e["kind"] == MISSED and e["direction"] == 1]
    assert found["end_time"] == back["start_time"]
    assert number(found, "end_time") < 34.0
    # The driver means to be in the right lane then; with 0.5 deg of yaw the return
    # has begun, by 0.04 m.
    assert found["largest_deviation"] == pytest.approx(0.0, abs=0.05)
    assert isnan(number(found, "time_to_settle"))


def test_an_episode_ends_at_the_next_trigger_and_with_the_record() -> None:
    found = [e for e in rows(drive(45.0, 48.0, 58.0)) if e["kind"] == FALSE]
    assert [e["end_time"] for e in found] == pytest.approx([48.0, 58.0, 60.0])


def test_a_crossing_of_the_guidance_is_a_deviation() -> None:
    found = rows(drive(10.0, 22.0, meant=()))
    assert [each["kind"] for each in found] == [FALSE, FALSE]
    assert [each["left_lane"] for each in found] == [True, True]
    assert found[0]["largest_deviation"] == pytest.approx(3.5)
    # Still in the lane that nobody wanted.
    assert found[1]["initial_deviation"] == pytest.approx(3.5)


def test_a_missed_crossing_is_measured_over_its_lane_change() -> None:
    columns = drive(11.0, disputes=((32.0, 33.5),))
    changed(columns, "driver_torque", 28.0, 30.0, 9.0)
    changed(columns, "driver_torque", 32.0, 33.0, 2.5)
    changed(columns, "applied_torque", 32.0, 33.0, -1.5)
    changed(columns, "torque_agreement", 32.0, 33.0, -1.0)
    found = row(columns, MISSED)
    assert found["direction"] == LEFT
    assert isnan(number(found, "time"))
    assert (found["crossing_time"], found["lead"]) == (pytest.approx(33.0), 0.0)
    start, end = number(found, "start_time"), number(found, "end_time")
    assert 30.0 < start < 31.0 < 35.0 < end < 36.0
    assert found["peak_driver_torque"] == 2.5
    rms = 2.5 * sqrt(1.0 / (end - start))
    assert found["driver_torque_rms"] == pytest.approx(rms, rel=5e-3)
    assert found["peak_opposing_torque"] == 1.5
    recovered = 33.5 + 1.366 - start
    assert found["time_to_recover"] == pytest.approx(recovered, abs=2 * DT)
    assert isnan(number(found, "largest_deviation"))
    assert found["overshoot"] == pytest.approx(0.0, abs=1e-3)
    # A quintic change is straight before it is near the centre, or the other way.
    assert end - start - 0.5 < number(found, "time_to_settle") < end - start + 0.5


def test_one_that_was_announced_is_measured_in_the_same_way() -> None:
    late, early, never = (
        next(e for e in rows(drive(*at)) if e["direction"] == RIGHT)
        for at in ((11.0,), (9.0,), ())
    )
    assert (late["kind"], early["kind"], never["kind"]) == (TRUE, EARLY, MISSED)
    assert (late["lead"], early["lead"]) == pytest.approx((2.0, 4.0))
    for name in ("start_time", "end_time", *COST_COLUMNS):
        assert late[name] == pytest.approx(never[name], nan_ok=True)
        assert early[name] == pytest.approx(never[name], nan_ok=True)


def test_rows_stand_in_the_order_of_time() -> None:
    found = rows(drive(25.0, 45.0))
    assert [e["kind"] for e in found] == [MISSED, FALSE, MISSED, FALSE]


def test_a_crossing_that_makes_no_lane_change_has_no_costs() -> None:
    columns = {name: values[: 34 * 60] for name, values in drive().items()}
    found = rows(columns)[-1]
    assert found["crossing_time"] == pytest.approx(33.0)
    assert all(isnan(number(found, name)) for name in COST_COLUMNS)


def test_a_mirrored_drive_costs_the_same() -> None:
    columns = drive(FALSE_AT, 11.0, bump=1.2, disputes=((45.5, 47.0),))
    changed(columns, "driver_torque", 46.0, 47.0, 2.0)
    other = mirrored(columns)
    for name in ("driver_intention", "driver_torque", "applied_torque"):
        other[name] = -columns[name]
    other["target_lane"] = 1 - columns["target_lane"]
    here, there = rows(columns), rows(other)
    assert [e["kind"] for e in here] == [TRUE, MISSED, FALSE]
    for one, two in zip(here, there, strict=True):
        assert two.pop("direction") == -int(str(one.pop("direction")))
        assert two.pop("kind") == one.pop("kind")
        assert two == pytest.approx(one, nan_ok=True)


def manual(columns: Columns) -> Columns:
    """The drive as a manual trial records it."""
    size = columns["time"].size
    undefined = ("torque_agreement", "haptic_gain")
    masked = ("consistent", "target_lane")
    return (
        columns
        | {name: np.full(size, np.nan) for name in undefined}
        | {name: np.ma.MaskedArray(np.zeros(size, int), mask=True) for name in masked}
        | {"mode": np.full(size, "manual")}
    )


def test_in_manual_driving_the_guidance_costs_nothing() -> None:
    found = row(manual(drive(FALSE_AT, bump=0.5)), FALSE)
    guidance = COST_COLUMNS[COST_COLUMNS.index("peak_opposing_torque") : -1]
    assert all(isnan(number(found, name)) for name in guidance)
    assert found["largest_deviation"] == pytest.approx(0.5)
    assert found["peak_driver_torque"] == 0.0


def test_where_triggers_cannot_be_judged_there_is_no_row() -> None:
    columns = drive(FALSE_AT)
    size = columns["time"].size
    unknown = np.ma.MaskedArray(np.zeros(size, np.int8), mask=True)
    assert rows(columns | {"driver_intention": unknown}) == []
    assert rows({k: v for k, v in columns.items() if k != "yaw_angle"}) == []
    assert rows({k: v for k, v in columns.items() if k != "intention"}) == []


def test_without_a_recorded_torque_its_cost_is_unknown() -> None:
    columns = drive(FALSE_AT, bump=0.5)
    columns = {k: v for k, v in columns.items() if k not in ("driver_torque",)}
    columns.pop("target_lane")
    found = row(columns, FALSE)
    assert isnan(number(found, "peak_driver_torque"))
    assert found["largest_deviation"] == pytest.approx(0.5)
    assert not isnan(number(found, "time_to_settle"))
