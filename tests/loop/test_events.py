"""Overtaking events: when a leader appears, and the zone around it."""

from __future__ import annotations

import math

import pytest

from costeer.loop.events import (
    EventState,
    event_zone,
    initial_events,
    leader_visible,
    step_events,
)
from costeer.plant.fleet import NO_FLEET
from costeer.plant.parameters import RoadParameters
from costeer.plant.traffic import TrafficParameters
from tests.drivers.samples import DT, RIGHT, SPEED, driving, leader

TRAFFIC, ROAD = TrafficParameters(), RoadParameters()
START = initial_events(NO_FLEET)


def after(
    state: EventState,
    position: float,
    at_home: bool = True,
    lane: float = 1.0,
    uniform: float = 0.5,
) -> EventState:
    """Events one step later, with the car at a position."""
    car = driving(position, lane=lane)
    return step_events(TRAFFIC, ROAD, state, car, at_home, uniform, DT)


def test_a_leader_appears_ahead_when_the_car_reaches_the_event() -> None:
    assert not after(START, 999.9).leader.present
    appeared = after(START, 1000.0).leader
    assert appeared.present
    assert appeared.longitudinal_position == 1000.0 + TRAFFIC.appearance_distance
    assert appeared.lane == 1.0


@pytest.mark.parametrize(("uniform", "slower_kmh"), [(0.0, 5.0), (0.5, 10.0)])
def test_a_leader_is_5_to_15_km_h_slower_by_its_draw(
    uniform: float, slower_kmh: float
) -> None:
    appeared = after(START, 1000.0, uniform=uniform).leader
    difference = SPEED - appeared.longitudinal_velocity
    assert difference == pytest.approx(slower_kmh / 3.6)


def test_a_negative_draw_leaves_the_road_empty() -> None:
    assert not after(START, 5000.0, uniform=-1.0).leader.present


def test_a_leader_waits_until_the_car_is_back_in_the_cruising_lane() -> None:
    assert not after(START, 1000.0, lane=RIGHT).leader.present
    assert not after(START, 1000.0, at_home=False).leader.present


def test_there_are_four_leaders_and_no_fifth() -> None:
    state, count = START, 0.0
    for position in range(0, 20_000, 50):
        state = after(state, float(position))
        count = state.leader.num_appeared
    assert count == 4.0


def test_the_zone_lasts_from_100_m_behind_until_the_return_is_settled() -> None:
    ahead = START._replace(leader=leader(200.0, 15.0))
    passed = START._replace(leader=leader(200.0, 15.0), event=1.0)

    def zone(state: EventState, position: float, at_home: bool) -> float:
        return event_zone(TRAFFIC, state, position, at_home)

    assert zone(ahead, 99.0, True) == 0.0
    assert zone(ahead, 100.0, True) == 1.0
    assert zone(passed, 230.0, False) == 1.0  # beside and past the leader
    assert zone(passed, 260.0, True) == 0.0  # returned and settled


def test_a_leader_drives_on_at_its_speed() -> None:
    state = after(START, 1000.0)
    place = state.leader.longitudinal_position
    moved = after(state, 1000.3).leader
    assert moved.longitudinal_position - place == pytest.approx(
        moved.longitudinal_velocity * DT
    )


def test_a_leader_far_behind_is_out_of_sight() -> None:
    state = START._replace(leader=leader(1000.0, 15.0))
    assert leader_visible(state, 1199.0)
    assert not leader_visible(state, 1201.0)
    assert not leader_visible(START, 0.0)


def test_nothing_is_undefined_before_the_first_leader() -> None:
    assert all(math.isfinite(value) for value in START.leader)
