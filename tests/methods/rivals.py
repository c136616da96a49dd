"""Rivals of the paper's method: the example of the docs, and what is wrong with others.

Only the example is compiled; all tests share it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller.signals import Assistance, Request
from costeer.methods.interface import Method
from costeer.methods.registry import AnyMethod, method_named
from costeer.sensing.measurement import Measurement

FILE = Path(__file__).parents[2] / "examples" / "methods" / "pi_keeping.py"


def example() -> AnyMethod:
    return method_named(str(FILE))


class Memory(NamedTuple):
    """The last of something."""

    last: Any  # Any: a number of the wrong kind, too


class Gain(NamedTuple):
    """One gain."""

    gain: Any  # Any: as above


Law = Callable[[Any, Memory, Measurement, Request, Real], Any]


def rival(law: Law, gain: Any = 1.0, last: Any = 0.0) -> AnyMethod:
    """A method of one gain and one number of memory, which obeys a law."""
    return Method(
        name="rival",
        version="1",
        source="a test",
        parameters=lambda condition, car, column, road: Gain(gain),
        initial_state=lambda parameters, lane: Memory(last),
        step=law,
    )


def torque(value: Real) -> Assistance:
    return Assistance(applied_torque=value)


def damping(
    given: Any, state: Memory, seen: Measurement, request: Request, dt: Real
) -> Any:
    """Sound: torque against the wheel's rate, which it remembers."""
    return Memory(seen.steering_wheel_rate), torque(
        -given.gain * math.tanh(seen.steering_wheel_rate)
    )


def not_a_number(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    return state, torque(math.nan if seen.steering_wheel_rate > 0.5 else 0.0)


def too_strong(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    return state, torque(-50.0 * seen.steering_wheel_rate)


def one_sided(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    return state, torque(max(0.0, math.tanh(seen.steering_wheel_rate)))


_SECRET = [0.0]


def forgetful(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    """Remembers outside its state."""
    _SECRET[0] += 0.001
    return state, torque(math.tanh(_SECRET[0]) * math.tanh(seen.steering_wheel_rate))


def in_place(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    values: NDArray[np.float64] = state.last
    values[0] = seen.steering_wheel_rate
    return Memory(values), torque(0.0)


def breaking(given: Any, state: Memory, seen: Measurement, *_: Any) -> Any:
    if seen.yaw_angle > 0.05:
        raise RuntimeError("too far")
    return state, torque(0.0)
