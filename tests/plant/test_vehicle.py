"""The car: symmetry, conservation, and the steady turn it settles into."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.integrate import rk4
from costeer.plant.parameters import (
    CARS,
    DEFAULT_CAR,
    GRAVITY,
    CarParameters,
    steady_front_slip_angle,
    steady_sideslip_angle,
    steady_steering_wheel_angle,
)
from costeer.plant.vehicle import (
    VehicleInput,
    VehicleState,
    accelerations,
    drive_command,
    front_lateral_force,
    front_slip_angle,
    rear_lateral_force,
    resistance,
    vehicle_rate,
)

DT = 1.0 / 480.0
SPEED = 70.0 / 3.6
STATES = st.builds(
    VehicleState,
    longitudinal_position=st.floats(0.0, 1e3),
    lateral_position=st.floats(-6.0, 3.0),
    yaw_angle=st.floats(-0.5, 0.5),
    longitudinal_velocity=st.floats(0.0, 50.0),
    lateral_velocity=st.floats(-3.0, 3.0),
    yaw_rate=st.floats(-1.0, 1.0),
    drive=st.floats(-8.0, 3.0),
)
ANGLES = st.floats(-0.3, 0.3)
MIRRORED = ("lateral_position", "yaw_angle", "lateral_velocity", "yaw_rate")


def straight(car: CarParameters, speed: float) -> VehicleState:
    """The car straight ahead at a speed that the powertrain holds."""
    return VehicleState(0.0, 0.0, 0.0, speed, 0.0, 0.0, resistance(car, speed))


def driven(
    car: CarParameters, state: VehicleState, angle: float, duration: float
) -> VehicleState:
    """The car after driving with a fixed road-wheel angle, drive held."""
    motion = VehicleInput(car, angle, state.drive)
    for _ in range(round(duration / DT)):
        state = rk4(vehicle_rate, state, motion, DT)
    return state


def mirrored(state: VehicleState) -> VehicleState:
    """The same motion in a mirror."""
    turned = {name: -getattr(state, name) for name in MIRRORED}
    return VehicleState(**(state._asdict() | turned))


@given(STATES, ANGLES)
def test_mirrored_motion_has_mirrored_rates(state: VehicleState, angle: float) -> None:
    left = vehicle_rate(state, VehicleInput(DEFAULT_CAR, angle, 0.5))
    right = vehicle_rate(mirrored(state), VehicleInput(DEFAULT_CAR, -angle, 0.5))
    assert right == mirrored(left)


@pytest.mark.parametrize("name", sorted(CARS))
def test_a_car_going_straight_goes_on_straight(name: str) -> None:
    car = CARS[name]
    there = driven(car, straight(car, SPEED), 0.0, 2.0)
    # Nothing turns it; the powertrain's share of rounding is below 1e-9 m.
    assert there[1:3] == (0.0, 0.0)
    assert there.longitudinal_velocity == pytest.approx(SPEED, rel=1e-14)
    assert there.longitudinal_position == pytest.approx(2.0 * SPEED, rel=1e-12)


@given(st.floats(0.0, 50.0), st.floats(-math.pi, math.pi))
def test_the_ground_is_covered_at_the_speed_of_the_car(
    speed: float, yaw: float
) -> None:
    state = straight(DEFAULT_CAR, speed)._replace(yaw_angle=yaw, lateral_velocity=0.7)
    rate = vehicle_rate(state, VehicleInput(DEFAULT_CAR, 0.0, 0.0))
    covered = math.hypot(rate.longitudinal_position, rate.lateral_position)
    assert covered == pytest.approx(math.hypot(speed, 0.7))


def test_a_sliding_car_loses_energy_only() -> None:
    # No drive, no losses but the tyres: kinetic energy may only fall.
    car = DEFAULT_CAR._replace(rolling_resistance=0.0, air_resistance=0.0)
    state = VehicleState(0.0, 0.0, 0.0, 20.0, 4.0, 0.5, 0.0)
    motion = VehicleInput(car, 0.02, 0.0)

    def energy(state: VehicleState) -> float:
        speed = state.longitudinal_velocity**2 + state.lateral_velocity**2
        return car.mass * speed / 2.0 + car.yaw_inertia * state.yaw_rate**2 / 2.0

    before = energy(state)
    for _ in range(960):
        state = rk4(vehicle_rate, state, motion, DT)
        assert energy(state) <= before * (1.0 + 1e-12)  # rounding once it coasts
        before = energy(state)


@pytest.mark.parametrize("name", sorted(CARS))
@pytest.mark.parametrize(
    "speed", [pytest.param(50.0 / 3.6, marks=pytest.mark.slow), 110.0 / 3.6]
)
def test_a_gentle_turn_settles_to_the_steady_relations(name: str, speed: float) -> None:
    # A straight-ahead drive holds the speed to 1e-5 in so gentle a turn.
    car, curvature = CARS[name], 1e-6
    wheel = steady_steering_wheel_angle(car, speed, curvature)
    state = driven(car, straight(car, speed), wheel / car.steering_ratio, 6.0)
    slip = front_slip_angle(car, *state[3:6], wheel / car.steering_ratio)
    # Share of the slip that leads to sliding: 3e-5 here; the rest is transient.
    assert state.yaw_rate == pytest.approx(speed * curvature, rel=2e-4)
    assert slip == pytest.approx(
        steady_front_slip_angle(car, speed, curvature), rel=2e-4
    )
    # The sideslip angle is a difference of two such terms.
    assert state.lateral_velocity / speed == pytest.approx(
        steady_sideslip_angle(car, speed, curvature), abs=2e-4 * 2.0 * curvature
    )


def test_the_steady_turn_is_approached_as_the_angle_shrinks() -> None:
    # The brush model's first correction is linear in the slip.
    errors = []
    for curvature in (4e-4, 2e-4):
        wheel = steady_steering_wheel_angle(DEFAULT_CAR, SPEED, curvature)
        angle = wheel / DEFAULT_CAR.steering_ratio
        state = driven(DEFAULT_CAR, straight(DEFAULT_CAR, SPEED), angle, 6.0)
        turned = state.yaw_rate / state.longitudinal_velocity
        errors.append(abs(turned / curvature - 1.0))
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
    assert errors[1] < 0.02


def test_sideways_grip_is_what_the_road_gives() -> None:
    state = straight(DEFAULT_CAR, 30.0)._replace(lateral_velocity=-30.0)
    motion = VehicleInput(DEFAULT_CAR, 0.0, 0.0)
    forces = front_lateral_force(state, motion) + rear_lateral_force(state, motion)
    # All axles slide: friction times weight.
    weight = DEFAULT_CAR.mass * GRAVITY
    assert forces == pytest.approx(DEFAULT_CAR.friction * weight)


def test_the_measured_acceleration_is_that_of_the_ground_path() -> None:
    state = VehicleState(0.0, 0.0, 0.1, 25.0, -0.4, 0.2, 0.3)
    motion = VehicleInput(DEFAULT_CAR, 0.03, 0.3)
    forward, left = accelerations(
        state,
        motion,
        front_lateral_force(state, motion),
        rear_lateral_force(state, motion),
    )
    step = 1e-4
    before = vehicle_rate(rk4(vehicle_rate, state, motion, -step), motion)
    after = vehicle_rate(rk4(vehicle_rate, state, motion, step), motion)
    along = (after.longitudinal_position - before.longitudinal_position) / (2 * step)
    across = (after.lateral_position - before.lateral_position) / (2 * step)
    cosine, sine = math.cos(state.yaw_angle), math.sin(state.yaw_angle)
    # Central differences of metres per second over 0.2 ms: 1e-6 at best.
    assert forward == pytest.approx(along * cosine + across * sine, abs=1e-5)
    assert left == pytest.approx(across * cosine - along * sine, abs=1e-5)


def test_steered_tyres_brake_the_car() -> None:
    # A front force F at the angle δ pushes -F sin δ forward and F cos δ to the left.
    state = straight(DEFAULT_CAR, SPEED)
    motion = VehicleInput(DEFAULT_CAR, 0.3, state.drive)
    forward, left = accelerations(state, motion, 6000.0, 0.0)
    assert forward == pytest.approx(-4.0 * math.sin(0.3))  # 6000 N on 1500 kg
    assert left == pytest.approx(4.0 * math.cos(0.3))


def test_a_braking_car_stops_and_stays() -> None:
    state = straight(DEFAULT_CAR, 5.0)
    motion = VehicleInput(DEFAULT_CAR, 0.0, drive_command(DEFAULT_CAR, 0.0, 1.0))
    for _ in range(960):
        state = rk4(vehicle_rate, state, motion, DT)
    # The last step may overshoot standing still by less than a step of braking.
    assert abs(state.longitudinal_velocity) < DEFAULT_CAR.braking_limit * DT
    later = rk4(vehicle_rate, state, motion, DT)
    assert later.longitudinal_velocity == state.longitudinal_velocity


def test_pedals_ask_for_their_limits() -> None:
    assert drive_command(DEFAULT_CAR, 1.0, 0.0) == DEFAULT_CAR.acceleration_limit
    assert drive_command(DEFAULT_CAR, 0.0, 1.0) == -DEFAULT_CAR.braking_limit
    assert drive_command(DEFAULT_CAR, 0.0, 0.0) == 0.0


def test_a_batch_gives_what_its_members_give() -> None:
    generator = np.random.default_rng(1)
    columns = generator.normal(size=(7, 12)) * 0.2 + [
        [0],
        [0],
        [0],
        [20],
        [0],
        [0],
        [0],
    ]
    motion = VehicleInput(DEFAULT_CAR, 0.02, 0.1)
    batch = np.transpose(vehicle_rate(VehicleState(*columns), motion))
    members = [
        vehicle_rate(VehicleState(*column), motion) for column in columns.T.tolist()
    ]
    # NumPy's sine and cosine may differ in the last place; forces are near 1e4 N.
    np.testing.assert_allclose(batch, members, 1e-12, 1e-14)
