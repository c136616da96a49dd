"""State of the simulated world without the driver's body, and one plant step of it."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base.array import Real, compiled
from costeer.plant.parameters import CarParameters, ColumnParameters
from costeer.plant.place import Place, rumble_torque
from costeer.plant.steering import (
    ColumnState,
    aligning_torque,
    motor_torque,
    steering_wheel_rate,
)
from costeer.plant.vehicle import (
    VehicleInput,
    VehicleState,
    driven,
    front_lateral_force,
    resistance,
)


class WorldState(NamedTuple):
    """Car and steering column.

    Attributes:
        vehicle: Motion of the car.
        column: Steering wheel and motor.
    """

    vehicle: VehicleState
    column: ColumnState


class Inputs(NamedTuple):
    """What acts on the world during one plant step.

    Attributes:
        driver_torque: Of the driver's hands [N·m].
        torque_command: Asked of the guidance motor [N·m].
        drive_command: Acceleration asked for by the pedals [m/s²].
        place: What the road does to the car.
    """

    driver_torque: Real
    torque_command: Real
    drive_command: Real
    place: Place = Place()


@compiled
def initial_state(
    car: CarParameters, lateral_position: Real, speed: Real
) -> WorldState:
    """The car straight ahead at a constant speed, wheel at rest.

    Args:
        car: Its powertrain holds the speed from the start.
        lateral_position: From the left lane's centre [m].
        speed: [m/s].
    """
    vehicle = VehicleState(
        longitudinal_position=0.0,
        lateral_position=lateral_position,
        yaw_angle=0.0,
        longitudinal_velocity=speed,
        lateral_velocity=0.0,
        yaw_rate=0.0,
        drive=resistance(car, speed),
    )
    column = ColumnState(
        steering_wheel_angle=0.0, steering_wheel_rate=0.0, motor_torque=0.0
    )
    return WorldState(vehicle=vehicle, column=column)


@compiled
def step_column(
    car: CarParameters,
    column: ColumnParameters,
    state: WorldState,
    inputs: Inputs,
    dt: Real,
) -> ColumnState:
    """The steering column `dt` [s] later."""
    wheel = state.column
    motion = VehicleInput(
        car=car,
        road_wheel_angle=wheel.steering_wheel_angle / car.steering_ratio,
        drive_command=inputs.drive_command,
    )
    tyres = aligning_torque(car, front_lateral_force(state.vehicle, motion))
    rumble = rumble_torque(inputs.place, state.vehicle.longitudinal_position)
    motor = motor_torque(column, wheel.motor_torque, inputs.torque_command, dt)
    rate = steering_wheel_rate(
        column,
        wheel.steering_wheel_angle,
        wheel.steering_wheel_rate,
        inputs.driver_torque + motor + tyres + rumble,
        dt,
    )
    return ColumnState(
        steering_wheel_angle=wheel.steering_wheel_angle + dt * rate,
        steering_wheel_rate=rate,
        motor_torque=motor,
    )


@compiled
def step(
    car: CarParameters,
    column: ColumnParameters,
    state: WorldState,
    inputs: Inputs,
    dt: Real,
) -> WorldState:
    """The world one plant step `dt` [s] later.

    The column moves first, by an implicit step; the car then runs through the step
    by Runge-Kutta with the wheel half-way between its two angles.
    """
    wheel = step_column(car, column, state, inputs, dt)
    half_way = (state.column.steering_wheel_angle + wheel.steering_wheel_angle) / 2.0
    motion = VehicleInput(
        car=car,
        road_wheel_angle=half_way / car.steering_ratio,
        drive_command=inputs.drive_command,
        place=inputs.place,
    )
    return WorldState(vehicle=driven(state.vehicle, motion, dt), column=wheel)
