"""What a scenario has in store and can never happen, or did not happen."""

from __future__ import annotations

import numpy as np
import pytest

import costeer
from costeer.scenarios.definition import Actor, Event, Order, Road, Scenario, When
from costeer.scenarios.reading import checked, chosen, scenario_named, shipped
from costeer.scenarios.unmet import unmet

SPEED = 80.0 / 3.6
ROAD = Road(length=1000.0)


def with_actor(**given: object) -> Scenario:
    actor = Actor(**({"name": "a", "at": 500.0, "lane": 0} | given))  # type: ignore[arg-type]  # of a test
    return Scenario("x", speed="80 km/h", road=ROAD, actors=(actor,))


def order(lane: int | None = 1, speed: str = "", **when: float) -> tuple[Order]:
    return (Order(When(**when), lane=lane, speed=speed),)


def with_events(*events: Event, lanes: int = 2) -> Scenario:
    return Scenario("x", road=ROAD._replace(lanes=lanes), events=events)


IMPOSSIBLE = {
    "appears in the driven car at a place": (
        with_actor(lane=1, at=700.0, appears=When(place=702.0)),
        "in one place",
    ),
    "appears in the driven car after a time": (
        with_actor(lane=1, at=10.0 * SPEED, appears=When(time=10.0)),
        "in one place",
    ),
    "appears in the driven car at a gap": (
        with_actor(lane=1, appears=When(gap=4.0)),
        "in one place",
    ),
    "has no place to be near to": (
        with_actor(at=0.0, headway=2.0, appears=When(gap=30.0)),
        "a headway, and a gap",
    ),
    "drives away and waits for a gap": (
        with_actor(speed="150 km/h", orders=order(gap=20.0)),
        "waits for a gap that never comes",
    ),
    "drives away and waits to be met": (
        with_actor(speed="150 km/h", orders=order(time_to_collision=2.0)),
        "waits for a time_to_collision that never comes",
    ),
    "is to go where it is": (
        with_actor(orders=order(lane=0, gap=20.0)),
        "lane 0, where it is already",
    ),
    "is a thing that drives": (
        with_actor(kind="obstacle", speed="20 km/h"),
        "an obstacle and has speed",
    ),
    "is a thing with orders": (
        with_actor(kind="obstacle", orders=order(gap=20.0)),
        "an obstacle and has orders",
    ),
    "is asked to go back, which is done anyway": (
        with_events(
            Event("lane-change", at=200.0, side="right"),
            Event("lane-change", at=700.0, side="left"),
        ),
        "lane-change at 700 m can never happen",
    ),
    "is a gust with a side": (
        with_events(Event("gust", at=200.0, force=900.0, side="left")),
        "a gust has no side",
    ),
    "is a lost head with a force": (
        with_events(Event("head-lost", at=200.0, force=900.0)),
        "a head-lost has no force",
    ),
}


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_what_can_never_happen_is_refused(what: str) -> None:
    scenario, told = IMPOSSIBLE[what]
    with pytest.raises(ValueError, match=told):
        checked(scenario)


POSSIBLE = {
    "a slower car to be met": with_actor(speed="60 km/h", orders=order(gap=20.0)),
    "a faster car that comes by": with_actor(
        at=-300.0, speed="150 km/h", orders=order(gap=20.0)
    ),
    "a car that slows down first": with_actor(
        speed="150 km/h",
        orders=(*order(None, "40 km/h", time=5.0), *order(gap=20.0)),
    ),
    "a car that goes back": with_actor(
        orders=(*order(1, gap=20.0), *order(0, gap=10.0))
    ),
    "a car that appears beside": with_actor(at=700.0, appears=When(place=702.0)),
    "two lane changes": with_events(
        Event("lane-change", at=200.0, side="right"),
        Event("lane-change", at=700.0, side="right"),
    ),
}


@pytest.mark.parametrize("what", POSSIBLE)
def test_what_can_happen_is_accepted(what: str) -> None:
    assert checked(POSSIBLE[what]).name == "x"


def test_what_lies_beyond_a_shorter_drive_is_told() -> None:
    for scenario, length, told in (
        ("obstacle", 600.0, "lost load (700 m)"),
        (with_actor(orders=order(place=800.0)), 700.0, "an order of a (800 m)"),
    ):
        assert told in chosen(scenario, length, None).notes[0]
    assert chosen("obstacle", 750.0, None).notes == ()


def test_a_speed_above_the_signs_is_told() -> None:
    slow = Scenario("x", speed="80 km/h", road=ROAD._replace(speed_limit="50 km/h"))
    assert (
        "is driven at 80 km/h where signs allow 50" in chosen(slow, None, None).notes[0]
    )
    even = slow._replace(road=ROAD._replace(speed_limit="80 km/h"))
    assert chosen(even, None, None).notes == ()


@pytest.mark.parametrize("name", shipped())
def test_what_ships_happens(name: str) -> None:
    scenario = scenario_named(name)
    for participant in range(1, 5) if scenario.actors else ():
        record = costeer.simulate("manual", scenario=name, participant=participant)
        assert unmet(record) == []


@pytest.mark.parametrize("participant", range(1, 9))
def test_both_cars_of_cut_in_cut_in(participant: int) -> None:
    columns = costeer.simulate(
        "manual", scenario="cut-in", participant=participant
    ).columns
    for car in ("car_01", "car_02"):
        gap = columns[f"{car}_position"] - columns["longitudinal_position"]
        there = np.isfinite(gap)
        lateral = columns[f"{car}_lateral"][there]
        crossing = np.flatnonzero(lateral > -1.75)[0]
        assert lateral[0] == -3.5
        assert 5.0 < gap[there][crossing] < 40.0


def test_what_did_not_happen_is_told_after_the_drive() -> None:
    near = with_actor(at=300.0, speed="78 km/h", orders=order(gap=100.0))
    late = with_events(Event("lane-change", at=995.0, length=4.0, side="right"))
    for scenario, told in (
        (near, "a never got its order (lane 1): its moment did not come"),
        (late, "the driver did not change to the right as asked for at 995 m"),
    ):
        with pytest.warns(UserWarning, match="never got its|did not change") as warned:
            costeer.simulate("manual", scenario=scenario, intention="off")
        assert str(warned[0].message) == told


def test_a_time_to_collision_counts_from_bumper_to_bumper() -> None:
    # At 80 km/h behind 60 km/h the gap of the middles is 4.5 m more than that between
    # the cars; the order comes at the first row at which the room is closed in 3 s.
    columns = costeer.simulate(
        "manual",
        scenario=with_actor(
            at=100.0, speed="60 km/h", orders=order(time_to_collision=3.0)
        ),
        intention="off",
    ).columns
    room = columns["car_01_position"] - columns["longitudinal_position"] - 4.5
    closing = columns["longitudinal_velocity"] - columns["car_01_velocity"]
    first = int(np.flatnonzero(columns["car_01_lateral"] > -3.5)[0])
    assert room[first] / closing[first] == pytest.approx(3.0, abs=0.1)
