"""Head yaw: looks to the mirror and over the shoulder before a lane change, or none.

A look that is due waits until the glance under way is over: the head does not jump.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.filters import coloured_noise
from costeer.drivers.decision import (
    CHANGING,
    PREPARING,
    PREPARING_RETURN,
    RETURNING,
    DecisionState,
)


class GazeParameters(NamedTuple):
    """How often and how far the head turns.

    Attributes:
        false_rate: Glances to one side without a lane change [1/s]. Source: Jain et
            al. (2015): 15 % of 6 s of straight driving have one to a given side.
        repeat_rate: Further glances to that side before the line is crossed [1/s].
            Source: assumed.
        amplitude: Median head yaw of a glance to a mirror, over 90 deg [-]. Source:
            assumed, 0.45 rad; glances above 0.25 to 0.3 rad are counted.
        amplitude_spread: Standard deviation of its logarithm [-]. Source: assumed.
        shoulder_ratio: Head yaw over the shoulder over that to a mirror [-]. Source:
            assumed.
        shoulder_lead: The look over the shoulder begins so long before steering, or
            as soon as the head is free [s]. Source: assumed.
        duration: Of a glance [s]. Source: assumed, mirror glances last about 1 s.
        turning_time: Of the head to the side, and back [s]. Source: assumed.
        drift_deviation: Standard deviation of the head's slow drift [-]. Source:
            assumed.
        drift_time: Its correlation time [s]. Source: assumed.
    """

    false_rate: Real = 0.027
    repeat_rate: Real = 0.25
    amplitude: Real = 0.29
    amplitude_spread: Real = 0.2
    shoulder_ratio: Real = 2.0
    shoulder_lead: Real = 0.8
    duration: Real = 1.1
    turning_time: Real = 0.3
    drift_deviation: Real = 0.025
    drift_time: Real = 3.0


class GazeState(NamedTuple):
    """What the head is doing.

    Attributes:
        glancing: Whether a glance is under way.
        time_in_glance: [s].
        side: Of the glance, -1 right, +1 left [-].
        amplitude: Of the glance [-].
        drift: Slow drift of the head [-].
        mirror_due: Whether a decided look to the mirror has not begun yet.
        shoulder_due: Whether one over the shoulder has not.
    """

    glancing: Flag
    time_in_glance: Real
    side: Real
    amplitude: Real
    drift: Real
    mirror_due: Flag
    shoulder_due: Flag


class Looks(NamedTuple):
    """Looks that belong to a decision.

    Attributes:
        mirror: Whether one to the mirror is due, or begins.
        shoulder: Whether one over the shoulder is.
    """

    mirror: Flag
    shoulder: Flag


class GazeDraws(NamedTuple):
    """Random numbers of one control step.

    Attributes:
        start_uniform: In [0, 1), whether a glance starts by itself.
        side_uniform: In [0, 1), its side.
        amplitude_normal: Standard normal, how far.
        drift_normal: Standard normal, slow drift.
    """

    start_uniform: Real
    side_uniform: Real
    amplitude_normal: Real
    drift_normal: Real


@compiled
def initial_state() -> GazeState:
    """Straight ahead."""
    return GazeState(
        glancing=False,
        time_in_glance=0.0,
        side=1.0,
        amplitude=0.0,
        drift=0.0,
        mirror_due=False,
        shoulder_due=False,
    )


@compiled
def head_yaw(parameters: GazeParameters, state: GazeState) -> Real:
    """Head yaw in [-1, 1] [-]: raised-cosine turns there and back, and drift."""
    turn = parameters.turning_time
    there = xp.clip(state.time_in_glance / turn, 0.0, 1.0)
    back = xp.clip((parameters.duration - state.time_in_glance) / turn, 0.0, 1.0)
    share = xp.minimum(there, back)
    pulse = 0.5 - 0.5 * xp.cos(3.141592653589793 * share)
    glance = xp.select(state.glancing, state.side * state.amplitude * pulse, 0.0)
    return xp.clip(glance + state.drift, -1.0, 1.0)


@compiled
def before_line(decision: DecisionState) -> Flag:
    """Whether a lane change is planned and a look would still be before its line."""
    preparing = (decision.phase == PREPARING) | (decision.phase == PREPARING_RETURN)
    changing = (decision.phase == CHANGING) | (decision.phase == RETURNING)
    early = decision.time_in_phase < 0.4 * decision.change_duration
    return preparing | (changing & early)


@compiled
def start_probability(
    parameters: GazeParameters, decision: DecisionState, direction: Real, dt: Real
) -> Real:
    """Probability that a glance starts by itself within one step [-].

    Args:
        parameters: Rates.
        decision: What the driver is up to.
        direction: Side that the driver means to change to, 0 for none [-].
        dt: Control step [s].
    """
    looking = before_line(decision) & decision.looks
    silent = xp.select(direction == 0.0, 2.0 * parameters.false_rate, 0.0)
    return dt * xp.select(looking, parameters.repeat_rate, silent)


@compiled
def due(state: GazeState, decision: DecisionState) -> Looks:
    """Looks that a decision asks for and that have not begun yet."""
    ahead = before_line(decision)
    mirror = state.mirror_due | (decision.decided & decision.looks)
    shoulder = state.shoulder_due | (decision.decided & decision.looks_over_shoulder)
    return Looks(mirror=mirror & ahead, shoulder=shoulder & ahead)


@compiled
def begin(
    parameters: GazeParameters, waiting: Looks, decision: DecisionState, free: Flag
) -> Looks:
    """Which of the looks that are due begin now; the mirror comes first.

    Args:
        parameters: When the look over the shoulder comes.
        waiting: Looks that are due.
        decision: What the driver is up to.
        free: Whether no glance is under way.
    """
    preparing = (decision.phase == PREPARING) | (decision.phase == PREPARING_RETURN)
    left = decision.preparation_time - decision.time_in_phase
    soon = xp.logical_not(preparing) | (left <= parameters.shoulder_lead)
    mirror = free & waiting.mirror
    shoulder = free & waiting.shoulder & soon & xp.logical_not(waiting.mirror)
    return Looks(mirror=mirror, shoulder=shoulder)


@compiled
def step(
    parameters: GazeParameters,
    state: GazeState,
    decision: DecisionState,
    direction: Real,
    draws: GazeDraws,
    dt: Real,
) -> GazeState:
    """Turn the head for one step.

    Args:
        parameters: Of the head.
        state: What it is doing.
        decision: What the driver is up to.
        direction: Side that the driver means to change to, 0 for none [-].
        draws: Random numbers of this step.
        dt: Control step [s].
    """
    time = state.time_in_glance + dt
    glancing = state.glancing & (time < parameters.duration)
    waiting = due(state, decision)
    begun = begin(parameters, waiting, decision, xp.logical_not(glancing))
    chance = start_probability(parameters, decision, direction, dt)
    by_itself = xp.logical_not(glancing) & (draws.start_uniform < chance)
    starts = begun.mirror | begun.shoulder | by_itself
    any_side = xp.select(draws.side_uniform < 0.5, -1.0, 1.0)
    side = xp.select(direction == 0.0, any_side, direction)
    size = parameters.amplitude * xp.exp(
        parameters.amplitude_spread * draws.amplitude_normal
    )
    size = size * xp.select(begun.shoulder, parameters.shoulder_ratio, 1.0)
    return GazeState(
        glancing=glancing | starts,
        time_in_glance=xp.select(starts, 0.0, time),
        side=xp.select(starts, side, state.side),
        amplitude=xp.select(starts, size, state.amplitude),
        drift=coloured_noise(
            state.drift,
            draws.drift_normal,
            parameters.drift_deviation,
            dt,
            parameters.drift_time,
        ),
        mirror_due=waiting.mirror & xp.logical_not(begun.mirror),
        shoulder_due=waiting.shoulder & xp.logical_not(begun.shoulder),
    )
