"""Decision to overtake and to return: when, how long, with a glance or without."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
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
        return_distance: Distance ahead of the leader at which the return is decided
            [m]. Source: assumed, spread over the population.
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
        settling_time: Pause after a lane change before the next decision [s].
            Source: assumed.
    """

    decides: Real = 1.0
    headway: Real = 2.3
    return_distance: Real = 28.0
    change_duration: Real = 6.9
    change_duration_spread: Real = 0.17
    preparation_time: Real = 2.0
    return_preparation_time: Real = 0.7
    preparation_spread: Real = 0.35
    glance_share: Real = 0.84
    settling_time: Real = 1.0


class DecisionState(NamedTuple):
    """What the driver is up to.

    Attributes:
        phase: One of the phases of this file [-].
        time_in_phase: [s].
        preparation_time: From this decision until steering [s].
        change_duration: Planned for this lane change [s].
        looks: Whether this driver looks before this change.
        started: Whether steering starts at this step.
        decided: Whether the decision fell at this step.
    """

    phase: Real
    time_in_phase: Real
    preparation_time: Real
    change_duration: Real
    looks: Flag
    started: Flag
    decided: Flag


class Draws(NamedTuple):
    """Random numbers of one control step for a decision that may fall.

    Attributes:
        duration_normal: Standard normal, planned duration.
        preparation_normal: Standard normal, preparation time.
        glance_uniform: In [0, 1), whether there is a glance.
    """

    duration_normal: Real
    preparation_normal: Real
    glance_uniform: Real


@compiled
def initial_state() -> DecisionState:
    """Cruising."""
    return DecisionState(
        phase=CRUISING,
        time_in_phase=0.0,
        preparation_time=0.0,
        change_duration=6.0,
        looks=False,
        started=False,
        decided=False,
    )


@compiled
def wants_to_overtake(
    parameters: DecisionParameters, measurement: Measurement, leader: LeaderState
) -> Flag:
    """Whether a slower leader in the own lane has come close enough."""
    gap = leader.longitudinal_position - measurement.longitudinal_position
    slower = leader.longitudinal_velocity < measurement.longitudinal_velocity + 0.5
    close = (gap > 0.0) & (gap < parameters.headway * measurement.longitudinal_velocity)
    ahead = leader.present & (leader.lane == measurement.lane)
    return ahead & slower & close & (parameters.decides > 0.5)


@compiled
def wants_to_return(
    parameters: DecisionParameters, measurement: Measurement, leader: LeaderState
) -> Flag:
    """Whether the leader is far enough behind."""
    lead = measurement.longitudinal_position - leader.longitudinal_position
    return xp.logical_not(leader.present) | (lead > parameters.return_distance)


@compiled
def next_phase(
    parameters: DecisionParameters,
    state: DecisionState,
    measurement: Measurement,
    leader: LeaderState,
) -> Real:
    """Phase after this step [-]."""
    time = state.time_in_phase
    prepared = time >= state.preparation_time
    settled = time >= state.change_duration + parameters.settling_time
    overtake = wants_to_overtake(parameters, measurement, leader)
    back = wants_to_return(parameters, measurement, leader)
    phase = state.phase
    done = (
        ((phase == CRUISING) & overtake)
        | ((phase == PREPARING) & prepared)
        | ((phase == CHANGING) & settled)
        | ((phase == PASSING) & back)
        | ((phase == PREPARING_RETURN) & prepared)
    )
    home = (phase == RETURNING) & settled
    return xp.select(home, CRUISING, xp.select(done, phase + 1.0, phase))


@compiled
def step(
    parameters: DecisionParameters,
    state: DecisionState,
    measurement: Measurement,
    leader: LeaderState,
    draws: Draws,
    dt: Real,
) -> DecisionState:
    """Decide for one step.

    Args:
        parameters: Of this driver.
        state: What the driver is up to.
        measurement: Where the car is and how fast.
        leader: The car ahead.
        draws: Random numbers of this step, used if a decision falls.
        dt: Control step [s].
    """
    phase = next_phase(parameters, state, measurement, leader)
    new = phase != state.phase
    decided = new & ((phase == PREPARING) | (phase == PREPARING_RETURN))
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
    looks = draws.glance_uniform < parameters.glance_share
    return DecisionState(
        phase=phase,
        time_in_phase=xp.select(new, 0.0, state.time_in_phase + dt),
        preparation_time=xp.select(decided, preparation, state.preparation_time),
        change_duration=xp.select(decided, duration, state.change_duration),
        looks=xp.select(decided, looks, state.looks),
        started=new & ((phase == CHANGING) | (phase == RETURNING)),
        decided=decided,
    )


@compiled
def direction(state: DecisionState, overtaking_side: Real) -> Real:
    """Side that the driver means to change to, -1 right, 0 none, +1 left [-]."""
    out = (state.phase == PREPARING) | (state.phase == CHANGING)
    back = (state.phase == PREPARING_RETURN) | (state.phase == RETURNING)
    inward = xp.select(back, -overtaking_side, 0.0)
    return xp.select(out, overtaking_side, inward)


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
