"""Whether to overtake and to return: slower cars, gaps, and what is worth it.

A driver overtakes when a slower leader is close and either slow enough to be worth it
or has been in the way for longer than the driver's patience. What stands or crawls is
seen from afar, and passed by a lane change while there is time for one. A leader that
is not slower than the driver wants to be is followed. All ways need a gap.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.following import LaneOutlook
from costeer.plant.traffic import LeaderState
from costeer.sensing.measurement import Measurement

FORESIGHT = 15.0
"""What stands or crawls ahead is passed as soon as it would be met within this time
[s]. Source: assumed, a lane change, its preparation, and then some."""

CRAWLING = 8.0
"""It crawls when it is slower than the own car by this [m/s]. Source: assumed, twice
the largest difference of the experiment."""

CALM_BRAKING = 2.0
"""What asks for more braking than this is an emergency and no lane change [m/s²].
Source: `EvasionParameters.danger_braking`."""


class DecisionParameters(NamedTuple):
    """When and how this driver changes lanes.

    Attributes:
        decides: 1 if the driver overtakes, 0 if not [-]. Source: assumed.
        headway: Time gap to a slower leader at which overtaking is decided [s].
            Source: assumed, spread over the population.
        worthwhile_difference: Wanted speed above the leader's at which overtaking is
            worth it at once [m/s]. Source: assumed, 3.6 km/h; the leaders of the
            experiment are 5 to 15 km/h slower.
        patience: How long a leader who is slower by less is followed [s]. Source:
            assumed, spread over the population.
        return_headway: Time gap ahead of the leader at which the return is decided
            [s]. Source: assumed, spread over the population.
        change_duration: Median planned duration of the driver [s]. Source: assumed,
            such that the measured one is human.
        change_duration_spread: Standard deviation of the logarithm of the planned
            duration within the driver [-]. Source: assumed, as above.
        preparation_time: Median time from the decision to overtake until steering
            [s]. Source: assumed; with it the first glance is 4.2 s before the line.
        return_preparation_time: The same before the return [s]. Source: assumed,
            first glance 2.8 s before the line.
        preparation_spread: Standard deviation of the logarithm of both [-]. Source:
            assumed.
        glance_share: Share of lane changes with a glance before them [-]. Source:
            Jain et al. (2015), recordings of ten drivers, 0.84.
        shoulder_share: Share of lane changes with a look over the shoulder, one of
            those with a glance [-]. Source: assumed.
        settling_time: Pause after a lane change before the next decision [s].
            Source: assumed.
        abandoned_share: Share of decided lane changes that are given up on the way,
            for another car that comes up, say [-]. Source: assumed, none; drives to
            learn intention from have some.
        abandoned_latest: The latest moment of giving up, over the planned duration
            [-]. Source: assumed, a fifth of the way to the other lane; the path back
            takes as long as a lane change, so who gives up so late still swings over
            the line and comes back.
        abandoned_pause: From giving up until the next decision [s]. Source: assumed,
            the other car passes.
        gap_ahead: Least time gap to the car ahead in the other lane that is accepted
            [s]. Source: assumed, in the range of critical gaps of Toledo et al. (2003).
        gap_behind: Least time gap of the car behind there [s]. Source: as above.
        closing_time: Least time until either car would be met [s]. Source: assumed,
            people accept 5 s and more.
        return_room: A lane is worth changing to when the next car there is so many
            time gaps `headway` away, or fast enough [-]. Source: assumed.
    """

    decides: Real = 1.0
    headway: Real = 2.3
    worthwhile_difference: Real = 1.0
    patience: Real = 6.0
    return_headway: Real = 1.44
    change_duration: Real = 6.4
    change_duration_spread: Real = 0.1
    preparation_time: Real = 1.8
    return_preparation_time: Real = 0.35
    preparation_spread: Real = 0.35
    glance_share: Real = 0.84
    shoulder_share: Real = 0.42
    settling_time: Real = 1.0
    abandoned_share: Real = 0.0
    abandoned_latest: Real = 0.35
    abandoned_pause: Real = 3.0
    gap_ahead: Real = 0.6
    gap_behind: Real = 0.8
    closing_time: Real = 5.0
    return_room: Real = 2.0


class Surroundings(NamedTuple):
    """What a decision looks at.

    Attributes:
        measurement: Where the car is and how fast.
        leader: The car ahead.
        wanted_speed: Of the driver on a free road [m/s].
        outer: The lane to overtake in.
        home: The lane to return to.
        asked: 1 for a lane change that is asked for to overtake, -1 to return [-].
    """

    measurement: Measurement
    leader: LeaderState
    wanted_speed: Real
    outer: LaneOutlook = LaneOutlook()
    home: LaneOutlook = LaneOutlook()
    asked: Real = 0.0


@compiled
def accepts(
    parameters: DecisionParameters, lane: LaneOutlook, measurement: Measurement
) -> Flag:
    """Whether the gap in a lane beside is large enough, to the front and behind."""
    speed = measurement.longitudinal_velocity
    catching_up = xp.maximum(speed - lane.ahead.velocity, 0.0)
    ahead = lane.ahead.gap > xp.maximum(
        parameters.gap_ahead * speed, parameters.closing_time * catching_up
    )
    caught_up = xp.maximum(lane.behind.velocity - speed, 0.0)
    behind = lane.behind.gap > xp.maximum(
        parameters.gap_behind * lane.behind.velocity,
        parameters.closing_time * caught_up,
    )
    return ahead & behind


@compiled
def is_worth_overtaking(parameters: DecisionParameters, around: Surroundings) -> Flag:
    """Whether the lane to overtake in is free for a while, or faster."""
    next_car = around.outer.ahead
    speed = around.measurement.longitudinal_velocity
    far = next_car.gap > parameters.return_room * parameters.headway * speed
    faster = next_car.velocity - around.leader.longitudinal_velocity
    return far | (faster > parameters.worthwhile_difference)


@compiled
def is_worth_returning(parameters: DecisionParameters, around: Surroundings) -> Flag:
    """Whether the lane to return to is free for a while."""
    next_car = around.home.ahead
    speed = around.measurement.longitudinal_velocity
    far = next_car.gap > parameters.return_room * parameters.headway * speed
    return far | (next_car.velocity >= around.wanted_speed)


@compiled
def is_met_soon(gap: Real, closing: Real) -> Flag:
    """Whether something that stands or crawls is seen in time to change lanes.

    Args:
        gap: To it, positive ahead [m].
        closing: How much faster the own car is [m/s].
    """
    soon = gap < FORESIGHT * closing
    calmly = closing * closing < 2.0 * CALM_BRAKING * gap
    return (closing > CRAWLING) & soon & calmly


@compiled
def in_the_way(parameters: DecisionParameters, around: Surroundings) -> Flag:
    """Whether a leader slower than wanted is close ahead in the own lane."""
    leader, measurement = around.leader, around.measurement
    gap = leader.longitudinal_position - measurement.longitudinal_position
    speed = measurement.longitudinal_velocity
    near = gap < parameters.headway * speed
    met = is_met_soon(gap, speed - leader.longitudinal_velocity)
    close = (gap > 0.0) & (near | met)
    ahead = leader.present & (leader.lane == measurement.lane)
    return ahead & close & (leader.longitudinal_velocity < around.wanted_speed)


@compiled
def wants_to_overtake(
    parameters: DecisionParameters, impatience: Real, around: Surroundings
) -> Flag:
    """Whether the leader in the way is worth it, or was there for too long."""
    difference = around.wanted_speed - around.leader.longitudinal_velocity
    worth_it = difference > parameters.worthwhile_difference
    enough = worth_it | (impatience > parameters.patience)
    return in_the_way(parameters, around) & enough & (parameters.decides > 0.5)


@compiled
def wants_to_return(
    parameters: DecisionParameters, measurement: Measurement, leader: LeaderState
) -> Flag:
    """Whether the leader is far enough behind, or is no car of the other lane."""
    lead = measurement.longitudinal_position - leader.longitudinal_position
    enough = parameters.return_headway * measurement.longitudinal_velocity
    beside = leader.lane != measurement.lane
    return xp.logical_not(leader.present & beside) | (lead > enough)
