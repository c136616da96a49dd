"""Integration of ordinary differential equations by fixed steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from costeer.base.array import Real, add_scaled, compiled

State = TypeVar("State")
Arguments = TypeVar("Arguments")


@compiled
def rk4(
    derivative: Callable[[State, Arguments], State],
    state: State,
    arguments: Arguments,
    dt: Real,
) -> State:
    """Advance a named tuple of `Real`s by `dt` [s], classical Runge-Kutta.

    Args:
        derivative: Rate of each field, in a tuple of the same kind.
        state: At the start of the step.
        arguments: Held over the step.
        dt: Step [s]; the error over a fixed time shrinks with its fourth power.
    """
    k1 = derivative(state, arguments)
    k2 = derivative(add_scaled(state, k1, dt / 2.0), arguments)
    k3 = derivative(add_scaled(state, k2, dt / 2.0), arguments)
    k4 = derivative(add_scaled(state, k3, dt), arguments)
    state = add_scaled(state, k1, dt / 6.0)
    state = add_scaled(state, k2, dt / 3.0)
    state = add_scaled(state, k3, dt / 3.0)
    return add_scaled(state, k4, dt / 6.0)
