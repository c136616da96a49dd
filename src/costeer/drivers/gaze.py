"""Head yaw: glances to the mirrors before a lane change and without one."""

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
        amplitude: Median head yaw of a glance over 90 deg [-]. Source: assumed, 0.45
            rad, glances above 0.25 to 0.3 rad are counted.
        amplitude_spread: Standard deviation of its logarithm [-]. Source: assumed.
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
    """

    glancing: Flag
    time_in_glance: Real
    side: Real
    amplitude: Real
    drift: Real


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
        glancing=False, time_in_glance=0.0, side=1.0, amplitude=0.0, drift=0.0
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
def start_probability(
    parameters: GazeParameters, decision: DecisionState, dt: Real
) -> Real:
    """Probability that a glance starts by itself within one step [-]."""
    before_line = decision.time_in_phase < 0.4 * decision.change_duration
    preparing = (decision.phase == PREPARING) | (decision.phase == PREPARING_RETURN)
    changing = (decision.phase == CHANGING) | (decision.phase == RETURNING)
    looking = (preparing | (changing & before_line)) & decision.looks
    quiet = xp.logical_not(preparing | changing)
    silent = xp.select(quiet, 2.0 * parameters.false_rate, 0.0)
    return dt * xp.select(looking, parameters.repeat_rate, silent)


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
    by_itself = draws.start_uniform < start_probability(parameters, decision, dt)
    first = decision.decided & decision.looks
    starts = first | (by_itself & xp.logical_not(glancing))
    any_side = xp.select(draws.side_uniform < 0.5, -1.0, 1.0)
    side = xp.select(direction == 0.0, any_side, direction)
    size = parameters.amplitude * xp.exp(
        parameters.amplitude_spread * draws.amplitude_normal
    )
    drift = coloured_noise(
        state.drift,
        draws.drift_normal,
        parameters.drift_deviation,
        dt,
        parameters.drift_time,
    )
    return GazeState(
        glancing=glancing | starts,
        time_in_glance=xp.select(starts, 0.0, time),
        side=xp.select(starts, side, state.side),
        amplitude=xp.select(starts, size, state.amplitude),
        drift=drift,
    )
