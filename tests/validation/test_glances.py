"""Glances counted as in the recordings of real drivers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.records.columns import TrialRecord
from costeer.validation.glances import (
    false_glance_share,
    first_glance_lead,
    glance_before_change,
    touching_time,
)

SECONDS = 60.0
ENOUGH = 1.01 * 0.25 / (math.pi / 2.0)
"""Jain et al. (2015) count 0.25 rad; a record's head yaw of 1 is 90 deg."""

CHANGE = {"direction": -1, "crossing_time": 40.0}


def record(
    glances: tuple[float, ...] = (), yaw: float = -ENOUGH, intended_from: float = 99.0
) -> TrialRecord:
    """A car that moves right at 0.5 m/s and crosses at 40 s, with short glances.

    A wheel, 0.9 m from the centre of gravity, touches 1.8 s before that crosses.
    """
    time = np.arange(0.0, SECONDS, 1.0 / 60.0)
    head = np.zeros(time.size)
    for start in glances:
        head[(time >= start) & (time < start + 0.5)] = yaw
    lateral = np.clip(-1.75 - 0.5 * (time - 40.0), -3.5, 0.0)
    return TrialRecord(
        metadata={},
        columns={
            "time": time,
            "lateral_position": lateral,
            "head_yaw": head,
            "lane": np.where(lateral > -1.75, 1, 0).astype(np.int8),
            "event": np.zeros(time.size, np.int8),
            "driver_intention": np.where(time >= intended_from, -1, 0).astype(np.int8),
        },
    )


def test_a_wheel_touches_before_the_centre_of_gravity_crosses() -> None:
    assert touching_time(record(), 40.0, -1) == pytest.approx(40.0 - 1.8, abs=0.02)


@pytest.mark.parametrize(
    ("start", "counted"), [(33.0, 1.0), (38.0, 1.0), (38.5, 0.0), (31.0, 0.0)]
)
def test_a_glance_counts_in_the_6_s_before_touching(
    start: float, counted: float
) -> None:
    assert glance_before_change(record((start,)), CHANGE) == counted


def test_a_glance_to_the_other_side_or_a_small_one_does_not_count() -> None:
    assert glance_before_change(record((35.0,), ENOUGH), CHANGE) == 0.0
    assert glance_before_change(record((35.0,), -0.98 * ENOUGH), CHANGE) == 0.0


def test_the_first_glance_leads_by_its_time_before_touching() -> None:
    # Samples are 17 ms apart, at the touch and at the glance.
    lead = first_glance_lead(record((34.0, 36.0)), CHANGE)
    assert lead == pytest.approx(38.2 - 34.0, abs=0.04)
    assert math.isnan(first_glance_lead(record(), CHANGE))


def test_false_glances_are_shares_of_6_s_windows_to_the_adjacent_lane() -> None:
    # Ten windows: a glance in the first and one in the third; then in the right lane
    # the adjacent lane is on the left, so that glances to the right do not count.
    assert false_glance_share(record((1.0, 13.0, 50.0))) == pytest.approx(0.2)


def test_windows_with_an_intention_are_left_out() -> None:
    seen = record((1.0, 13.0, 20.0), intended_from=30.0)
    assert false_glance_share(seen) == pytest.approx(3.0 / 5.0)
    assert math.isnan(false_glance_share(record(intended_from=0.0)))
