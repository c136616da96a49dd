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
