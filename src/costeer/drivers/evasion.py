"""Emergency: what is in the way cannot be followed; brake, and swerve if there is room.

The manoeuvre is none of the driver's lane changes: no glance, no preparation, a path as
short as a person steers in fear. Anchors: at 70 km/h and above 3.0 s everybody avoids
an obstacle, below 1.2 s nobody; the first reaction comes after 0.3 s at the earliest;
peaks of the wheel rate are about 500 deg/s (spec section 12). Set on manual driving.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.drivers.interface import Knowledge, Perception
from costeer.plant.following import LONGEST_GAP, Ahead, LaneOutlook
from costeer.plant.outlook import Neighbours
from costeer.plant.parameters import CarParameters
from costeer.plant.road import lane_centre
from costeer.sensing.measurement import Measurement


class EvasionParameters(NamedTuple):
    """How a driver avoids an obstacle.

    Attributes:
        reaction_time: From its being a danger until hands and foot move [s]. Source:
            0.3 s at the earliest in the anchors; median assumed, spread over the
            population.
        danger_braking: An obstacle is a danger when it asks for more braking than this
            [m/s²]. Source: assumed, a little more than what is comfortable.
        danger_closing: And when it comes nearer faster than this [m/s]. Source:
            assumed.
        braking: Asked of the brake [m/s²]. Source: assumed, hard but on the tyres'
            linear side when steering too.
        duration: Of the swerve to the side [s]. Source: calibrated on manual driving;
            with 1.2 s the tyres give way and more drivers hit the obstacle.
        margin: Beside the obstacle that is aimed at [m]. Source: assumed.
        gap_behind: To a car behind in the lane beside that is accepted in danger, in
            seconds of the closing, the own braking with it [s]. Source: assumed.
        calm_after: From the beginning until the driver plans as usual [s]. Source:
            assumed.
        clear_road: Nothing is in the way so far ahead when the driver does [m].
            Source: assumed.
    """

    reaction_time: Real = 0.7
    danger_braking: Real = 2.0
    danger_closing: Real = 4.0
    braking: Real = 7.0
    duration: Real = 2.0
    margin: Real = 0.5
    gap_behind: Real = 1.5
    calm_after: Real = 3.0
    clear_road: Real = 20.0


class EvasionState(NamedTuple):
    """What the driver remembers of a danger.

    Attributes:
        noticed: Since there has been a danger [s].
        evading: Since hands and foot moved; negative: not [s].
        side: Swerved to, -1 right, 0 not at all, +1 left [-].
        target: Lateral position swerved to [m].
    """

    noticed: Real
    evading: Real
    side: Real
    target: Real


class Evasion(NamedTuple):
    """What it makes of this step.

    Attributes:
        unseen: Whether there is a danger that the driver has not reacted to.
        active: Whether the driver is busy with the danger.
        brakes: Whether the foot brakes: as long as something is in the way.
        steers: Whether a swerve begins at this step.
        ends: Whether it is over at this step.
        target: Lateral position swerved to [m].
    """

    unseen: Flag
    active: Flag
    brakes: Flag
    steers: Flag
    ends: Flag
    target: Real


CALM = Evasion(
    unseen=False, active=False, brakes=False, steers=False, ends=False, target=0.0
)
"""Nothing is in the way."""


@compiled
def initial_state() -> EvasionState:
    """No danger."""
    return EvasionState(noticed=0.0, evading=-1.0, side=0.0, target=0.0)


class Danger(NamedTuple):
    """What may be in the way.

    Attributes:
        ahead: The next thing in the way, in the lane that is steered to if there is
            one.
        beside: Whether it is in that lane and not in the car's own way.
        own_centre: Lateral position of the centre of the lane the car is in [m].
    """

    ahead: Ahead
    beside: Flag
    own_centre: Real


@compiled
def danger_of(around: Neighbours, steered: Real, own_centre: Real) -> Danger:
    """What may be in the way of a driver who steers to a side.

    Args:
        around: Cars and obstacles.
        steered: Side of a lane change under way, -1 right, 0 none, +1 left [-].
        own_centre: Lateral position of the centre of the lane the car is in [m].
    """
    target = xp.select(steered > 0.0, around.left, around.right).ahead
    beside = (steered != 0.0) & (target.gap < around.own.ahead.gap)
    ahead = xp.select(beside, target, around.own.ahead)
    return Danger(ahead=ahead, beside=beside, own_centre=own_centre)


@compiled
def is_danger(
    parameters: EvasionParameters, ahead: Ahead, measurement: Measurement
) -> Flag:
    """Whether what is in the way asks for harder braking than following does."""
    closing = measurement.longitudinal_velocity - ahead.velocity
    room = xp.maximum(ahead.gap - 1.0, 0.1)
    needed = closing * closing / (2.0 * room)
    fast = closing > parameters.danger_closing
    return fast & (needed > parameters.danger_braking)


@compiled
def has_room(
    parameters: EvasionParameters,
    lane: LaneOutlook,
    own: LaneOutlook,
    measurement: Measurement,
    exists: Flag,
) -> Flag:
    """Whether a lane beside is free enough to swerve into.

    Args:
        parameters: Of this driver.
        lane: Beside.
        own: The lane with the obstacle.
        measurement: Of the own car.
        exists: Whether there is such a lane.
    """
    closing = xp.maximum(lane.behind.velocity - measurement.longitudinal_velocity, 0.0)
    coming = closing + parameters.braking / 2.0
    behind = lane.behind.gap > 2.0 + parameters.gap_behind * coming
    ahead = lane.ahead.gap > own.ahead.gap
    return exists & behind & ahead


@compiled
def swerve_target(
    parameters: EvasionParameters,
    danger: Danger,
    car: CarParameters,
    side: Real,
) -> Real:
    """Lateral position beside the obstacle, or in the own lane if it is beside [m].

    Args:
        parameters: Margin.
        danger: The obstacle.
        car: The own one.
        side: To pass on [-].
    """
    obstacle = danger.ahead
    away = (obstacle.width + car.width) / 2.0 + parameters.margin
    passed = obstacle.lateral + side * away
    return xp.select(danger.beside, danger.own_centre, passed)


@compiled
def chosen_side(
    danger: Danger,
    measurement: Measurement,
    left_free: Flag,
    right_free: Flag,
) -> Real:
    """Side to swerve to [-]: the free one that is nearer, 0 if none is."""
    leans_left = measurement.lateral_position >= danger.ahead.lateral
    nearer = xp.select(leans_left, 1.0, -1.0)
    only = xp.select(left_free, 1.0, xp.select(right_free, -1.0, 0.0))
    both = (left_free & right_free) | danger.beside
    return xp.select(both, nearer, only)


@compiled
def alarmed(
    parameters: EvasionParameters,
    state: EvasionState,
    seen: Perception,
    known: Knowledge,
    steered: Real,
    dt: Real,
) -> tuple[EvasionState, Evasion]:
    """Notice, react, calm down, where there is something in the way.

    Args:
        parameters: Of this driver.
        state: Of the danger.
        seen: Cars, obstacles and the own motion.
        known: Car and road.
        steered: Side of a lane change under way, -1 right, 0 none, +1 left [-].
        dt: Control step [s].
    """
    around, measurement = seen.around, seen.measurement
    centre = lane_centre(known.road, measurement.lane)
    threat = danger_of(around, steered, centre)
    danger = is_danger(parameters, threat.ahead, measurement)
    active = state.evading >= 0.0
    noticed = xp.select(danger, state.noticed + dt, 0.0)
    begins = danger & xp.logical_not(active) & (noticed >= parameters.reaction_time)
    lane = measurement.lane
    has_left = lane < known.road.num_lanes - 1.0
    left = has_room(parameters, around.left, around.own, measurement, has_left)
    right = has_room(parameters, around.right, around.own, measurement, lane > 0.0)
    side = chosen_side(threat, measurement, left, right)
    since = xp.select(active, state.evading + dt, -1.0)
    is_passed = threat.ahead.gap > parameters.clear_road
    rested = since >= parameters.calm_after
    over = active & rested & is_passed & xp.logical_not(danger)
    new = EvasionState(
        noticed=noticed,
        evading=xp.select(begins, 0.0, xp.select(over, -1.0, since)),
        side=xp.select(begins, side, state.side),
        target=xp.select(
            begins, swerve_target(parameters, threat, known.car, side), state.target
        ),
    )
    ahead, busy = threat.ahead, new.evading >= 0.0
    nearing = measurement.longitudinal_velocity > ahead.velocity
    return new, Evasion(
        unseen=danger & xp.logical_not(busy),
        active=busy,
        brakes=busy & nearing & (ahead.gap < LONGEST_GAP),
        steers=begins & (side != 0.0),
        ends=over,
        target=new.target,
    )


@compiled
def step(
    parameters: EvasionParameters,
    state: EvasionState,
    seen: Perception,
    known: Knowledge,
    steered: Real,
    dt: Real,
) -> tuple[EvasionState, Evasion]:
    """Notice, react, calm down; nothing on an empty road.

    Args:
        parameters: Of this driver.
        state: Of the danger.
        seen: Cars, obstacles and the own motion.
        known: Car and road.
        steered: Side of a lane change under way, -1 right, 0 none, +1 left [-].
        dt: Control step [s].
    """
    around = seen.around
    nearest = xp.minimum(around.own.ahead.gap, around.left.ahead.gap)
    nearest = xp.minimum(nearest, around.right.ahead.gap)
    busy = (nearest < LONGEST_GAP) | (state.evading >= 0.0)
    given = parameters, state, seen, known, steered, dt
    return xp.when(busy, alarmed, given, (initial_state(), CALM))
