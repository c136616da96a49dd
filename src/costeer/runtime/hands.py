"""Virtual hands and foot for a keyboard or a gamepad.

A key does not turn the wheel. It moves the intended angle of two arms
(drivers/arm.py) that hold the wheel and feel the guidance, so the wheel on the screen
turns under them. Released, the hands rest on the rim and follow it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base.array import Real
from costeer.plant.parameters import CarParameters, steady_steering_wheel_angle
from costeer.plant.vehicle import resistance


class HandsParameters(NamedTuple):
    """How keys become an intended angle.

    Attributes:
        lateral_acceleration: That a key held down asks for in the end [m/s²]. Source:
            assumed, a brisk lane change.
        largest_angle: Of the wheel that is ever asked for [rad]. Source: assumed,
            both hands stay on the rim.
        steering_time: Time constant towards the asked angle [s]. Source: assumed, a
            tap of 0.2 s is half of it.
        grip_time: Time constant of gripping and letting go [s]. Source: assumed.
    """

    lateral_acceleration: Real = 2.5
    largest_angle: Real = 2.0
    steering_time: Real = 0.25
    grip_time: Real = 0.10


class HandsState(NamedTuple):
    """What the hands remember.

    Attributes:
        intended_angle: Of the steering wheel [rad].
        grip: 0 resting to 1 steering [-].
    """

    intended_angle: Real = 0.0
    grip: Real = 0.0


def asked_angle(
    parameters: HandsParameters, car: CarParameters, speed: Real, steer: Real
) -> Real:
    """Angle that a key or stick asks for at this speed [rad].

    Args:
        parameters: Acceleration and largest angle.
        car: Whose steady cornering it is.
        speed: [m/s].
        steer: -1 right to +1 left [-].
    """
    moving = max(speed, 3.0)
    curvature = parameters.lateral_acceleration / (moving * moving)
    angle = steady_steering_wheel_angle(car, moving, curvature)
    return steer * min(angle, parameters.largest_angle)


def step(
    parameters: HandsParameters,
    state: HandsState,
    asked: Real,
    steering: bool,
    steering_wheel_angle: Real,
    dt: Real,
) -> HandsState:
    """The hands one control step later.

    Args:
        parameters: Times.
        state: Of the hands.
        asked: Angle that is asked for [rad].
        steering: Whether a key is down; else the hands follow the wheel.
        steering_wheel_angle: Now [rad].
        dt: Control step [s].
    """
    target = asked if steering else steering_wheel_angle
    towards = 1.0 - math.exp(-dt / parameters.steering_time)
    gripping = 1.0 - math.exp(-dt / parameters.grip_time)
    angle = state.intended_angle + towards * (target - state.intended_angle)
    if not steering and state.grip < 0.01:
        angle = steering_wheel_angle
    grip = state.grip + gripping * ((1.0 if steering else 0.0) - state.grip)
    return HandsState(intended_angle=angle, grip=grip)


class FootParameters(NamedTuple):
    """The foot that keeps the speed while no pedal is pressed.

    Attributes:
        speed_gain: Acceleration per lacking speed [1/s]. Source: assumed, the gap to
            a new speed halves in 1.7 s.
        dead_band: Pedal positions below it are no press [-]. Source: assumed, pots
            of consumer pedals rest at up to 0.02.
    """

    speed_gain: Real = 0.4
    dead_band: Real = 0.03


class FootState(NamedTuple):
    """What the foot remembers.

    Attributes:
        kept_speed: That it keeps; NaN if it keeps none [m/s].
    """

    kept_speed: Real = math.nan


def press(
    parameters: FootParameters,
    state: FootState,
    car: CarParameters,
    speed: Real,
    pedals: tuple[Real, Real],
) -> tuple[FootState, Real, Real]:
    """Accelerator and brake of this control step, in [0, 1] [-].

    A pressed pedal acts as it is, and its release keeps the speed reached.

    Args:
        parameters: Of the foot.
        state: Speed to keep.
        car: Whose resistance is to be overcome.
        speed: Now [m/s].
        pedals: Accelerator and brake as pressed [-].
    """
    accelerator, brake = pedals
    pressed = max(accelerator, brake) > parameters.dead_band
    if math.isnan(state.kept_speed):
        return state, accelerator, brake
    if pressed:
        return FootState(kept_speed=speed), accelerator, brake
    wanted = parameters.speed_gain * (state.kept_speed - speed) + resistance(car, speed)
    push = min(max(wanted / car.acceleration_limit, 0.0), 1.0)
    slow = min(max(-wanted / car.braking_limit, 0.0), 1.0)
    return state, push, slow
