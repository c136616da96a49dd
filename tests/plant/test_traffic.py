"""Leaders: where they appear, how fast they are, that they keep their speed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.array import select
from costeer.plant.traffic import (
    LeaderState,
    TrafficParameters,
    appear,
    drive_on,
    due,
    no_leader,
)

TRAFFIC = TrafficParameters()


def leader(uniform: float, speed: float = 20.0) -> LeaderState:
    """The first leader of a car at 1000 m."""
    return appear(TRAFFIC, no_leader(), 1000.0, speed, 1.0, uniform)


@given(st.floats(0.0, 1.0, exclude_max=True), st.floats(5.0, 40.0))
def test_a_leader_is_5_to_15_kmh_slower(uniform: float, speed: float) -> None:
    slower_kmh = (speed - leader(uniform, speed).longitudinal_velocity) * 3.6
    assert 5.0 - 1e-9 <= slower_kmh < 15.0 + 1e-9  # rounding of the speeds


def test_a_leader_never_drives_backwards() -> None:
    assert leader(0.9, 1.0).longitudinal_velocity == 0.0


def test_a_leader_appears_ahead_and_counts() -> None:
    first = leader(0.5)
    assert first.present
    assert first.longitudinal_position == 1070.0
    assert first.num_appeared == 1.0
    second = appear(TRAFFIC, first, 3000.0, 20.0, 1.0, 0.5)
    assert second.num_appeared == 2.0


@pytest.mark.parametrize("event", range(4))
def test_leaders_are_due_at_1_3_5_and_7_km(event: int) -> None:
    state = no_leader()._replace(num_appeared=float(event))
    place = 1000.0 + 2000.0 * event
    assert not due(TRAFFIC, state, place - 0.1)
    assert due(TRAFFIC, state, place)


def test_no_fifth_leader_is_due() -> None:
    state = no_leader()._replace(num_appeared=4.0)
    assert not due(TRAFFIC, state, 1e6)


@given(st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_a_leader_drives_on_at_its_speed(first: float, second: float) -> None:
    start = leader(0.3)
    twice = drive_on(drive_on(start, first), second)
    travelled = twice.longitudinal_position - start.longitudinal_position
    # Rounding of kilometres.
    assert travelled == pytest.approx(
        start.longitudinal_velocity * (first + second), abs=1e-9
    )
    assert twice.longitudinal_velocity == start.longitudinal_velocity


def test_one_of_two_leaders_is_chosen_whole() -> None:
    one, other = leader(0.1), no_leader()
    assert select(True, one, other) == one
    assert select(False, one, other) == other
