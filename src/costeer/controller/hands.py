"""What the hands do beyond being carried along by the wheel.

Relaxed arms on a wheel that turns give a torque against it, their inertia and damping
times its motion: that is no will. What is left of the measured torque is the driver's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.sensing.measurement import Measurement


class HandsParameters(NamedTuple):
    """Two relaxed arms that rest on the wheel.

    Attributes:
        inertia: Of both about the wheel's axis [kg·m²]. Source: assumed, as the
            virtual drivers' mean (drivers/arm.py).
        damping: Of the relaxed muscles [N·m·s/rad]. Source: assumed, as above.
    """

    inertia: Real = 0.09
    damping: Real = 1.0


class HandsState(NamedTuple):
    """The wheel at the step before, NaN before the first.

    Attributes:
        steering_wheel_angle: [rad].
        steering_wheel_rate: [rad/s].
    """

    steering_wheel_angle: Real
    steering_wheel_rate: Real


@compiled
def initial_state() -> HandsState:
    """Nothing seen yet."""
    return HandsState(steering_wheel_angle=math.nan, steering_wheel_rate=math.nan)


@compiled
def step(
    parameters: HandsParameters,
    state: HandsState,
    measurement: Measurement,
    dt: Real,
) -> tuple[HandsState, Real]:
    """Return the state and the torque that relaxed arms do not explain [N·m].

    Both are means over the control step that ends now, as the measured torque is. At
    the first step, and after a lost sample, all of the torque counts.
    """
    angle, rate = measurement.steering_wheel_angle, measurement.steering_wheel_rate
    mean_rate = (angle - state.steering_wheel_angle) / dt
    acceleration = (rate - state.steering_wheel_rate) / dt
    passive = -parameters.inertia * acceleration - parameters.damping * mean_rate
    carried = xp.select(xp.isfinite(passive), passive, 0.0)
    seen = HandsState(steering_wheel_angle=angle, steering_wheel_rate=rate)
    return seen, measurement.driver_torque - carried
