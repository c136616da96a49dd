"""A real wheel in the person's loop: its angle steers, its motor makes the column felt.

The wheel is the column: nothing of it is simulated. What the device lacks of Eq. (4)
is rendered by its motor.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.person import PersonHeld, PersonMotion
from costeer.plant.parameters import CarParameters, ColumnParameters
from costeer.plant.place import rumble_torque
from costeer.plant.steering import ColumnState, aligning_torque, motor_torque
from costeer.plant.vehicle import VehicleInput, driven, front_lateral_force
from costeer.plant.world import WorldState


class WheelInput(NamedTuple):
    """What a real wheel says at a plant step, and what it is made of.

    Attributes:
        steering_wheel_angle: [rad].
        steering_wheel_rate: [rad/s].
        driver_torque: Measured or observed [N·m].
        damping: Of the device by itself [N·m·s/rad].
        friction: Of the device by itself [N·m].
    """

    steering_wheel_angle: Real
    steering_wheel_rate: Real
    driver_torque: Real
    damping: Real
    friction: Real


RENDERED_SMOOTHING = 0.1
"""Rate at which rendered friction has 76 % of its size [rad/s]: a sign would buzz."""


@compiled
def rendered_torque(
    car: CarParameters,
    column: ColumnParameters,
    state: WorldState,
    wheel: WheelInput,
) -> Real:
    """What a real wheel must give besides the driver, for Eq. (4) to be felt [N·m].

    Guidance and self-aligning torque, the pull towards straight ahead, and as much
    damping and friction as the device itself lacks; it cannot take any away.

    Args:
        car: Its tyres give the self-aligning torque.
        column: That is to be felt.
        state: Of the world, with the device's angle.
        wheel: The device's motion and what it is made of.
    """
    angle, rate = wheel.steering_wheel_angle, wheel.steering_wheel_rate
    motion = VehicleInput(
        car=car, road_wheel_angle=angle / car.steering_ratio, drive_command=0.0
    )
    tyres = aligning_torque(car, front_lateral_force(state.vehicle, motion))
    damping = xp.maximum(column.damping - wheel.damping, 0.0) * rate
    friction = xp.maximum(column.friction - wheel.friction, 0.0)
    dry = friction * xp.tanh(rate / RENDERED_SMOOTHING)
    return state.column.motor_torque + tyres - column.stiffness * angle - damping - dry


@compiled
def wheel_step(
    parameters: LoopParameters[Any],
    motion: PersonMotion,
    held: PersonHeld,
    wheel: WheelInput,
) -> tuple[PersonMotion, Real]:
    """World one plant step later with the angle of a real wheel, and its torque [N·m].

    The car has run through the step with the wheel half-way between its last angle
    and this one.
    """
    car, column = parameters.car, parameters.column
    dt = DT / parameters.plant_steps
    state = motion.plant.world
    middle = (state.column.steering_wheel_angle + wheel.steering_wheel_angle) / 2.0
    vehicle_input = VehicleInput(
        car=car,
        road_wheel_angle=middle / car.steering_ratio,
        drive_command=held.drive_command,
        place=held.place,
    )
    moved = WorldState(
        vehicle=driven(state.vehicle, vehicle_input, dt),
        column=ColumnState(
            steering_wheel_angle=wheel.steering_wheel_angle,
            steering_wheel_rate=wheel.steering_wheel_rate,
            motor_torque=motor_torque(
                column, state.column.motor_torque, held.torque_command, dt
            ),
        ),
    )
    muscles = motion.plant.muscles + wheel.driver_torque
    plant = motion.plant._replace(world=moved, muscles=muscles)
    torque = rendered_torque(car, column, moved, wheel) + rumble_torque(
        held.place, moved.vehicle.longitudinal_position
    )
    return motion._replace(plant=plant), torque
