"""Linear filters with one or two states, discretised exactly where it is cheap."""

from __future__ import annotations

from costeer.base import array as xp
from costeer.base.array import Real, compiled


@compiled
def decay(dt: Real, time_constant: Real) -> Real:
    """Share of a first-order state that is left after `dt` [s]: exp(-dt / T)."""
    return xp.exp(-dt / time_constant)


@compiled
def low_pass(state: Real, value: Real, dt: Real, time_constant: Real) -> Real:
    """First-order lag 1 / (1 + T s), exact for an input held over `dt` [s]."""
    return value + (state - value) * decay(dt, time_constant)


@compiled
def coloured_noise(
    state: Real, normal: Real, deviation: Real, dt: Real, time_constant: Real
) -> Real:
    """Next value of an Ornstein-Uhlenbeck process, exact for any `dt` [s].

    Args:
        state: Its value now.
        normal: A draw from the standard normal distribution.
        deviation: Standard deviation it settles to, in its own unit.
        dt: Step [s].
        time_constant: Its correlation decays by e in this time [s].
    """
    kept = decay(dt, time_constant)
    return kept * state + deviation * xp.sqrt(1.0 - kept * kept) * normal


@compiled
def pade_delay(state: Real, value: Real, delay: Real, dt: Real) -> tuple[Real, Real]:
    """First-order Pade delay (1 - T s / 2) / (1 + T s / 2), bilinear in `dt` [s].

    An all-pass: it changes no amplitude, and slow signals come out exactly `delay`
    later. The state of a signal at rest at x is 2 x delay / (delay + dt). A jump
    comes out with a first step the wrong way.

    Args:
        state: Its memory, in the unit of the value.
        value: Now.
        delay: T, longer than `dt` [s].
        dt: Step [s].

    Returns:
        New state and delayed value.
    """
    share = (dt - delay) / (dt + delay)
    delayed = state + share * value
    return value - share * delayed, delayed
