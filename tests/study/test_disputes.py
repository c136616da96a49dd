"""When inconsistencies come in a lane change."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from costeer.study.disputes import disputes, in_lane_change
from costeer.study.material import StudyMaterial

CHANGES = pd.DataFrame(
    {
        "start_time": [10.0, 40.0],
        "crossing_time": [13.0, 43.0],
        "end_time": [18.0, 45.0],
    }
)


@pytest.mark.parametrize(
    ("start", "from_crossing", "share"),
    [
        (10.0, -3.0, 0.0),
        (12.0, -1.0, 0.25),
        (18.0, 5.0, 1.0),
        (20.0, 7.0, math.nan),
        (41.0, -2.0, 0.2),
        (28.0, math.nan, math.nan),
    ],
)
def test_it_belongs_to_the_nearest_crossing(
    start: float, from_crossing: float, share: float
) -> None:
    wanted = pytest.approx((from_crossing, share), nan_ok=True)
    assert in_lane_change(start, CHANGES) == wanted


def test_without_lane_changes_nothing_is_near() -> None:
    assert all(math.isnan(each) for each in in_lane_change(1.0, None))


def test_they_are_as_many_as_the_trials_count(material: StudyMaterial) -> None:
    found = disputes(material)
    assert found
    for (who, name), rows in material.trials.groupby(["participant", "condition"]):
        own = [e for e in found if (e.participant, e.condition) == (who, name)]
        counted = rows["num_inconsistencies"].fillna(0).sum()
        assert len(own) == counted
    inside = [each for each in found if math.isfinite(each.share)]
    assert len(inside) == material.lane_changes["num_inconsistencies"].sum()
