"""Lanes count from the right; positions from the left lane's centre."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.parameters import RoadParameters
from costeer.plant.road import (
    adjacent_side,
    cruising_lane,
    distance_to_adjacent_lane,
    lane_at,
    lane_centre,
)

ROAD = RoadParameters()
THREE_LANES = RoadParameters(num_lanes=3.0)
RIGHT_HAND_TRAFFIC = RoadParameters(overtaking_side=1.0)


@pytest.mark.parametrize(
    ("position", "lane"),
    [(0.0, 1.0), (1.7, 1.0), (-1.7, 1.0), (-1.8, 0.0), (-3.5, 0.0), (-5.2, 0.0)],
)
def test_the_line_between_the_lanes_lies_half_a_width_from_their_centres(
    position: float, lane: float
) -> None:
    assert lane_at(ROAD, position) == lane


@given(st.integers(0, 4), st.floats(-1.749, 1.749))
def test_a_position_near_a_centre_is_in_that_lane(lane: int, offset: float) -> None:
    road = RoadParameters(num_lanes=5.0)
    assert lane_at(road, lane_centre(road, float(lane)) + offset) == lane


@pytest.mark.parametrize(("position", "lane"), [(40.0, 1.0), (-40.0, 0.0)])
def test_the_outer_lanes_reach_outwards(position: float, lane: float) -> None:
    assert lane_at(ROAD, position) == lane


@pytest.mark.parametrize(
    ("road", "lane", "side"),
    [
        (ROAD, 1.0, -1.0),
        (ROAD, 0.0, 1.0),
        (THREE_LANES, 2.0, -1.0),
        (THREE_LANES, 1.0, -1.0),
        (THREE_LANES, 0.0, 1.0),
        (RIGHT_HAND_TRAFFIC, 0.0, 1.0),
        (RIGHT_HAND_TRAFFIC, 1.0, -1.0),
    ],
)
def test_the_adjacent_lane_is_that_for_overtaking_where_there_is_one(
    road: RoadParameters, lane: float, side: float
) -> None:
    assert adjacent_side(road, lane) == side


@given(st.floats(-5.25, 1.75))
def test_distances_to_the_line_from_both_sides_cancel(position: float) -> None:
    from_left = distance_to_adjacent_lane(ROAD, position, 1.0, -1.0)
    from_right = distance_to_adjacent_lane(ROAD, position, 0.0, 1.0)
    # Rounding of metres.
    assert from_left == pytest.approx(position + 1.75, abs=1e-14)
    assert from_left + from_right == pytest.approx(0.0, abs=1e-14)


def test_people_cruise_on_the_side_away_from_overtaking() -> None:
    assert cruising_lane(ROAD) == 1.0
    assert cruising_lane(RIGHT_HAND_TRAFFIC) == 0.0


def test_a_batch_gives_what_its_members_give() -> None:
    positions = np.linspace(-6.0, 2.5, 35)
    lanes = lane_at(ROAD, positions)
    assert lanes.tolist() == [lane_at(ROAD, p) for p in positions.tolist()]
    sides = adjacent_side(ROAD, lanes)
    assert sides.tolist() == [adjacent_side(ROAD, lane) for lane in lanes.tolist()]
