"""With lanes on both sides a verdict says which of them it is about."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.loop.scenario import TrialSetup
from costeer.loop.tick import likelier
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import adjacent_side, lane_centre
from costeer.records.columns import TrialRecord
from costeer.sensing.measurement import Measurement, standing_start, towards
from costeer.study.detection import Detection, detect
from costeer.study.lanes import adjacent_side as usual_side
from costeer.study.measures import prepared
from tests.loop.test_outside import near_the_line

WIDE = RoadParameters(num_lanes=3.0)
MIDDLE = 1.0
PROBABILITIES = st.floats(0.0, 1.0) | st.just(math.nan)


def seen(road: RoadParameters, lane: float, offset: float) -> Measurement:
    """A car in a lane, beside its centre [m]."""
    start = standing_start(road)
    side = adjacent_side(road, lane)
    return start._replace(
        lateral_position=lane_centre(road, lane) + offset,
        lane=lane,
        side=side,
        distance_to_adjacent_lane=road.lane_width / 2.0 - side * offset,
    )


@given(st.floats(-1.5, 1.5))
def test_the_distances_to_both_sides_are_a_lane(offset: float) -> None:
    here = seen(WIDE, MIDDLE, offset)
    other = towards(WIDE, here, -here.side)
    assert other.side == -here.side
    both = here.distance_to_adjacent_lane + other.distance_to_adjacent_lane
    assert both == pytest.approx(WIDE.lane_width)
    assert towards(WIDE, other, here.side).side == here.side


@pytest.mark.parametrize("lane", [0.0, 2.0])
@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_nobody_is_sent_to_where_there_is_no_lane(lane: float, side: float) -> None:
    here = seen(WIDE, lane, 0.3)
    assert towards(WIDE, here, side) == here
    two = seen(RoadParameters(), 1.0, 0.3)
    assert towards(RoadParameters(), two, side) == two


@given(PROBABILITIES, PROBABILITIES)
def test_the_usual_side_is_meant_unless_the_other_says_yes_and_louder(
    usual: float, other: float
) -> None:
    side = adjacent_side(WIDE, MIDDLE)
    said = likelier(WIDE, MIDDLE, side, usual, other)
    if other >= 0.5 and (math.isnan(usual) or other > usual):
        assert (said.probability, said.side) == (other, -side)
    else:
        assert said.side == side
        np.testing.assert_equal(said.probability, usual)


@pytest.mark.parametrize("lane", [0.0, 2.0])
def test_a_yes_to_where_there_is_no_lane_counts_nothing(lane: float) -> None:
    side = adjacent_side(WIDE, lane)
    assert tuple(likelier(WIDE, lane, side, 0.1, 0.99)) == (0.1, side)


THREE = TrialSetup(
    seed=5,
    participant=1,
    condition="strong-normal",
    scenario="three-lanes",
    length=6000.0,
    speed=85.0 / 3.6,
)


def unusual_share(record: TrialRecord) -> tuple[int, int]:
    """How many intended crossings lead to the unusual side, and are announced."""
    trial = prepared(record)
    found = detect(trial.columns, trial.parameters)
    assert isinstance(found, Detection)
    announced = {trigger.crossing_time for trigger in found.triggers}
    unusual = [
        crossing.time in announced
        for crossing in found.crossings
        if usual_side(trial.parameters, crossing.lane - crossing.direction)
        != crossing.direction
    ]
    return len(unusual), sum(unusual)


@pytest.mark.slow
@pytest.mark.parametrize("intention", ["network", "scripted"])
def test_lane_changes_to_both_sides_are_announced(intention: str) -> None:
    record = simulate_trial(THREE._replace(intention=intention))
    number, announced = unusual_share(record)
    assert number >= 2
    assert announced == number
    meant = record.columns["driver_intention"]
    begins = np.flatnonzero(np.diff(record.columns["target_lane"].astype(float)))
    for row in begins + 1:
        moved = np.diff(record.columns["target_lane"].astype(float))[row - 1]
        assert meant[row] in (0, moved)  # nowhere against what the driver wants


@pytest.mark.slow
def test_a_predictor_outside_the_loop_is_asked_for_both_sides_too() -> None:
    setup = THREE._replace(condition="manual", predictor=near_the_line)
    columns = simulate_trial(setup).columns
    lane, side = columns["lane"].astype(float), columns["crossing_side"]
    offset = columns["lateral_position"] - lane_centre(WIDE, lane)
    said, middle = columns["crossing_probability"] > 0.5, lane == MIDDLE
    assert (side[said & middle] == -adjacent_side(WIDE, MIDDLE)).any()
    room = WIDE.lane_width / 2.0 - side * offset
    assert (room[said] < 0.8).all()
    assert (room[~said & np.isfinite(columns["crossing_probability"])] >= 0.8).all()
