"""Motion of a rim with inertia, damping and Coulomb friction, in closed form."""

from __future__ import annotations

import math
from typing import NamedTuple


class Rim(NamedTuple):
    """What resists a torque at the rim.

    Attributes:
        inertia: J [kg·m²].
        damping: B [N·m·s/rad].
        friction: Coulomb friction F [N·m].
    """

    inertia: float
    damping: float
    friction: float


def moved(rim: Rim, rate: float, torque: float, dt: float) -> tuple[float, float]:
    """Angle that the rim turns by in `dt` [rad], and its rate afterwards [rad/s].

    The solution of J ω' = τ - B ω - F sign(ω) under a constant torque: the rim slows
    down, may stop within the step, and then stays or goes back.

    Args:
        rim: What resists.
        rate: At the start [rad/s].
        torque: Of motor and hands [N·m].
        dt: Time [s].
    """
    if rate == 0.0:
        return _from_rest(rim, torque, dt)
    pull = torque - math.copysign(rim.friction, rate)
    stop = _time_to_stop(rim, rate, pull)
    if stop >= dt:
        return _glide(rim, rate, pull, dt)
    until, _ = _glide(rim, rate, pull, stop)
    beyond, last = _from_rest(rim, torque, dt - stop)
    return until + beyond, last


def _from_rest(rim: Rim, torque: float, dt: float) -> tuple[float, float]:
    """Motion of a rim that stands: friction holds what is not stronger."""
    if abs(torque) <= rim.friction:
        return 0.0, 0.0
    return _glide(rim, 0.0, torque - math.copysign(rim.friction, torque), dt)


def _glide(rim: Rim, rate: float, pull: float, dt: float) -> tuple[float, float]:
    """Motion without a stop: J ω' = pull - B ω."""
    if rim.damping == 0.0:
        gained = pull / rim.inertia * dt
        return (rate + gained / 2.0) * dt, rate + gained
    final = pull / rim.damping
    faded = -math.expm1(-rim.damping / rim.inertia * dt)
    turned = final * dt + (rate - final) * rim.inertia / rim.damping * faded
    return turned, rate + (final - rate) * faded


def _time_to_stop(rim: Rim, rate: float, pull: float) -> float:
    """When the rate becomes zero [s]; infinite if never."""
    # No product: that of two tiny values is zero.
    if pull == 0.0 or (pull > 0.0) == (rate > 0.0):
        return math.inf
    if rim.damping == 0.0:
        return -rate * rim.inertia / pull
    return rim.inertia / rim.damping * math.log1p(-rate * rim.damping / pull)
