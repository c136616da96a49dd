"""Applied torque and its limits (Eq. (6), Table IV)."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.controller.signals import Guidance

STRONG = 1.0
"""Strength factor of the strong condition, Table IV."""

WEAK = 0.4
"""Strength factor of the weak condition, Table IV."""


class ActuationParameters(NamedTuple):
    """What may reach the motor.

    Attributes:
        strength_factor: On K_h [-]. Source: paper, Table IV, strong 1, weak 0.4.
        torque_limit: Largest torque [N·m]. Source: assumed, one hand holds it.
        torque_rate_limit: Fastest change [N·m/s]. Source: assumed, so that a change
            of mode is no jump; it does not bind within a lane change.
        fault_rate_limit: Fastest fall when the instruction is not finite [N·m/s].
            Source: assumed, from the limit to nothing within 40 ms, so that the
            motor's lag is over within 100 ms too.
    """

    strength_factor: Real = STRONG
    torque_limit: Real = 5.0
    torque_rate_limit: Real = 30.0
    fault_rate_limit: Real = 125.0


class ActuationState(NamedTuple):
    """What the limits remember.

    Attributes:
        applied_torque: Of the step before [N·m].
    """

    applied_torque: Real


@compiled
def initial_state() -> ActuationState:
    """No torque."""
    return ActuationState(applied_torque=0.0)


@compiled
def applied_torque(
    parameters: ActuationParameters, haptic_gain: Real, instructed_torque: Real
) -> Real:
    """tau_hapa, Eq. (6): gain and strength, held within the limit [N·m].

    Args:
        parameters: Strength factor and limit.
        haptic_gain: K_h [-].
        instructed_torque: tau_hapi [N·m]; no torque if it is not finite.
    """
    torque = parameters.strength_factor * haptic_gain * instructed_torque
    limit = parameters.torque_limit
    return xp.select(xp.isfinite(torque), xp.clip(torque, -limit, limit), 0.0)


@compiled
def felt_instruction(guidance: Guidance, driver_torque: Real) -> Real:
    """The instruction while the driver can be felt, else NaN: no torque [N·m].

    Without the driver's torque no conflict would be seen, and the gain would stay.

    Args:
        guidance: With tau_hapi.
        driver_torque: tau_dr, not finite if its sensor is lost [N·m].
    """
    return xp.select(xp.isfinite(driver_torque), guidance.instructed_torque, math.nan)


@compiled
def step(
    parameters: ActuationParameters,
    state: ActuationState,
    haptic_gain: Real,
    instructed_torque: Real,
    dt: Real,
) -> tuple[ActuationState, Real]:
    """Apply Eq. (6) and the rate limit; return the state and the torque [N·m].

    Args:
        parameters: Strength and limits.
        state: Torque of the step before.
        haptic_gain: K_h [-].
        instructed_torque: tau_hapi [N·m].
        dt: Control step [s].
    """
    wanted = applied_torque(parameters, haptic_gain, instructed_torque)
    rate = xp.select(
        xp.isfinite(haptic_gain * instructed_torque),
        parameters.torque_rate_limit,
        parameters.fault_rate_limit,
    )
    reach = rate * dt
    before = state.applied_torque
    torque = xp.clip(wanted, before - reach, before + reach)
    return ActuationState(applied_torque=torque), torque
