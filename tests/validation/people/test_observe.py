"""What is taken from a virtual driver's trial."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.records.columns import TrialRecord
from costeer.validation.glances import HEAD_YAW_SCALE
from costeer.validation.people.brain4cars import BACK, OUT
from costeer.validation.people.observe import (
    Observations,
    false_glances,
    gathered,
    observe,
    shape_errors,
)
from costeer.validation.people.shape import quintic, rms, whole_quintic

SECONDS = 120.0
TIME = np.arange(0.0, SECONDS, 1.0 / 60.0)
CHANGES = [
    {"direction": -1, "crossing_time": 60.0},
    {"direction": 1, "crossing_time": 80.0},
]


def trial(looks: tuple[tuple[float, float], ...] = ()) -> TrialRecord:
    """Out to the right in 6 s about 60 s and back in 5 s about 80 s.

    Args:
        looks: Start and head yaw [rad] of looks of half a second.
    """
    out = quintic(np.clip((TIME - 57.0) / 6.0, 0.0, 1.0))
    back = quintic(np.clip((TIME - 77.5) / 5.0, 0.0, 1.0))
    lateral = 3.5 * (back - out)
    head = np.zeros(TIME.size)
    for start, yaw in looks:
        begun = TIME - start
        head[(begun >= 0.0) & (begun < 0.5)] = yaw / HEAD_YAW_SCALE
    # Oscillation for 40 s, twelve whole periods: SD 0.1 m / sqrt(2).
    lateral = lateral + np.where(TIME < 40.0, 0.1 * np.sin(0.6 * np.pi * TIME), 0.0)
    changing = (TIME > 50.0) & (TIME < 90.0)
    return TrialRecord(
        metadata={},
        columns={
            "time": TIME,
            "lateral_position": lateral,
            "yaw_angle": np.arctan(np.gradient(lateral, TIME) / 20.0),
            "longitudinal_velocity": np.full(TIME.size, 20.0),
            "steering_wheel_angle": np.radians(4.0) * np.sin(0.5 * np.pi * TIME),
            "driver_torque": np.full(TIME.size, -0.3),
            "head_yaw": head,
            "head_yaw_valid": np.ones(TIME.size, bool),
            "lane": (lateral > -1.75).astype(np.int8),
            "event": changing.astype(np.int8),
            "driver_intention": np.zeros(TIME.size, np.int8),
        },
    )


@pytest.fixture(scope="module")
def seen() -> Observations:
    # To the right before moving right, to the left before moving left; one in vain.
    return observe(trial(((56.0, -0.4), (77.0, 0.7), (20.0, -0.4))), CHANGES)


def test_lane_changes_are_measured_as_those_of_people(seen: Observations) -> None:
    wholes = [whole_quintic(c.duration, c.displacement, 0.1) for c in seen.changes]
    # The speed is the gradient over 33 ms.
    assert [whole for _, whole, _ in wholes] == pytest.approx([6.0, 5.0], abs=0.02)
    assert max(rms(error) for error in shape_errors(seen.changes)) < 1e-3


def test_out_is_to_the_right_and_back_to_the_left(seen: Observations) -> None:
    out, back = seen.looks[OUT][0], seen.looks[BACK][0]
    assert (out.glanced, back.glanced) == (1.0, 1.0)
    assert out.peak == pytest.approx(0.4)
    assert back.peak == pytest.approx(0.7)
    # The wheel touches with the centre of gravity 0.9 m before the line.
    assert 2.0 < out.lead < 4.0


def test_a_glance_in_straight_driving_is_false(seen: Observations) -> None:
    # 120 s less the windows that the event's 40 s touch.
    assert seen.false_glances.sum() == 1.0
    assert seen.false_glances.size == 13


def test_a_glance_away_from_the_adjacent_lane_is_none() -> None:
    assert false_glances(trial(((20.0, 0.4), (30.0, -0.28)))).sum() == 0.0


def test_where_the_head_is_lost_no_window_counts() -> None:
    record = trial(((56.0, -0.4), (20.0, -0.4)))
    record.columns["head_yaw_valid"][TIME < 70.0] = False
    seen = observe(record, CHANGES)
    assert seen.looks[OUT] == []
    assert len(seen.looks[BACK]) == 1
    assert seen.false_glances.sum() == 0.0


def test_drift_is_of_lane_keeping_only(seen: Observations) -> None:
    # Two windows before 50 s, one of 90 s to 120 s; lane changes are metres wide.
    expected = [0.1 / math.sqrt(2.0), 0.1 / math.sqrt(2.0), 0.0]
    assert seen.drift.deviation == pytest.approx(expected, abs=2e-3)


def test_torque_is_a_level_and_reversals_a_rate(seen: Observations) -> None:
    assert np.all(seen.torque == 0.3)
    assert seen.torque.size == int(SECONDS)
    # 8 deg from peak to peak at 0.25 Hz: two a period.
    assert seen.reversals == pytest.approx([30.0], abs=2.0)


def test_drivers_are_gathered_in_order(seen: Observations) -> None:
    both = gathered([seen, seen], lambda each: each.torque)
    assert both.size == 2 * seen.torque.size
    assert gathered([], lambda each: each.torque).size == 0


def test_a_trial_that_cannot_be_cut_gives_no_drift() -> None:
    record = trial()
    record.columns["yaw_angle"][:] = np.nan
    seen = observe(record, [])
    assert seen.drift.deviation.size == 0
    assert seen.reversals.size == 0
    assert shape_errors(seen.changes).shape[0] == 0
