"""Every physical value of the simulated world, with unit and source.

The controller may import this file: it knows the car's nominal parameters.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base.array import Real, compiled


class CarParameters(NamedTuple):
    """Single-track car with saturating tyres.

    Attributes:
        mass: m [kg]. Source: assumed, mid-size car with driver.
        yaw_inertia: I_z about the centre of gravity [kg·m²]. Source: assumed.
        front_distance: l_f, centre of gravity to front axle [m]. Source: assumed.
        rear_distance: l_r, centre of gravity to rear axle [m]. Source: assumed.
        front_cornering_stiffness: C_f of the axle [N/rad]. Source: assumed.
        rear_cornering_stiffness: C_r of the axle [N/rad]. Source: assumed.
        steering_ratio: Steering-wheel angle over road-wheel angle [-].
            Source: assumed, common for this class.
        aligning_stiffness: k_s, self-aligning torque at the steering wheel over front
            slip angle [N·m/rad]. Source: assumed, power assistance leaves 0.6 of
            trail 0.026 m times C_f over the ratio.
        friction: Tyre to road [-]. Source: assumed, dry asphalt.
        width: Over the wheels, for departures from the lane [m]. Source: assumed.
        acceleration_limit: At full accelerator [m/s²]. Source: assumed.
        braking_limit: At full brake [m/s²]. Source: assumed, dry asphalt.
        rolling_resistance: Deceleration that does not depend on speed [m/s²].
            Source: assumed, coefficient 0.010.
        air_resistance: Deceleration over speed squared [1/m]. Source: assumed,
            0.5 · 1.2 kg/m³ · 0.7 m² / 1500 kg.
        powertrain_lag: Pedal to acceleration [s]. Source: assumed.
        length: Over all, for collisions [m]. Source: assumed.
    """

    mass: Real = 1500.0
    yaw_inertia: Real = 2500.0
    front_distance: Real = 1.10
    rear_distance: Real = 1.60
    front_cornering_stiffness: Real = 110e3
    rear_cornering_stiffness: Real = 120e3
    steering_ratio: Real = 16.0
    aligning_stiffness: Real = 0.6 * 0.026 * 110e3 / 16.0
    friction: Real = 0.9
    width: Real = 1.8
    acceleration_limit: Real = 3.0
    braking_limit: Real = 8.0
    rolling_resistance: Real = 0.1
    air_resistance: Real = 2.8e-4
    powertrain_lag: Real = 0.3
    length: Real = 4.5


class ColumnParameters(NamedTuple):
    """Steering column as felt at the wheel, Eq. (4) and Table II.

    Attributes:
        inertia: J_eq [kg·m²]. Source: assumed, column, wheel and reflected rack.
        damping: B_eq [N·m·s/rad]. Source: assumed, power steering.
        stiffness: K_Fz, pull towards straight ahead [N·m/rad]. Source: assumed.
        friction: Coulomb friction [N·m]. Source: assumed; the identified columns of
            two real cars show 0.25.
        motor_lag: Torque command to torque [s]. Source: assumed.
        torque_limit: Largest guidance torque [N·m]. Source: assumed, a driver holds
            it with one hand.
    """

    inertia: Real = 0.06
    damping: Real = 1.5
    stiffness: Real = 2.0
    friction: Real = 0.25
    motor_lag: Real = 0.020
    torque_limit: Real = 5.0


class RoadParameters(NamedTuple):
    """Parallel lanes of one direction.

    Attributes:
        lane_width: d [m]. Source: paper, expressway.
        num_lanes: Lanes of this direction [-]. Source: paper, two.
        length: Of the course [m]. Source: paper, Sec. III.
        overtaking_side: Direction of the overtaking lane, -1 right under left-hand
            traffic, +1 left under right-hand traffic [-]. Source: paper, Japan.
        shoulder: From the outer lines to the barriers [m]. Source: assumed.
        rumble: Largest torque of the strips outside the outer lines at the wheel
            [N·m]. Source: assumed, felt and not steering.
    """

    lane_width: Real = 3.5
    num_lanes: Real = 2.0
    length: Real = 8000.0
    overtaking_side: Real = -1.0
    shoulder: Real = 2.5
    rumble: Real = 0.6


DEFAULT_CAR = CarParameters()
COMPACT_CAR = CarParameters(
    mass=1100.0,
    yaw_inertia=2940.0,
    front_distance=1.00,
    rear_distance=1.635,
    front_cornering_stiffness=107e3,
    rear_cornering_stiffness=234e3,
    steering_ratio=17.0,
    aligning_stiffness=163.0,
)
LARGE_CAR = CarParameters(
    mass=1835.0,
    yaw_inertia=2800.0,
    front_distance=1.249,
    rear_distance=1.56,
    front_cornering_stiffness=104e3,
    rear_cornering_stiffness=109e3,
    steering_ratio=14.54,
    aligning_stiffness=54.0,
)

CARS = {"default": DEFAULT_CAR, "compact": COMPACT_CAR, "large": LARGE_CAR}
"""The three cars of the hands-off figures, by name."""

GRAVITY = 9.81
"""Standard acceleration of gravity, rounded [m/s²]."""


@compiled
def wheelbase(car: CarParameters) -> Real:
    """Distance of the axles [m]."""
    return car.front_distance + car.rear_distance


@compiled
def understeer_coefficient(car: CarParameters) -> Real:
    """K_us of steady cornering: angle = (wheelbase + K_us v²) · curvature [s²/m]."""
    front = car.front_distance * car.front_cornering_stiffness
    rear = car.rear_distance * car.rear_cornering_stiffness
    product = car.front_cornering_stiffness * car.rear_cornering_stiffness
    return car.mass * (rear - front) / (wheelbase(car) * product)


@compiled
def steady_steering_wheel_angle(
    car: CarParameters, speed: Real, curvature: Real
) -> Real:
    """Steering-wheel angle of steady cornering [rad].

    Args:
        car: Linear tyres are assumed.
        speed: Along the path [m/s].
        curvature: Of the path, positive to the left [1/m].
    """
    path_angle = wheelbase(car) + understeer_coefficient(car) * speed * speed
    return car.steering_ratio * path_angle * curvature


@compiled
def steady_front_slip_angle(car: CarParameters, speed: Real, curvature: Real) -> Real:
    """Front slip angle of steady cornering [rad]; negative in a left bend."""
    load = car.mass * car.rear_distance / wheelbase(car)
    return -load * speed * speed * curvature / car.front_cornering_stiffness


@compiled
def steady_sideslip_angle(car: CarParameters, speed: Real, curvature: Real) -> Real:
    """Sideslip angle at the centre of gravity in steady cornering [rad]."""
    load = car.mass * car.front_distance / wheelbase(car)
    rear_slip = load * speed * speed / car.rear_cornering_stiffness
    return (car.rear_distance - rear_slip) * curvature


@compiled
def holding_stiffness(
    car: CarParameters, column: ColumnParameters, speed: Real
) -> Real:
    """Torque that holds the wheel in steady cornering, over its angle [N·m/rad]."""
    angle = steady_steering_wheel_angle(car, speed, 1.0)
    slip_per_angle = steady_front_slip_angle(car, speed, 1.0) / angle
    return column.stiffness - car.aligning_stiffness * slip_per_angle
