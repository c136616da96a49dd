"""The last word on the torque of a real wheel: limit, rate, fade, and nothing on fault.

The controller has limits of its own (controller/actuation.py); these stand between
everything that is rendered and the motor, and do not trust what they are given.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base.array import Real


class GuardParameters(NamedTuple):
    """What may reach the motor of a real wheel.

    Attributes:
        torque_limit: Largest torque [N·m]. Source: assumed, two hands hold it
            easily; a device that gives less lowers it.
        torque_rate_limit: Fastest change [N·m/s]. Source: assumed, 1.5 N·m·s/rad of
            damping in a brisk turn of 100 rad/s² pass it.
        fade_in: From nothing to everything at a start [s]. Source: assumed, a hand
            notices what comes.
        fade_out: From everything to nothing at a stop [s]. Source: assumed.
        fault_time: From the limit to nothing after a fault [s]. Source: promise of
            100 ms, less what it takes to notice.
    """

    torque_limit: Real = 8.0
    torque_rate_limit: Real = 200.0
    fade_in: Real = 1.0
    fade_out: Real = 0.3
    fault_time: Real = 0.04


class GuardState(NamedTuple):
    """What the guard remembers.

    Attributes:
        torque: Given at the step before [N·m].
        fade: Share of the torque that passes, 0 to 1 [-].
    """

    torque: Real = 0.0
    fade: Real = 0.0


def faded(parameters: GuardParameters, fade: Real, engaged: bool, dt: Real) -> Real:
    """The share of the torque that passes, one step later [-]."""
    if engaged:
        return min(1.0, fade + dt / parameters.fade_in)
    return max(0.0, fade - dt / parameters.fade_out)


def step(
    parameters: GuardParameters,
    state: GuardState,
    wanted: Real,
    engaged: bool,
    fault: bool,
    dt: Real,
) -> tuple[GuardState, Real]:
    """The torque that the wheel may give now [N·m].

    Args:
        parameters: Limits and times.
        state: Of the guard.
        wanted: What is to be rendered; not finite counts as a fault [N·m].
        engaged: Whether a trial runs; fades in and out.
        fault: Whether something is lost; the torque ends at once, and fades in anew.
        dt: Since the last step [s].
    """
    limit = parameters.torque_limit
    if fault or not math.isfinite(wanted):
        fade, target = 0.0, 0.0
        reach = limit / parameters.fault_time * dt
    else:
        fade = faded(parameters, state.fade, engaged, dt)
        target = fade * min(max(wanted, -limit), limit)
        reach = parameters.torque_rate_limit * dt
    torque = min(max(target, state.torque - reach), state.torque + reach)
    torque = min(max(torque, -limit), limit)
    return GuardState(torque=torque, fade=fade), torque
