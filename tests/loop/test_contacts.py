"""Strip, barrier, other cars: what the driven car touches and what comes of it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from costeer.loop.events import (
    EventState,
    contact_of,
    has_collided,
    initial_events,
    place_of,
    with_car,
)
from costeer.loop.person import PersonHeld, PersonMotion, initial_motion
from costeer.loop.real_wheel import WheelInput, wheel_step
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.plant.fleet import CARS, CarKind, FleetParameters, fleet_parameters
from costeer.plant.fleet import Car as CarState
from costeer.plant.parameters import DEFAULT_CAR, RoadParameters
from costeer.plant.place import BARRIER, CAR, NO_CONTACT, STRIP, Place
from costeer.plant.stretches import NOTHING_HAPPENS, Stretch, stretches
from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import Actor, Event, Road, Scenario, When
from tests.drivers.samples import driving, leader

ROAD = RoadParameters()
WIDTH, LENGTH = DEFAULT_CAR.width, DEFAULT_CAR.length
NOBODY = fleet_parameters(())


def touched(
    state: EventState,
    fleet: FleetParameters = NOBODY,
    position: float = 0.0,
    lateral: float = 0.0,
) -> float:
    """What the car touches at a place."""
    measured = driving(position, lateral)
    return contact_of(fleet, ROAD, DEFAULT_CAR, with_car(state, measured), measured)


def test_in_its_lane_on_an_empty_road_the_car_touches_nothing() -> None:
    for lateral in (0.0, -1.75, -3.5):
        assert touched(initial_events(NOBODY), lateral=lateral) == NO_CONTACT


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_strip_and_barrier_lie_on_both_sides(side: float) -> None:
    start = initial_events(NOBODY)
    line = 3.5
    middle = -1.75  # of the road; its outer lines are 3.5 m away on either side
    for beyond, contact in ((0.05, NO_CONTACT), (0.3, STRIP), (1.0, NO_CONTACT)):
        lateral = middle + side * (line + beyond - WIDTH / 2.0)
        assert touched(start, lateral=lateral) == contact
    wall = middle + side * (line + ROAD.shoulder - WIDTH / 2.0)
    assert touched(start, lateral=wall - side * 0.01) == NO_CONTACT
    assert touched(start, lateral=wall + side * 0.01) == BARRIER


def beside(along: float, across: float) -> tuple[EventState, FleetParameters]:
    """Another car, a truck, at a distance of the middles from the driven one."""
    fleet = fleet_parameters(
        [CarKind(length=12.0, width=2.5)], own=CarKind(length=LENGTH, width=WIDTH)
    )
    state = initial_events(fleet)
    CARS.write(state.fleet.cars, 1, CarState(1.0, along, across))
    return state, fleet


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("along", "across", "contact"),
    [
        ((12.0 + LENGTH) / 2.0 - 0.01, 0.0, CAR),
        ((12.0 + LENGTH) / 2.0 + 0.01, 0.0, NO_CONTACT),
        (3.0, (2.5 + WIDTH) / 2.0 - 0.01, CAR),
        (3.0, (2.5 + WIDTH) / 2.0 + 0.01, NO_CONTACT),
    ],
)
def test_two_cars_touch_when_their_outlines_do(
    sign: float, along: float, across: float, contact: float
) -> None:
    state, fleet = beside(sign * along, sign * across)
    assert touched(state, fleet) == contact


@pytest.mark.parametrize(
    ("along", "lateral", "contact"),
    [
        (LENGTH - 0.01, 0.0, CAR),
        (-LENGTH + 0.01, 0.0, CAR),
        (LENGTH + 0.01, 0.0, NO_CONTACT),
        (0.0, -WIDTH + 0.01, CAR),
        (0.0, -WIDTH - 0.01, NO_CONTACT),
    ],
)
def test_the_car_to_overtake_can_be_hit(
    along: float, lateral: float, contact: float
) -> None:
    state = initial_events(NOBODY)._replace(leader=leader(100.0 + along, 15.0))
    assert touched(state, position=100.0, lateral=lateral) == contact


def test_a_leader_that_is_not_there_is_not_hit() -> None:
    gone = leader(0.0, 15.0)._replace(present=False)
    assert touched(initial_events(NOBODY)._replace(leader=gone)) == NO_CONTACT


@pytest.mark.parametrize("contact", [BARRIER, CAR])
def test_a_collision_stays_and_a_strip_does_not(contact: float) -> None:
    hit = initial_events(NOBODY)._replace(contact=contact)
    assert touched(hit) == contact
    assert has_collided(hit)
    on_strip = hit._replace(contact=STRIP)
    assert touched(on_strip) == NO_CONTACT
    assert not has_collided(on_strip)


@pytest.mark.parametrize(
    ("contact", "stops"), [(STRIP, False), (BARRIER, True), (CAR, True)]
)
def test_what_was_hit_stops_the_car_and_a_strip_shakes_it(
    contact: float, stops: bool
) -> None:
    state = initial_events(NOBODY)._replace(contact=contact)
    left, right = (
        place_of(ROAD, NOTHING_HAPPENS, state, driving(50.0, -1.75 + side))
        for side in (3.0, -3.0)
    )
    assert left.stopped == right.stopped == stops
    assert left.rumble == -right.rumble == (0.0 if stops else ROAD.rumble)


def test_the_place_has_the_bend_and_the_wind_that_are_there() -> None:
    gusts = stretches([Stretch(100.0, 200.0, side_force=700.0)])
    here = driving(150.0)._replace(road_curvature=0.002, road_curvature_slope=1e-5)
    place = place_of(ROAD, gusts, initial_events(NOBODY), here)
    assert place.bend == (150.0, 0.002, 1e-5)
    assert place.side_force == 700.0


def trial(scenario: Scenario, **about: Any) -> TrialRecord:
    usual = TrialSetup(
        seed=3,
        condition="manual",
        driver="hands-off",
        intention="off",
        events=False,
        speed=20.0,
        length=scenario.road.length,
        scenario=scenario,
    )
    return simulate_trial(usual._replace(**about))


@cache
def blown_off(force: float = 2500.0) -> TrialRecord:
    """Nobody steers, and a gust pushes the car over the outer line."""
    gust = Event("gust", at=100.0, length=200.0, force=force)
    return trial(Scenario("storm", road=Road(length=1500.0), events=(gust,)))


@pytest.mark.parametrize("force", [2500.0, -3500.0])
def test_a_car_that_is_blown_off_meets_strip_then_barrier_and_the_trial_ends(
    force: float,
) -> None:
    columns = blown_off(force).columns
    contact = columns["contact"]
    changes = contact[np.flatnonzero(np.diff(contact, prepend=-1))]
    assert changes.tolist() == [NO_CONTACT, STRIP, NO_CONTACT, BARRIER]
    assert np.flatnonzero(contact == BARRIER).tolist() == [len(contact) - 1]
    assert columns["longitudinal_position"][-1] < 1400.0
    wall = 1.75 + 3.5 * (force < 0.0) + 2.5 - WIDTH / 2.0
    lateral = columns["lateral_position"]
    assert abs(lateral[-1]) >= wall > abs(lateral[-2])


def test_the_strip_is_felt_at_the_wheel_within_its_limit() -> None:
    # The same gust on a road without strips: what differs is the strip.
    columns = blown_off().columns
    gust = Event("gust", at=100.0, length=200.0, force=2500.0)
    smooth = Road(length=1500.0, rumble_strip=False)
    plain = trial(Scenario("storm", road=smooth, events=(gust,))).columns
    on = np.flatnonzero(columns["contact"] == STRIP)
    first = on[0] + 1
    np.testing.assert_array_equal(
        columns["steering_wheel_rate"][:first], plain["steering_wheel_rate"][:first]
    )
    shaken = (
        columns["steering_wheel_rate"][on[1:]] - plain["steering_wheel_rate"][on[1:]]
    )
    # At most 0.6 N·m on 0.11 kg·m² for half a groove of 15 ms; at least a tenth of it.
    assert 0.008 < np.abs(shaken).max() < 0.6 / 0.11 * 0.015


def standing(headway: float) -> Scenario:
    wall = Actor("load", kind="obstacle", lane=1, appears=When(place=200.0))
    road = Road(length=600.0)
    return Scenario("wall", road=road, actors=(wall._replace(headway=headway),))


def test_something_that_lies_on_the_road_is_hit_where_it_lies() -> None:
    record = trial(standing(0.3))
    columns = record.columns
    assert columns["contact"].tolist() == [0] * (len(columns["contact"]) - 1) + [CAR]
    gap = columns["car_01_position"] - columns["longitudinal_position"]
    outline = (LENGTH + 1.0) / 2.0
    assert gap[-1] <= outline < gap[-2]
    # It appeared 0.3 s ahead of the front, and nobody reacts in so short a time.
    seen = np.flatnonzero(np.isfinite(gap))
    assert gap[seen[0]] - outline == pytest.approx(0.3 * 20.0, abs=20.01 / 60.0)
    assert len(seen) == pytest.approx(0.3 * 60.0, abs=2.0)


def person(place: Place) -> tuple[PersonMotion, float]:
    """A real wheel, held straight, one plant step later."""
    parameters = loop_parameters(TrialSetup(driver="hands-off", intention="off"))
    held = PersonHeld(0.0, 0.0, torque_command=0.0, drive_command=0.0, place=place)
    wheel = WheelInput(0.0, 0.0, 0.0, damping=0.0, friction=0.0)
    return wheel_step(parameters, initial_motion(parameters), held, wheel)


@pytest.mark.parametrize("rumble", [0.6, -0.6])
def test_a_real_wheel_gives_the_strips_torque_and_no_more(rumble: float) -> None:
    motion, torque = person(Place(rumble=rumble))
    calm, nothing = person(Place())
    position = motion.plant.world.vehicle.longitudinal_position
    # A groove goes from -1 over 1 to -1 within 0.6 m, evenly.
    share = position / 0.6 % 1.0
    expected = rumble * (4.0 * min(share, 1.0 - share) - 1.0)
    assert torque - nothing == pytest.approx(expected)
    assert abs(torque - nothing) <= 0.6
    assert motion.plant.world == calm.plant.world


def test_with_a_real_wheel_wind_and_collisions_act_on_the_car() -> None:
    blown, _ = person(Place(side_force=1500.0))
    assert blown.plant.world.vehicle.lateral_velocity > 0.0
    stopped, _ = person(Place(stopped=True))
    assert stopped.plant.world.vehicle.longitudinal_velocity == 0.0
    assert stopped.plant.world.vehicle.longitudinal_position == 0.0
