"""Decision to overtake and to return: when, how long, with a glance or without.

A driver overtakes when a slower leader is close and either slow enough to be worth it
or has been in the way for longer than the driver's patience; a leader that is not
slower than the driver wants to be is followed.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.plant.following import LaneOutlook
from costeer.plant.traffic import LeaderState
from costeer.sensing.measurement import Measurement

CRUISING = 0.0
"""Phase: in the cruising lane, nothing planned."""
PREPARING = 1.0
"""Phase: decided to overtake, looks, has not steered yet."""
CHANGING = 2.0
"""Phase: steers to the overtaking lane."""
PASSING = 3.0
"""Phase: drives past the leader."""
PREPARING_RETURN = 4.0
"""Phase: decided to return."""
RETURNING = 5.0
"""Phase: steers back."""


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
    change_duration: Real = 7.2
    change_duration_spread: Real = 0.17
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


class DecisionState(NamedTuple):
    """What the driver is up to.

    Attributes:
        phase: One of the phases of this file [-].
        time_in_phase: [s].
        preparation_time: From this decision until steering [s].
        change_duration: Planned for this lane change [s].
        impatience: How long a slower leader has been in the way [s].
        looks: Whether this driver looks before this change.
        looks_over_shoulder: Whether one of the looks is over the shoulder.
        started: Whether steering to a lane starts at this step.
        decided: Whether the decision fell at this step.
        gives_up_after: From the decision until this lane change is given up [s];
            beyond all times if it is not.
        pause: Until the next decision may fall in this phase [s].
    """

    phase: Real
    time_in_phase: Real
    preparation_time: Real
    change_duration: Real
    impatience: Real
    looks: Flag
    looks_over_shoulder: Flag
    started: Flag
    decided: Flag
    gives_up_after: Real
    pause: Real


NEVER = 1e9
"""A time that does not come [s]."""


class Draws(NamedTuple):
    """Random numbers of one control step for a decision that may fall.

    Attributes:
        duration_normal: Standard normal, planned duration.
        preparation_normal: Standard normal, preparation time.
        glance_uniform: In [0, 1), whether there is a glance.
        abandoned_uniform: In [0, 1), whether and when it is given up.
    """

    duration_normal: Real
    preparation_normal: Real
    glance_uniform: Real
    abandoned_uniform: Real


@compiled
def initial_state() -> DecisionState:
    """Cruising."""
    return DecisionState(
        phase=CRUISING,
        time_in_phase=0.0,
        preparation_time=0.0,
        change_duration=6.0,
        impatience=0.0,
        looks=False,
        looks_over_shoulder=False,
        started=False,
        decided=False,
        gives_up_after=NEVER,
        pause=0.0,
    )


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
def in_the_way(parameters: DecisionParameters, around: Surroundings) -> Flag:
    """Whether a leader slower than wanted is close ahead in the own lane."""
    leader, measurement = around.leader, around.measurement
    gap = leader.longitudinal_position - measurement.longitudinal_position
    close = (gap > 0.0) & (gap < parameters.headway * measurement.longitudinal_velocity)
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


@compiled
def gives_up(state: DecisionState) -> Flag:
    """Whether the lane change under way is given up now."""
    preparing = (state.phase == PREPARING) | (state.phase == PREPARING_RETURN)
    changing = (state.phase == CHANGING) | (state.phase == RETURNING)
    since = state.time_in_phase + xp.select(changing, state.preparation_time, 0.0)
    return (preparing | changing) & (since >= state.gives_up_after)


@compiled
def abandoned_after(
    parameters: DecisionParameters,
    abandoned_uniform: Real,
    preparation_time: Real,
    change_duration: Real,
) -> Real:
    """From a decision until it is given up [s], `NEVER` for most.

    The moment is uniform from the decision to `abandoned_latest` of the change.

    Args:
        parameters: How many are given up, and how late.
        abandoned_uniform: In [0, 1).
        preparation_time: From the decision until steering [s].
        change_duration: Planned [s].
    """
    share = parameters.abandoned_share
    place = abandoned_uniform / xp.maximum(share, 1e-9)
    latest = preparation_time + parameters.abandoned_latest * change_duration
    return xp.select(abandoned_uniform < share, place * latest, NEVER)


@compiled
def next_phase(
    parameters: DecisionParameters,
    state: DecisionState,
    around: Surroundings,
) -> Real:
    """Phase after this step [-]."""
    time = state.time_in_phase
    prepared = time >= state.preparation_time
    settled = time >= state.change_duration + parameters.settling_time
    way_out = accepts(parameters, around.outer, around.measurement)
    way_back = accepts(parameters, around.home, around.measurement)
    overtake = wants_to_overtake(parameters, state.impatience, around)
    overtake = overtake & is_worth_overtaking(parameters, around)
    overtake = (overtake | (around.asked > 0.5)) & way_out
    back = wants_to_return(parameters, around.measurement, around.leader)
    back = (back & is_worth_returning(parameters, around)) | (around.asked < -0.5)
    rested = time >= state.pause
    phase = state.phase
    done = (
        ((phase == CRUISING) & overtake & rested)
        | ((phase == PREPARING) & prepared & way_out)
        | ((phase == CHANGING) & settled)
        | ((phase == PASSING) & back & rested & way_back)
        | ((phase == PREPARING_RETURN) & prepared & way_back)
    )
    home = (phase == RETURNING) & settled
    onwards = xp.select(home, CRUISING, xp.select(done, phase + 1.0, phase))
    stays = xp.select(phase >= PREPARING_RETURN, PASSING, CRUISING)
    return xp.select(gives_up(state), stays, onwards)


class Plan(NamedTuple):
    """What a decision fixes.

    Attributes:
        preparation_time: From the decision until steering [s].
        change_duration: Planned for this lane change [s].
        gives_up_after: From the decision until it is given up [s].
    """

    preparation_time: Real
    change_duration: Real
    gives_up_after: Real


@compiled
def planned(parameters: DecisionParameters, phase: Real, draws: Draws) -> Plan:
    """Times of a lane change that is decided in `phase`."""
    median = xp.select(
        phase == PREPARING,
        parameters.preparation_time,
        parameters.return_preparation_time,
    )
    preparation = median * xp.exp(
        parameters.preparation_spread * draws.preparation_normal
    )
    duration = parameters.change_duration * xp.exp(
        parameters.change_duration_spread * draws.duration_normal
    )
    return Plan(
        preparation_time=preparation,
        change_duration=duration,
        gives_up_after=abandoned_after(
            parameters, draws.abandoned_uniform, preparation, duration
        ),
    )


@compiled
def step(
    parameters: DecisionParameters,
    state: DecisionState,
    around: Surroundings,
    draws: Draws,
    dt: Real,
) -> DecisionState:
    """Decide for one step.

    Args:
        parameters: Of this driver.
        state: What the driver is up to.
        around: Car, leader and wanted speed.
        draws: Random numbers of this step, used if a decision falls.
        dt: Control step [s].
    """
    phase = next_phase(parameters, state, around)
    new = phase != state.phase
    abandoned = gives_up(state)
    decided = new & ((phase == PREPARING) | (phase == PREPARING_RETURN))
    plan = planned(parameters, phase, draws)
    looks = draws.glance_uniform < parameters.glance_share
    over_shoulder = draws.glance_uniform < parameters.shoulder_share
    waits = (phase == CRUISING) & in_the_way(parameters, around)
    steers_back = abandoned & ((state.phase == CHANGING) | (state.phase == RETURNING))
    starts = new & ((phase == CHANGING) | (phase == RETURNING))
    pause = xp.select(abandoned, parameters.abandoned_pause, 0.0)
    return DecisionState(
        phase=phase,
        time_in_phase=xp.select(new, 0.0, state.time_in_phase + dt),
        preparation_time=xp.select(
            decided, plan.preparation_time, state.preparation_time
        ),
        change_duration=xp.select(decided, plan.change_duration, state.change_duration),
        impatience=xp.select(waits, state.impatience + dt, 0.0),
        looks=xp.select(decided, looks, state.looks),
        looks_over_shoulder=xp.select(
            decided, over_shoulder, state.looks_over_shoulder
        ),
        started=starts | steers_back,
        decided=decided,
        gives_up_after=xp.select(decided, plan.gives_up_after, state.gives_up_after),
        pause=xp.select(new, pause, state.pause),
    )


@compiled
def direction(state: DecisionState, overtaking_side: Real) -> Real:
    """Side that the driver means to change to, -1 right, 0 none, +1 left [-]."""
    out = (state.phase == PREPARING) | (state.phase == CHANGING)
    back = (state.phase == PREPARING_RETURN) | (state.phase == RETURNING)
    inward = xp.select(back, -overtaking_side, 0.0)
    return xp.select(out, overtaking_side, inward)


@compiled
def steered_to(state: DecisionState, direction: Real) -> Real:
    """Side that the driver steers to, -1 right, 0 none yet, +1 left [-].

    Args:
        state: Of the decision.
        direction: Side that the driver means to change to [-].
    """
    steers = (state.phase == CHANGING) | (state.phase == RETURNING)
    return xp.select(steers, direction, 0.0)


@compiled
def time_to_crossing(state: DecisionState) -> Real:
    """Time until the planned path crosses the line [s]; negative after it.

    Half the planned duration after steering starts; infinite where nothing is
    planned.
    """
    half = state.change_duration / 2.0
    preparing = (state.phase == PREPARING) | (state.phase == PREPARING_RETURN)
    changing = (state.phase == CHANGING) | (state.phase == RETURNING)
    before = state.preparation_time + half - state.time_in_phase
    within = half - state.time_in_phase
    return xp.select(preparing, before, xp.select(changing, within, 1e9))


@compiled
def resumed(state: DecisionState, is_home: Flag) -> DecisionState:
    """After an emergency: cruising in the own lane, or passing in the other one."""
    calm = initial_state()
    phase = xp.select(is_home, CRUISING, PASSING)
    return calm._replace(phase=phase, change_duration=state.change_duration)
