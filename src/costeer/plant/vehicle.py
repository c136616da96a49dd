"""Single-track car: lateral velocity, yaw rate, position; speed from the pedals.

The car moves in the road's own coordinates (curvilinear): along the reference line,
across it, and yaw against it. With the curvature kappa of that line at the car,
s' = v_along / (1 - kappa y), y' = v_across and psi' = r - kappa s'.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.integrate import rk4
from costeer.plant.parameters import GRAVITY, CarParameters, wheelbase
from costeer.plant.place import Place
from costeer.plant.tyre import lateral_force

_SLOWEST = 1.0
"""Slip angles are taken at this speed when the car is slower [m/s]."""


class VehicleState(NamedTuple):
    """Motion of the centre of gravity.

    Attributes:
        longitudinal_position: Along the road [m].
        lateral_position: From the left lane's centre, left positive [m].
        yaw_angle: From the road's direction [rad].
        longitudinal_velocity: In the car's direction [m/s].
        lateral_velocity: To the car's left [m/s].
        yaw_rate: [rad/s].
        drive: Acceleration that the powertrain and brakes give [m/s²].
    """

    longitudinal_position: Real
    lateral_position: Real
    yaw_angle: Real
    longitudinal_velocity: Real
    lateral_velocity: Real
    yaw_rate: Real
    drive: Real


class VehicleInput(NamedTuple):
    """What moves the car during one plant step.

    Attributes:
        car: Its parameters.
        road_wheel_angle: At the front wheels [rad].
        drive_command: Acceleration asked for by the pedals [m/s²].
        place: What the road does to the car.
    """

    car: CarParameters
    road_wheel_angle: Real
    drive_command: Real
    place: Place = Place()


@compiled
def front_slip_tangent(
    car: CarParameters,
    longitudinal_velocity: Real,
    lateral_velocity: Real,
    yaw_rate: Real,
    road_wheel_angle: Real,
) -> Real:
    """Tangent of the front slip angle [-]: of a difference of two directions."""
    speed = xp.maximum(longitudinal_velocity, _SLOWEST)
    direction = (lateral_velocity + car.front_distance * yaw_rate) / speed
    return _tangent_of_difference(direction, xp.tan(road_wheel_angle))


@compiled
def _tangent_of_difference(direction: Real, wheel: Real) -> Real:
    """Tangent of the difference of two angles from their tangents [-]."""
    return (direction - wheel) / (1.0 + direction * wheel)


@compiled
def front_slip_angle(
    car: CarParameters,
    longitudinal_velocity: Real,
    lateral_velocity: Real,
    yaw_rate: Real,
    road_wheel_angle: Real,
) -> Real:
    """Direction of the front tyre's velocity minus that of the wheel [rad]."""
    return xp.atan(
        front_slip_tangent(
            car, longitudinal_velocity, lateral_velocity, yaw_rate, road_wheel_angle
        )
    )


@compiled
def rear_slip_tangent(
    car: CarParameters,
    longitudinal_velocity: Real,
    lateral_velocity: Real,
    yaw_rate: Real,
) -> Real:
    """Tangent of the rear slip angle [-]; the rear wheels do not steer."""
    speed = xp.maximum(longitudinal_velocity, _SLOWEST)
    return (lateral_velocity - car.rear_distance * yaw_rate) / speed


class Wheels(NamedTuple):
    """Where the front wheels point: functions of one angle, computed once a step.

    Attributes:
        tangent: Of the road-wheel angle [-].
        sine: [-].
        cosine: [-].
    """

    tangent: Real
    sine: Real
    cosine: Real


@compiled
def pointing(road_wheel_angle: Real) -> Wheels:
    """The front wheels at an angle [rad]."""
    return Wheels(
        tangent=xp.tan(road_wheel_angle),
        sine=xp.sin(road_wheel_angle),
        cosine=xp.cos(road_wheel_angle),
    )


@compiled
def front_lateral_force(state: VehicleState, motion: VehicleInput) -> Real:
    """Lateral force of the front axle [N]."""
    return _front_force(state, motion.car, xp.tan(motion.road_wheel_angle))


@compiled
def _front_force(state: VehicleState, car: CarParameters, wheel_tangent: Real) -> Real:
    """Lateral force of the front axle, by the tangent of the wheel angle [N]."""
    speed = xp.maximum(state.longitudinal_velocity, _SLOWEST)
    direction = (state.lateral_velocity + car.front_distance * state.yaw_rate) / speed
    slip = _tangent_of_difference(direction, wheel_tangent)
    load = car.mass * GRAVITY * car.rear_distance / wheelbase(car)
    return lateral_force(slip, car.front_cornering_stiffness, car.friction * load)


