"""Haptic gain: fade out when inconsistent, fade in when consistent (Eqs. (10)-(13))."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled


class StrengthParameters(NamedTuple):
    """Shape of the fade.

    Attributes:
        steepness: λ [1/s]. Source: paper, 4.
        midpoint: γ, half of the fade is done then [s]. Source: paper, 1.
    """

    steepness: Real = 4.0
    midpoint: Real = 1.0


class StrengthState(NamedTuple):
    """What the fade remembers.

    Attributes:
        consistent: Verdict of the step before.
        time_in_verdict: t of Eqs. (10) and (11) [s].
        gain_at_switch: K_shifting, gain when the verdict last changed [-].
        gain: K_h of the step before [-].
    """

    consistent: Flag
    time_in_verdict: Real
    gain_at_switch: Real
    gain: Real


@compiled
def initial_state() -> StrengthState:
    """Full gain, consistent."""
    return StrengthState(
        consistent=True, time_in_verdict=0.0, gain_at_switch=1.0, gain=1.0
    )


@compiled
def haptic_gain(
    parameters: StrengthParameters,
    consistent: Flag,
    time_in_verdict: Real,
    gain_at_switch: Real,
) -> Real:
    """Gain K_h in one verdict: Eq. (11) if consistent, else Eq. (10).

    Args:
        parameters: λ and γ.
        consistent: The verdict.
        time_in_verdict: Since it changed [s].
        gain_at_switch: K_shifting [-].
    """
    elapsed = time_in_verdict - parameters.midpoint
    progress = (1.0 + xp.tanh(parameters.steepness * elapsed)) / 2.0
    final = xp.select(consistent, 1.0, 0.0)
    return gain_at_switch + (final - gain_at_switch) * progress


@compiled
def step(
    parameters: StrengthParameters, state: StrengthState, consistent: Flag, dt: Real
) -> tuple[StrengthState, Real]:
    """Advance the fade by one control step `dt` [s]; return the state and K_h [-]."""
    switched = consistent != state.consistent
    gain_at_switch = xp.select(switched, state.gain, state.gain_at_switch)
    time_in_verdict = xp.select(switched, 0.0, state.time_in_verdict + dt)
    gain = haptic_gain(parameters, consistent, time_in_verdict, gain_at_switch)
    new_state = StrengthState(
        consistent=consistent,
        time_in_verdict=time_in_verdict,
        gain_at_switch=gain_at_switch,
        gain=gain,
    )
    return new_state, gain
