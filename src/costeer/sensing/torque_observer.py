"""Driver's torque on a wheel that does not measure it: a momentum observer.

What the motor, damping, stiffness and friction do not explain of the change of the
wheel's momentum, the driver did. For the device by itself,

    inertia · rate' = driver + motor - damping · rate - stiffness · angle - friction,

the unexplained torque passes a lag of first order, so no acceleration is ever formed
by itself. A wheel that tells no rate gets one from its angle through a second lag,
which the other signals then pass as well: the model stays exact, only slower.

Friction is known while the wheel moves and is anything up to its size at rest. There
the estimate is the torque nearest to the last one that agrees with a still wheel, and
it moves slowly to the middle of those that do: no other has a smaller largest error,
which is the friction. A sign of the rate would chatter at rest.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled

_STAGES = 4.0


class TorqueObserverParameters(NamedTuple):
    """The device by itself, and how fast the estimate is.

    Attributes:
        inertia: Of the device without hands [kg·m²]. Source: assumed; the self-test of
            the device gives its own, here and in the next three.
        damping: The same [N·m·s/rad]. Source: assumed.
        stiffness: Pull towards straight ahead that no motor makes [N·m/rad]. Source:
            assumed, a device has none.
        friction: Its Coulomb friction [N·m]. Source: assumed.
        latency: From a command to the first movement that is read [s]. Source:
            assumed, none; the self-test measures it.
        time_constant: T of the estimate [s]. Source: assumed, 8 Hz, above what arms do
            and below what 16 bits of angle make noisy.
        rate_time_constant: The same of a rate made of angles [s]. Source: assumed.
        still_rate: Below it a wheel may be at rest [rad/s]. Source: assumed, about the
            rate that one step of a 16-bit axis makes.
        rest_time: In which the estimate of a still wheel forgets how it came to rest
            [s]. Source: assumed, least error on simulated wheels that virtual drivers
            hold; see benchmarks/torque_observer.py.
    """

    inertia: Real = 0.03
    damping: Real = 0.05
    stiffness: Real = 0.0
    friction: Real = 0.15
    latency: Real = 0.0
    time_constant: Real = 0.02
    rate_time_constant: Real = 0.01
    still_rate: Real = 0.015
    rest_time: Real = 0.1


class WheelMotion(NamedTuple):
    """What is known of the wheel at one reading.

    Attributes:
        steering_wheel_angle: Positive to the left [rad].
        steering_wheel_rate: Its time derivative [rad/s]; NaN if the device tells none.
        motor_torque: Sent to the wheel since the reading before [N·m].
    """

    steering_wheel_angle: Real
    steering_wheel_rate: Real
    motor_torque: Real


class DelayedTorque(NamedTuple):
    """Motor torque after each of four equal lags, oldest command last.

    Attributes:
        first: After one lag [N·m].
        second: After two [N·m].
        third: After three [N·m].
        fourth: As the wheel felt it in the reading [N·m].
    """

    first: Real
    second: Real
    third: Real
    fourth: Real


class TorqueObserverState(NamedTuple):
    """What the observer remembers.

    Attributes:
        estimated_driver_torque: The result [N·m].
        steering_wheel_angle: Of the last reading [rad].
        smooth_angle: After the lag of a rate made of angles [rad].
        steering_wheel_rate: The same [rad/s].
        smooth_torque: The same, of the motor [N·m].
        delayed: Motor torque on its way to a reading.
    """

    estimated_driver_torque: Real
    steering_wheel_angle: Real
    smooth_angle: Real
    steering_wheel_rate: Real
    smooth_torque: Real
    delayed: DelayedTorque


@compiled
def initial_state(
    steering_wheel_angle: Real = 0.0, steering_wheel_rate: Real = 0.0
) -> TorqueObserverState:
    """No torque of driver or motor, at an angle [rad] and a rate [rad/s]."""
    return TorqueObserverState(
        estimated_driver_torque=0.0,
        steering_wheel_angle=steering_wheel_angle,
        smooth_angle=steering_wheel_angle,
        steering_wheel_rate=steering_wheel_rate,
        smooth_torque=0.0,
        delayed=DelayedTorque(0.0, 0.0, 0.0, 0.0),
    )


@compiled
def lagged(value: Real, before: Real, keep: Real) -> Real:
    """One step of a lag of first order; `keep` is the share of `before` [-]."""
    return value + (before - value) * keep


@compiled
def delayed_torque(
    latency: Real, before: DelayedTorque, torque: Real, dt: Real
) -> DelayedTorque:
    """Four equal lags whose delays add up to the latency [s], one step of `dt` [s].

    A ramp comes out late by exactly the latency; without latency nothing is held back.
    """
    stage = latency / _STAGES
    keep = stage / (stage + dt)
    first = lagged(torque, before.first, keep)
    second = lagged(first, before.second, keep)
    third = lagged(second, before.third, keep)
    return DelayedTorque(first, second, third, lagged(third, before.fourth, keep))


@compiled
def unexplained_torque(
    parameters: TorqueObserverParameters,
    state: TorqueObserverState,
    motion: WheelMotion,
    dt: Real,
) -> Real:
    """Torque that the momentum needs besides the motor's and friction's [N·m].

    Args:
        parameters: The device.
        state: One step ago.
        motion: Now, all three signals after the same lag.
        dt: Step [s].
    """
    gained = parameters.inertia * (
        motion.steering_wheel_rate - state.steering_wheel_rate
    )
    resistance = (
        parameters.damping * motion.steering_wheel_rate
        + parameters.stiffness * motion.steering_wheel_angle
    )
    return gained / dt + resistance - motion.motor_torque


@compiled
def agreeing_torque(
    parameters: TorqueObserverParameters,
    steering_wheel_rate: Real,
    unexplained: Real,
    before: Real,
) -> Real:
    """The driver's torque that friction allows and that is nearest to the last [N·m].

    Among those of a still wheel it moves to their middle within the time of rest.

    Args:
        parameters: Friction, and the rate below which the wheel may be at rest.
        steering_wheel_rate: Of the wheel [rad/s].
        unexplained: What driver and friction do together [N·m].
        before: The last estimate [N·m].
    """
    sliding = xp.clip(steering_wheel_rate / parameters.still_rate, -1.0, 1.0)
    size = xp.select(sliding < 0.0, -sliding, sliding)
    middle = unexplained + parameters.friction * sliding
    room = parameters.friction * (1.0 - size)
    share = parameters.time_constant / parameters.rest_time
    nearby = before + share * (middle - before)
    return xp.clip(nearby, middle - room, middle + room)


@compiled
def step(
    parameters: TorqueObserverParameters,
    state: TorqueObserverState,
    motion: WheelMotion,
    dt: Real,
) -> tuple[TorqueObserverState, Real]:
    """Advance by one reading; return the state and the driver's torque [N·m].

    A reading without a finite angle and torque changes nothing.

    Args:
        parameters: The device, and how fast the estimate is.
        state: One reading ago.
        motion: The reading, and the torque that was sent before it.
        dt: Time since the reading before [s].
    """
    told = xp.isfinite(motion.steering_wheel_rate)
    keep = xp.select(told, 0.0, xp.exp(-dt / parameters.rate_time_constant))
    turned = motion.steering_wheel_angle - state.steering_wheel_angle
    rate = xp.select(told, motion.steering_wheel_rate, turned / dt)
    delayed = delayed_torque(parameters.latency, state.delayed, motion.motor_torque, dt)
    smooth = WheelMotion(
        steering_wheel_angle=lagged(
            motion.steering_wheel_angle, state.smooth_angle, keep
        ),
        steering_wheel_rate=lagged(rate, state.steering_wheel_rate, keep),
        motor_torque=lagged(delayed.fourth, state.smooth_torque, keep),
    )
    estimate = _estimate(parameters, state, smooth, dt)
    new_state = TorqueObserverState(
        estimated_driver_torque=estimate,
        steering_wheel_angle=motion.steering_wheel_angle,
        smooth_angle=smooth.steering_wheel_angle,
        steering_wheel_rate=smooth.steering_wheel_rate,
        smooth_torque=smooth.motor_torque,
        delayed=delayed,
    )
    usable = _usable(motion)
    kept = xp.select(usable, new_state, state)
    return kept, kept.estimated_driver_torque


@compiled
def _estimate(
    parameters: TorqueObserverParameters,
    state: TorqueObserverState,
    smooth: WheelMotion,
    dt: Real,
) -> Real:
    """The estimate after one step towards what agrees with the wheel [N·m]."""
    before = state.estimated_driver_torque
    agreeing = agreeing_torque(
        parameters,
        smooth.steering_wheel_rate,
        unexplained_torque(parameters, state, smooth, dt),
        before,
    )
    return lagged(agreeing, before, xp.exp(-dt / parameters.time_constant))


@compiled
def _usable(motion: WheelMotion) -> Flag:
    """Whether angle and torque are numbers."""
    return xp.isfinite(motion.steering_wheel_angle) & xp.isfinite(motion.motor_torque)