@compiled
def rear_lateral_force(state: VehicleState, motion: VehicleInput) -> Real:
    """Lateral force of the rear axle [N]."""
    car = motion.car
    slip = rear_slip_tangent(
        car, state.longitudinal_velocity, state.lateral_velocity, state.yaw_rate
    )
    load = car.mass * GRAVITY * car.front_distance / wheelbase(car)
    return lateral_force(slip, car.rear_cornering_stiffness, car.friction * load)


@compiled
def resistance(car: CarParameters, speed: Real) -> Real:
    """Deceleration by rolling and air [m/s²]; none for a car that stands."""
    air = car.air_resistance * speed * speed
    return xp.select(speed > 0.0, car.rolling_resistance + air, 0.0)


@compiled
def drive_command(car: CarParameters, accelerator: Real, brake: Real) -> Real:
    """Acceleration asked for by pedals in [0, 1] [m/s²]."""
    return car.acceleration_limit * accelerator - car.braking_limit * brake


@compiled
def accelerations(
    state: VehicleState, motion: VehicleInput, front: Real, rear: Real
) -> tuple[Real, Real]:
    """Acceleration of the centre of gravity, forward and to the left [m/s²].

    Args:
        state: Of the car.
        motion: What moves it.
        front: Lateral force of the front axle [N].
        rear: Lateral force of the rear axle [N].
    """
    wheels = pointing(motion.road_wheel_angle)
    return _accelerations(state, motion.car, wheels, front, rear)


@compiled
def _accelerations(
    state: VehicleState, car: CarParameters, wheels: Wheels, front: Real, rear: Real
) -> tuple[Real, Real]:
    """`accelerations` by where the wheels point."""
    losses = resistance(car, state.longitudinal_velocity)
    forward = state.drive - losses - front * wheels.sine / car.mass
    return forward, (front * wheels.cosine + rear) / car.mass


class Held(NamedTuple):
    """What is held over a plant step.

    Attributes:
        motion: What moves the car.
        wheels: Where its front wheels point.
    """

    motion: VehicleInput
    wheels: Wheels


@compiled
def vehicle_rate(state: VehicleState, motion: VehicleInput) -> VehicleState:
    """Time derivative of the car's state: planar motion of one rigid body."""
    return _rate(state, Held(motion, pointing(motion.road_wheel_angle)))


@compiled
def _rate(state: VehicleState, held: Held) -> VehicleState:
    """`vehicle_rate` with what is held over the step."""
    motion, wheels = held.motion, held.wheels
    car, place = motion.car, motion.place
    front = _front_force(state, car, wheels.tangent)
    rear = rear_lateral_force(state, motion)
    push, pull = _accelerations(state, car, wheels, front, rear)
    across = front * wheels.cosine
    moment = car.front_distance * across - car.rear_distance * rear
    cosine, sine = xp.cos(state.yaw_angle), xp.sin(state.yaw_angle)
    forward, left = state.longitudinal_velocity, state.lateral_velocity
    along = push + state.yaw_rate * left
    moved = state.longitudinal_position - place.bend.station
    curvature = place.bend.curvature + place.bend.slope * moved
    progress = (forward * cosine - left * sine) / (
        1.0 - curvature * state.lateral_position
    )
    pushed = pull + place.side_force / car.mass
    return VehicleState(
        longitudinal_position=progress,
        lateral_position=forward * sine + left * cosine,
        yaw_angle=state.yaw_rate - curvature * progress,
        longitudinal_velocity=xp.select((forward > 0.0) | (along > 0.0), along, 0.0),
        lateral_velocity=pushed - state.yaw_rate * forward,
        yaw_rate=moment / car.yaw_inertia,
        drive=(motion.drive_command - state.drive) / car.powertrain_lag,
    )


@compiled
def driven(state: VehicleState, motion: VehicleInput, dt: Real) -> VehicleState:
    """The car `dt` [s] later; one that has hit something stands where it is."""
    standing = state._replace(
        longitudinal_velocity=0.0, lateral_velocity=0.0, yaw_rate=0.0, drive=0.0
    )
    held = Held(motion, pointing(motion.road_wheel_angle))
    moved = rk4(_rate, state, held, dt)
    return xp.select(motion.place.stopped, standing, moved)
