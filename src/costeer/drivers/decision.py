"""Decision to overtake and to return: when, how long, with a glance or without.

A driver overtakes when a slower leader is close and either slow enough to be worth it
or has been in the way for longer than the driver's patience; a leader that is not
slower than the driver wants to be is followed.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.drivers.overtaking import (
    DecisionParameters,
    Surroundings,
    accepts,
    in_the_way,
    is_worth_overtaking,
    is_worth_returning,
    wants_to_overtake,
    wants_to_return,
)

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
    back = back & is_worth_returning(parameters, around) & (around.asked < 0.5)
    back = back | (around.asked < -0.5)
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
