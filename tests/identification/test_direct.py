"""Durations, speed and glances counted from a recording."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.identification.direct import (
    change_duration,
    direct_estimates,
    effective_number,
    false_rate,
    glance_share,
    glances,
    path_duration,
    planned_duration,
    preferred_speed,
)
from costeer.identification.recording import drive_of
from costeer.identification.signals import Drive
from costeer.identification.stretches import changes, step_response
from tests.identification.driving import recorded

DT = 1.0 / 60.0


def drive_with(**columns: object) -> Drive:
    """A straight drive of ten minutes in the left lane, with other signals."""
    rows = 36_000
    signals: dict[str, object] = {
        "lateral_position": np.zeros(rows),
        "lane": np.ones(rows),
        "yaw_angle": np.zeros(rows),
        "speed": np.full(rows, 20.0),
        "head_yaw": np.zeros(rows),
        "free": np.ones(rows, dtype=bool),
    }
    return drive_of(recorded(1))._replace(**{**signals, **columns})


def quintic_drive(durations: list[float], middles: list[float]) -> Drive:
    """Lane changes along quintics, to the right and back in turn."""
    time = DT * np.arange(36_000)
    position, speed = np.zeros(time.size), 20.0
    for k, (duration, middle) in enumerate(zip(durations, middles, strict=True)):
        towards = -1.0 if k % 2 == 0 else 1.0
        progress = (time - middle) / duration + 0.5
        position += towards * 3.5 * step_response(progress)
    return drive_with(
        lateral_position=position,
        lane=np.where(position < -1.75, 0.0, 1.0),
        yaw_angle=np.arctan(np.gradient(position, DT) / speed),
    )


@pytest.mark.parametrize("duration", [3.0, 6.0, 11.0])
def test_a_quintic_lane_change_has_its_duration(duration: float) -> None:
    drive = quintic_drive([duration, duration], [100.0, 200.0])
    for change in changes(drive):
        # The wheel's samples are exact: only the optimiser's tolerance is left.
        assert path_duration(drive, change) == pytest.approx(duration, rel=1e-4)


def test_the_median_duration_is_the_geometric_mean_with_a_t_interval() -> None:
    drive = quintic_drive([4.0, 9.0], [100.0, 200.0])
    found = change_duration(drive, changes(drive))
    quick, slow = planned_duration(4.0), planned_duration(9.0)
    assert found.value == pytest.approx(math.sqrt(quick * slow), rel=1e-4)
    # t with one degree of freedom: 12.706 times half the difference of the logarithms.
    assert math.log(found.high / found.value) == pytest.approx(
        12.7062 * math.log(slow / quick) / 2.0, rel=1e-3
    )
    assert found.low * found.high == pytest.approx(found.value**2)


def test_one_lane_change_has_no_interval() -> None:
    drive = quintic_drive([5.0], [100.0])
    found = change_duration(drive, changes(drive))
    assert math.isnan(found.value)
    assert found.how == "1 lane changes; needs 2 or more"


def test_samples_far_apart_are_independent_and_close_ones_are_one() -> None:
    assert effective_number(1e6 * np.arange(7.0), 20.0) == pytest.approx(7.0)
    assert effective_number(np.zeros(7), 20.0) == pytest.approx(1.0)


def test_many_samples_are_worth_their_time_over_twice_the_correlation_time() -> None:
    # The known limit of a long record; its ends add one correlation time, 2 %.
    number = effective_number(np.arange(0.0, 2000.0), 20.0)
    assert number == pytest.approx(2000.0 / 40.0, rel=0.03)


def test_preferred_speed_is_the_mean_of_free_driving() -> None:
    speed = 20.0 + np.sin(2.0 * np.pi * DT * np.arange(36_000) / 57.8)
    free = np.arange(36_000) > 9_000
    found = preferred_speed(drive_with(speed=speed, free=free), [])
    # Ten whole swings less the end that is left out: a tenth of one remains.
    assert found.value == pytest.approx(20.0, abs=0.05)
    assert found.low < 20.0 < found.high


def test_a_speed_that_nobody_drives_and_too_little_of_it_say_so() -> None:
    assert "never varies" in preferred_speed(drive_with(), []).how
    short = np.arange(36_000) < 2_000
    assert "needs about 80 s" in preferred_speed(drive_with(free=short), []).how
    never = np.zeros(36_000, dtype=bool)
    assert "0 s of free driving" in preferred_speed(drive_with(free=never), []).how


def head(starts: list[float], sides: list[float]) -> np.ndarray:
    yaw = np.zeros(36_000)
    for start, side in zip(starts, sides, strict=True):
        yaw[round(start / DT) : round((start + 1.0) / DT)] = 0.3 * side
    return yaw


def test_glances_have_their_times_and_sides() -> None:
    times, sides = glances(head([10.0, 50.0], [1.0, -1.0]), DT)
    np.testing.assert_allclose(times, [10.0, 50.0], atol=DT)
    np.testing.assert_array_equal(sides, [1.0, -1.0])


def test_false_glances_are_counted_over_both_sides_with_a_poisson_interval() -> None:
    starts = [30.0 * (k + 1) for k in range(10)]
    found = false_rate(drive_with(head_yaw=head(starts, [1.0, -1.0] * 5)), [])
    exposure = 2.0 * (600.0 - 7.0 - 10 * 1.1)
    assert found.value == pytest.approx(10 / exposure, rel=1e-3)
    # Garwood (1936): 10 events have the 95 % interval 4.795 to 18.39.
    assert found.low * exposure == pytest.approx(4.7954, abs=2e-3)
    assert found.high * exposure == pytest.approx(18.3904, abs=5e-3)


def test_no_false_glance_has_zero_as_its_lower_end() -> None:
    found = false_rate(drive_with(), [])
    assert found.value == found.low == 0.0
    # 3.6889 events are the 97.5 % limit when none is seen.
    assert found.high * 2.0 * 593.0 == pytest.approx(3.6889, abs=1e-3)


def test_a_glance_before_a_change_counts_only_to_its_side() -> None:
    drive = quintic_drive([6.0, 6.0], [100.0, 200.0])
    looked = drive._replace(head_yaw=head([95.0, 195.0], [-1.0, -1.0]))
    found = glance_share(looked, changes(drive))
    assert found.value == 0.5
    # Clopper and Pearson (1934): 1 of 2 is between 1.26 and 98.74 %.
    assert found.low == pytest.approx(0.01258, abs=1e-5)
    assert found.high == pytest.approx(0.98742, abs=1e-5)


@pytest.mark.parametrize(
    ("sides", "low", "high"), [((-1.0, 1.0), 0.158, 1.0), ((1.0, -1.0), 0.0, 0.842)]
)
def test_all_and_none_have_one_sided_intervals(
    sides: tuple[float, float], low: float, high: float
) -> None:
    drive = quintic_drive([6.0, 6.0], [100.0, 200.0])
    looked = drive._replace(head_yaw=head([95.0, 195.0], list(sides)))
    found = glance_share(looked, changes(drive))
    # Two of two: 0.025 ** (1 / 2) = 0.158.
    assert found.low == pytest.approx(low, abs=1e-3)
    assert found.high == pytest.approx(high, abs=1e-3)


def test_no_change_has_no_share_of_glances() -> None:
    assert glance_share(drive_with(), []).how == "no completed lane change"


def test_a_recording_of_lane_changes_alone_has_no_false_glances() -> None:
    drive = drive_with()
    (change,) = changes(quintic_drive([6.0], [100.0]))
    throughout = change._replace(start=0, end=36_000)
    assert "no time" in false_rate(drive, [throughout]).how


def test_a_trial_gives_all_four() -> None:
    drive = drive_of(recorded(1))
    found = direct_estimates(drive, changes(drive))
    assert [each.name for each in found] == [
        "decision.change_duration",
        "longitudinal.preferred_speed",
        "gaze.false_rate",
        "decision.glance_share",
    ]
    assert all(math.isfinite(each.value) for each in found)
