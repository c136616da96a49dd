"""Overtaking events of a trial: when a leader appears, and the zone around it."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import cruising_lane
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
    """The leader and the event it belongs to.

    Attributes:
        leader: The car ahead.
        event: 0 outside an event zone, else the number of the event [-].
    """

    leader: LeaderState
    event: Real


@compiled
def initial_events() -> EventState:
    """An empty road."""
    return EventState(leader=no_leader(), event=0.0)


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
    return EventState(leader=leader, event=event)


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
