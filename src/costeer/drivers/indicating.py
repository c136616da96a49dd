"""When a driver sets the indicator: at the onset of a lane change, late, or never.

In a simulator half of the drivers had it on when they began to steer, and nine of ten
within 1.5 to 2 s (Salvucci and Liu 2002, The time course of a lane change). On real
roads 60 % set it before, 33 % after the onset, and 7 % never (arXiv 2305.16401).
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.drivers.decision import NEVER, DecisionState


class IndicatorParameters(NamedTuple):
    """How a driver signals.

    Attributes:
        at_onset: Share of lane changes with the indicator on at their onset [-].
            Source: Salvucci and Liu (2002), 0.5.
        late_share: Of those that it comes on later in, how many within `late_time`
            [-]. Source: Salvucci and Liu (2002): 90 % of all, 0.8 of the rest.
        late_time: As above [s]. Source: Salvucci and Liu (2002), 1.5 to 2.
        never_share: Of lane changes without it [-]. Source: assumed, 0 in a simulator;
            0.07 on real roads.
    """

    at_onset: Real = 0.5
    late_share: Real = 0.8
    late_time: Real = 1.75
    never_share: Real = 0.0


class IndicatorState(NamedTuple):
    """What the hand at the lever remembers.

    Attributes:
        delay: From the onset of this lane change until it is set [s].
        time: Since the onset [s].
        side: That it is set to now, -1 right, 0 off, +1 left [-].
    """

    delay: Real
    time: Real
    side: Real


@compiled
def initial_state() -> IndicatorState:
    """Off."""
    return IndicatorState(delay=NEVER, time=0.0, side=0.0)


@compiled
def drawn_delay(parameters: IndicatorParameters, uniform: Real) -> Real:
    """From the onset of a lane change until the indicator is set [s].

    Nothing for `at_onset` of them, exponential for the others, so that `late_share` of
    those have it on after `late_time`; `NEVER` for a few.

    Args:
        parameters: Shares and time.
        uniform: In [0, 1).
    """
    never = uniform < parameters.never_share
    rest = xp.maximum(1.0 - parameters.never_share, 1e-9)
    place = (uniform - parameters.never_share) / rest
    late = xp.clip(
        (place - parameters.at_onset) / xp.maximum(1.0 - parameters.at_onset, 1e-9),
        0.0,
        1.0 - 1e-9,
    )
    rate = -xp.log(1.0 - xp.minimum(parameters.late_share, 0.999))
    delay = -parameters.late_time * xp.log(1.0 - late) / xp.maximum(rate, 1e-3)
    return xp.select(never, NEVER, delay)


@compiled
def step(
    parameters: IndicatorParameters,
    state: IndicatorState,
    decided: DecisionState,
    side: Real,
    uniform: Real,
    dt: Real,
) -> IndicatorState:
    """The indicator one control step later.

    Args:
        parameters: Of this driver.
        state: Of the hand.
        decided: When steering starts, and how long it is to last: it goes off then.
        side: That the driver steers to, 0 for none [-].
        uniform: In [0, 1), drawn if steering starts.
        dt: Control step [s].
    """
    delay = xp.when(decided.started, drawn_delay, (parameters, uniform), state.delay)
    time = xp.select(decided.started, 0.0, state.time + dt)
    on = (time >= delay) & (time < decided.change_duration)
    return IndicatorState(delay=delay, time=time, side=xp.select(on, side, 0.0))
