"""Each set of recordings, made up so that the answer is known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from costeer.validation.people import brain4cars, gps, leeds, ngsim, torque
from costeer.validation.people.brain4cars import BACK, OUT, look
from costeer.validation.people.folder import FILES
from costeer.validation.people.shape import quintic, rms, whole_quintic


def write_table(folder: Path, name: str, columns: dict[str, object]) -> None:
    """One set's table; scalars are repeated."""
    path = folder / name / FILES[name].removesuffix(".gz")
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays = np.broadcast_arrays(*columns.values())
    rows = [",".join(map(str, row)) for row in zip(*arrays, strict=True)]
    old = path.read_text().splitlines() if path.exists() else [",".join(columns)]
    path.write_text("\n".join([*old, *rows]) + "\n")


def write_ngsim(folder: Path, seq: str, label: str, duration: float) -> None:
    time = np.arange(0.0, duration + 4.0, 0.1).round(1)
    share = np.clip((time - 2.0) / duration, 0.0, 1.0)
    side = {"L": 3.5, "R": -3.5, "K": 0.0}[label]
    write_table(
        folder,
        "ngsim_lc",
        {
            "seq": seq,
            "label": label,
            "t": time,
            "vlat": side * 30.0 * share**2 * (1.0 - share) ** 2 / duration,
            "y": side * quintic(share),
        },
    )


def test_ngsim_changes_to_both_sides_are_measured_and_lane_keeping_is_not(
    tmp_path: Path,
) -> None:
    for seq, label, duration in (("a", "L", 5.0), ("b", "K", 6.0), ("c", "R", 7.0)):
        write_ngsim(tmp_path, seq, label, duration)
    found = ngsim.lane_changes(tmp_path)
    wholes = [whole_quintic(c.duration, c.displacement, 0.1) for c in found]
    # Samples are 0.1 s apart and interpolated.
    assert [whole for _, whole, _ in wholes] == pytest.approx([5.0, 7.0], abs=0.03)
    assert max(rms(change.shape_error) for change in found) < 2e-3
    peaks = [1.875 * 3.5 / 5.0, 1.875 * 3.5 / 7.0]
    assert [change.peak_speed for change in found] == pytest.approx(peaks, rel=1e-3)


def head(label: str, sample: str, glance: tuple[float, float, float]) -> dict:
    """150 frames with the camera 0.2 rad askew and a glance of 0.4 s."""
    time = (np.arange(150) - 149) * 0.04
    start, angle, lost = glance
    yaw = 0.2 + np.where((time >= start) & (time < start + 0.4), angle, 0.0)
    shown = np.where(np.arange(150) < 150 * lost, "", yaw.round(4).astype(str))
    return {"label": label, "sample": sample, "t": time.round(2), "yaw": shown}


@pytest.fixture
def heads(tmp_path: Path) -> Path:
    windows = [
        head("lchange", "a", (-4.0, -0.7, 0.0)),
        head("lchange", "b", (-4.0, -0.28, 0.0)),
        head("lchange", "c", (-4.0, 0.7, 0.0)),
        head("lchange", "lost", (-1.0, -0.7, 0.31)),
        head("rchange", "d", (-2.0, 0.28, 0.0)),
        head("end_action", "e", (-2.0, 0.28, 0.0)),
        head("end_action", "f", (-2.0, -0.28, 0.0)),
        head("lturn", "g", (-2.0, -0.7, 0.0)),
    ]
    for window in windows:
        write_table(tmp_path, "brain4cars_head", window)
    return tmp_path


def test_glances_count_to_the_side_of_the_lane_change(heads: Path) -> None:
    before = brain4cars.glances(heads).before
    # 0.28 rad is enough back, not out; the fourth window is hardly tracked.
    assert [each.glanced for each in before[OUT]] == [1.0, 0.0, 0.0]
    assert [each.glanced for each in before[BACK]] == [1.0]
    assert before[OUT][0].lead == pytest.approx(4.0, abs=0.041)
    assert math.isnan(before[OUT][1].lead)
    assert before[OUT][0].peak == pytest.approx(0.7, abs=1e-6)


