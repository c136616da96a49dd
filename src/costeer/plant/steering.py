"""Steering column: inertia, damping, self-aligning torque, dry friction, motor."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.plant.parameters import CarParameters, ColumnParameters


class ColumnState(NamedTuple):
    """The wheel in the driver's hands and the motor behind it.

    Attributes:
        steering_wheel_angle: Positive to the left [rad].
        steering_wheel_rate: Its time derivative [rad/s].
        motor_torque: Guidance torque that the motor gives [N·m].
    """

    steering_wheel_angle: Real
    steering_wheel_rate: Real
    motor_torque: Real


@compiled
def aligning_torque(car: CarParameters, front_force: Real) -> Real:
    """Self-aligning torque of the front tyres at the wheel [N·m], left positive.

    k_s times the slip angle for a linear tyre; it fades as the tyre saturates.

    Args:
        car: Its `aligning_stiffness` is k_s.
        front_force: Lateral force of the front axle [N].
    """
    return -car.aligning_stiffness * front_force / car.front_cornering_stiffness


@compiled
def motor_torque(
    column: ColumnParameters, torque: Real, command: Real, dt: Real
) -> Real:
    """Torque of the motor after `dt` [s]: a lag that never passes the limit [N·m].

    A command that is not finite asks for no torque.
    """
    asked = xp.select(xp.isfinite(command), command, 0.0)
    held = xp.clip(asked, -column.torque_limit, column.torque_limit)
    return held + (torque - held) * xp.exp(-dt / column.motor_lag)


@compiled
def steering_wheel_rate(
    column: ColumnParameters,
    steering_wheel_angle: Real,
    steering_wheel_rate: Real,
    wheel_torque: Real,
    dt: Real,
) -> Real:
    """Rate of the wheel after one step [rad/s]: Eq. (4), all resistance implicit.

    Coulomb friction enters as an impulse of at most friction · dt that opposes the
    motion and may stop the wheel, so a wheel at rest stays at rest until more than
    the friction acts on it. A smoothed sign would let it creep.

    Args:
        column: Inertia, damping, stiffness and friction at the wheel.
        steering_wheel_angle: At the start of the step [rad].
        steering_wheel_rate: At the start of the step [rad/s].
        wheel_torque: Driver, guidance and self-aligning torque [N·m].
        dt: Step [s].
    """
    pull = wheel_torque - column.stiffness * steering_wheel_angle
    momentum = column.inertia * steering_wheel_rate + dt * pull
    brake = column.friction * dt
    left = momentum - xp.clip(momentum, -brake, brake)
    impedance = column.inertia + dt * column.damping + dt * dt * column.stiffness
    return left / impedance
