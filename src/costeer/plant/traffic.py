"""The slower car ahead: one leader at a time, at constant speed in one lane."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled


class TrafficParameters(NamedTuple):
    """Overtaking events of a trial.

    Attributes:
        first_event: Where the first leader appears along the road [m]. Source:
            assumed, 1 km, the road before it is for settling in.
        event_spacing: Distance between events [m]. Source: assumed, 2 km.
        num_events: Leaders in a trial [-]. Source: paper, four.
        appearance_distance: Ahead of the car when a leader appears [m]. Source:
            assumed, so that an overtaking ends before the next event.
        smallest_difference: Least speed of the car above the leader's when it appears
            [m/s]. Source: assumed, 5 km/h.
        largest_difference: Largest such difference [m/s]. Source: assumed, 15 km/h.
        zone_distance: A leader within this distance opens the event zone [m].
            Source: assumed.
    """

    first_event: Real = 1000.0
    event_spacing: Real = 2000.0
    num_events: Real = 4.0
    appearance_distance: Real = 70.0
    smallest_difference: Real = 5.0 / 3.6
    largest_difference: Real = 15.0 / 3.6
    zone_distance: Real = 100.0


class LeaderState(NamedTuple):
    """The car to overtake.

    Attributes:
        present: Whether there is one.
        longitudinal_position: Along the road [m].
        longitudinal_velocity: [m/s].
        lane: That it drives in [-].
        num_appeared: Leaders that have appeared in this trial [-].
    """

    present: Flag
    longitudinal_position: Real
    longitudinal_velocity: Real
    lane: Real
    num_appeared: Real


@compiled
def no_leader() -> LeaderState:
    """An empty road."""
    return LeaderState(
        present=False,
        longitudinal_position=0.0,
        longitudinal_velocity=0.0,
        lane=0.0,
        num_appeared=0.0,
    )


@compiled
def due(traffic: TrafficParameters, leader: LeaderState, position: Real) -> Flag:
    """Whether the next leader should appear when the car is at `position` [m]."""
    place = traffic.first_event + traffic.event_spacing * leader.num_appeared
    return (leader.num_appeared < traffic.num_events) & (position >= place)


@compiled
def appear(
    traffic: TrafficParameters,
    leader: LeaderState,
    position: Real,
    speed: Real,
    lane: Real,
    uniform: Real,
) -> LeaderState:
    """The next leader, ahead of the car and slower than it.

    Args:
        traffic: Distance and speed difference.
        leader: The one before, whose count goes on.
        position: Of the car along the road [m].
        speed: Of the car [m/s].
        lane: That the leader drives in [-].
        uniform: A draw in [0, 1) that sets the speed difference.
    """
    spread = traffic.largest_difference - traffic.smallest_difference
    difference = traffic.smallest_difference + spread * uniform
    return LeaderState(
        present=True,
        longitudinal_position=position + traffic.appearance_distance,
        longitudinal_velocity=xp.maximum(speed - difference, 0.0),
        lane=lane,
        num_appeared=leader.num_appeared + 1.0,
    )


@compiled
def drive_on(leader: LeaderState, dt: Real) -> LeaderState:
    """The leader `dt` [s] later."""
    moved = leader.longitudinal_position + leader.longitudinal_velocity * dt
    return leader._replace(longitudinal_position=moved)