def test_false_glances_are_shares_of_straight_windows_to_either_side(
    heads: Path,
) -> None:
    # Two windows to two sides: only the 0.28 rad of the first to the right is enough.
    assert brain4cars.glances(heads).straight.tolist() == [0.0, 0.0, 1.0, 0.0]


def test_a_head_that_is_hardly_tracked_says_nothing() -> None:
    time = np.linspace(0.0, 6.0, 100)
    yaw = np.where(np.arange(100) < 31, np.nan, 0.0)
    assert math.isnan(look(time, yaw, 0.3).glanced)
    assert look(time, np.where(np.arange(100) < 30, np.nan, 0.0), 0.3).glanced == 0.0
    assert math.isnan(look(np.empty(0), np.empty(0), 0.3).peak)


def test_a_driver_counts_once_by_the_median(tmp_path: Path) -> None:
    write_table(
        tmp_path,
        "leeds_steering_onset",
        {
            "heading": [1, 1, 1, 2, 1],
            "FirstSteeringTime": [0.2, 0.4, 0.9, 0.3, 0.5],
            "peakSWA": [5.0, -7.0, 9.0, 12.0, 8.0],
            "pNum": [3, 3, 3, 3, 1],
        },
    )
    one = leeds.corrections(tmp_path, 1.0)
    assert one.onset.tolist() == [0.4, 0.5]
    assert one.peak.tolist() == [7.0, 8.0]
    assert leeds.corrections(tmp_path, 2.0).onset.tolist() == [0.3]


def write_steering(folder: Path, speed: object) -> None:
    """Two minutes of a wheel that turns 5 deg to and fro at 0.25 Hz."""
    time = np.arange(0.0, 121.0, 0.05).round(2)
    angle = math.radians(5.0) * np.sin(2.0 * np.pi * 0.25 * time)
    write_table(
        folder,
        "udacity_steering",
        {"part": 1, "t": time, "angle": angle, "torque": -0.5, "speed": speed},
    )


def test_torque_counts_without_its_sign_above_12_m_s(tmp_path: Path) -> None:
    write_steering(tmp_path, np.where(np.arange(2420) < 1220, 20.0, 11.0))
    levels = torque.torque_levels(tmp_path)
    assert levels.size == 61  # one a second
    assert np.all(levels == 0.5)


def test_a_wheel_that_swings_at_a_quarter_hertz_reverses_thirty_times_a_minute(
    tmp_path: Path,
) -> None:
    write_steering(tmp_path, 20.0)
    # Half a swing each way may be cut off at the ends of a minute.
    assert torque.reversal_rates(tmp_path) == pytest.approx([30.0, 30.0], abs=1.5)


def test_reversals_need_a_whole_minute_at_speed(tmp_path: Path) -> None:
    write_steering(tmp_path, np.where(np.arange(2420) < 1000, 20.0, 11.0))
    assert torque.reversal_rates(tmp_path).size == 0


def test_the_minute_of_comma2k19_counts_in_degrees(tmp_path: Path) -> None:
    time = np.arange(0.0, 60.2, 0.0125)
    angle = 5.0 * np.sin(2.0 * np.pi * 0.25 * time)
    columns = {"t": time, "steering_angle_deg": angle, "speed": 30.0}
    write_table(tmp_path, "comma2k19_example", columns)
    assert torque.reversal_rates(tmp_path) == pytest.approx([30.0], abs=1.5)


def test_annotated_durations_leave_out_the_missing_and_the_typing_errors(
    tmp_path: Path,
) -> None:
    columns = {"t_start": ["", "10", "10", "10"], "t_end": ["", "14.5", "615", ""]}
    write_table(tmp_path, "gps_lane_changes", columns)
    assert gps.annotated_durations(tmp_path).tolist() == [4.5]


def test_absent_sets_are_empty(tmp_path: Path) -> None:
    assert ngsim.lane_changes(tmp_path) == []
    assert brain4cars.glances(tmp_path).before == ([], [])
    assert brain4cars.glances(tmp_path).straight.size == 0
    assert leeds.corrections(tmp_path, 1.0).onset.size == 0
    assert torque.torque_levels(tmp_path).size == 0
    assert torque.reversal_rates(tmp_path).size == 0
    assert gps.annotated_durations(tmp_path).size == 0
