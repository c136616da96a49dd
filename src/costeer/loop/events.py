"""Overtaking events of a trial: when a leader appears, and the zone around it."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.alignment import Bend
from costeer.plant.fleet import (
    Car,
    Fleet,
    FleetParameters,
    initial_fleet,
    with_ego,
)
from costeer.plant.outlook import Spot, has_cars, outlook
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.plant.place import (
    BARRIER,
    CAR,
    NO_CONTACT,
    STRIP,
    Place,
    beyond_line,
    ground_contact,
)
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.stretches import Stretches, side_force, stretch_at
from costeer.plant.traffic import (
    LeaderState,
    TrafficParameters,
    appear,
    drive_on,
    due,
    no_leader,
)
from costeer.sensing.measurement import Measurement


class EventState(NamedTuple):
    """What happens on the road: the leader and its event, other cars, contacts.

    Attributes:
        leader: The car to overtake.
        event: 0 outside an event zone, else the number of the event [-].
        fleet: The other cars.
        contact: What the car touches, `NO_CONTACT` to `CAR` [-]; what stops it stays.
    """

    leader: LeaderState
    event: Real
    fleet: Fleet
    contact: Real


@compiled
def initial_events(fleet: FleetParameters) -> EventState:
    """The road before the first step; no car has appeared."""
    return EventState(
        leader=no_leader(),
        event=0.0,
        fleet=initial_fleet(fleet),
        contact=NO_CONTACT,
    )


@compiled
def event_zone(
    traffic: TrafficParameters, state: EventState, position: Real, at_home: Flag
) -> Real:
    """Number of the event whose zone the car is in, 0 outside [-].

    A zone begins with the leader within `zone_distance` ahead and ends when the
    driver has returned behind it and settled.

    Args:
        traffic: Zone distance.
        state: Leader and zone before.
        position: Of the car along the road [m].
        at_home: Whether the driver is back in the cruising lane.
    """
    gap = state.leader.longitudinal_position - position
    near = state.leader.present & (gap > 0.0) & (gap <= traffic.zone_distance)
    over = at_home & xp.logical_not(state.leader.present & (gap > 0.0))
    inside = xp.select(near, state.leader.num_appeared, state.event)
    return xp.select(over, 0.0, inside)


@compiled
def step_events(
    traffic: TrafficParameters,
    road: RoadParameters,
    state: EventState,
    measurement: Measurement,
    at_home: Flag,
    leader_uniform: Real,
    dt: Real,
) -> EventState:
    """Leader and event zone one control step later.

    A leader that is due waits until the event before is over and the car is back in
    the cruising lane.

    Args:
        traffic: Where leaders appear, how fast they are.
        road: Lanes.
        state: Leader and zone.
        measurement: Of the car.
        at_home: Whether the driver is back in the cruising lane: of a virtual one the
            decision says so, a person's car has settled there.
        leader_uniform: A draw in [0, 1) for the leader's speed; negative: no leader.
        dt: Control step [s].
    """
    position = measurement.longitudinal_position
    event = event_zone(traffic, state, position, at_home)
    cruising = cruising_lane(road)
    ready = (event == 0.0) & at_home & (measurement.lane == cruising)
    appears = ready & due(traffic, state.leader, position) & (leader_uniform >= 0.0)
    new = appear(
        traffic,
        state.leader,
        position,
        measurement.longitudinal_velocity,
        cruising,
        leader_uniform,
    )
    leader = xp.select(appears, new, drive_on(state.leader, dt))
    return state._replace(leader=leader, event=event)


@compiled
def with_car(state: EventState, measurement: Measurement) -> EventState:
    """The road with the driven car where it has been measured."""
    speed = measurement.longitudinal_velocity
    ego = Car(
        present=1.0,
        position=measurement.longitudinal_position,
        lateral=measurement.lateral_position,
        velocity=speed,
        acceleration=measurement.longitudinal_acceleration,
        lane=measurement.lane,
        origin=measurement.lateral_position,
        desired=speed,
    )
    return state._replace(fleet=with_ego(state.fleet, ego))


@compiled
def hits_car(
    fleet: FleetParameters, state: EventState, car: CarParameters, ego: Car
) -> Flag:
    """Whether the driven car and another one are in one place.

    Args:
        fleet: Sizes of the cars.
        state: Where they are.
        car: The driven one.
        ego: Where it is.
    """
    path = Spot(0, ego.position, ego.lateral, car.width / 2.0)
    near = outlook(fleet, state.fleet, path)
    return (near.ahead.gap <= 0.0) | (near.behind.gap <= 0.0)


@compiled
def hits_leader(
    road: RoadParameters, leader: LeaderState, car: CarParameters, ego: Car
) -> Flag:
    """Whether the driven car and the leader are in one place."""
    along = xp.absolute(leader.longitudinal_position - ego.position)
    beside = xp.absolute(lane_centre(road, leader.lane) - ego.lateral)
    return leader.present & (along < car.length) & (beside < car.width)


@compiled
def contact_of(
    fleet: FleetParameters,
    road: RoadParameters,
    car: CarParameters,
    state: EventState,
    measurement: Measurement,
) -> Real:
    """What the car touches now, `NO_CONTACT` to `CAR` [-]; a collision stays.

    Args:
        fleet: Sizes of the cars.
        road: Lanes, shoulder.
        car: The driven one.
        state: Where all cars are.
        measurement: Of the driven one.
    """
    beyond = beyond_line(road, measurement.lateral_position, car.width)
    ground = ground_contact(road, beyond)
    ego = Car(
        position=measurement.longitudinal_position,
        lateral=measurement.lateral_position,
    )
    given = fleet, state, car, ego
    hit = xp.when(has_cars(fleet), hits_car, given, False)
    hit = hit | hits_leader(road, state.leader, car, ego)
    now = xp.select(hit, CAR, ground)
    return xp.select(state.contact >= BARRIER, state.contact, now)


@compiled
def has_collided(state: EventState) -> Flag:
    """Whether the car has hit a barrier or another car."""
    return state.contact >= BARRIER


@compiled
def place_of(
    road: RoadParameters,
    along: Stretches,
    state: EventState,
    measurement: Measurement,
) -> Place:
    """What the road does to the car where it is.

    Args:
        road: Its strips.
        along: What happens on it.
        state: With the contact.
        measurement: Where the car is and how the road bends there.
    """
    position = measurement.longitudinal_position
    stretch, lasts = stretch_at(along, position)
    middle = lane_centre(road, (road.num_lanes - 1.0) / 2.0)
    left = measurement.lateral_position > middle
    torque = xp.select(left, road.rumble, -road.rumble)
    return Place(
        bend=Bend(
            station=position,
            curvature=measurement.road_curvature,
            slope=measurement.road_curvature_slope,
        ),
        side_force=side_force(stretch, lasts, position),
        rumble=xp.select(state.contact == STRIP, torque, 0.0),
        stopped=state.contact >= BARRIER,
    )


@compiled
def leader_visible(state: EventState, position: Real) -> Flag:
    """Whether the leader is on this stretch of road: not far behind the car."""
    return state.leader.present & (
        state.leader.longitudinal_position > position - 200.0
    )


class Lead(NamedTuple):
    """The leader as the record shows it; NaN where there is none to see.

    Attributes:
        distance: From the car to the leader [m].
        velocity: Of the leader [m/s].
        lane: Of the leader [-].
    """

    distance: Real
    velocity: Real
    lane: Real


@compiled
def lead_of(state: EventState, position: Real) -> Lead:
    """The leader as it is seen from `position` [m]."""
    leader, visible = state.leader, leader_visible(state, position)
    gap = leader.longitudinal_position - position
    return Lead(
        distance=xp.select(visible, gap, math.nan),
        velocity=xp.select(visible, leader.longitudinal_velocity, math.nan),
        lane=xp.select(visible, leader.lane, math.nan),
    )
