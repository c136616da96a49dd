"""Steady cornering in closed form, and the cars it is used for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.parameters import (
    CARS,
    DEFAULT_CAR,
    ColumnParameters,
    holding_stiffness,
    steady_front_slip_angle,
    steady_sideslip_angle,
    steady_steering_wheel_angle,
    understeer_coefficient,
    wheelbase,
)

SPEEDS = st.floats(5.0, 40.0)
NAMES = st.sampled_from(sorted(CARS))


@given(NAMES, SPEEDS)
def test_steady_forces_balance_the_turn(name: str, speed: float) -> None:
    car, curvature = CARS[name], 1e-3
    front_slip = steady_front_slip_angle(car, speed, curvature)
    sideslip = steady_sideslip_angle(car, speed, curvature)
    rear_slip = sideslip - car.rear_distance * curvature
    front = -car.front_cornering_stiffness * front_slip
    rear = -car.rear_cornering_stiffness * rear_slip
    # Force and moment balance to rounding.
    assert front + rear == pytest.approx(car.mass * speed**2 * curvature, rel=1e-12)
    assert front * car.front_distance == pytest.approx(rear * car.rear_distance)


@given(NAMES, SPEEDS)
def test_the_wheel_angle_closes_the_geometry_of_the_turn(
    name: str, speed: float
) -> None:
    car, curvature = CARS[name], 1e-3
    sideslip = steady_sideslip_angle(car, speed, curvature)
    front_slip = steady_front_slip_angle(car, speed, curvature)
    road_wheel_angle = sideslip + car.front_distance * curvature - front_slip
    wheel = steady_steering_wheel_angle(car, speed, curvature)
    assert wheel == pytest.approx(car.steering_ratio * road_wheel_angle)


def test_at_walking_pace_the_wheel_angle_is_ackermanns() -> None:
    car = DEFAULT_CAR
    angle = steady_steering_wheel_angle(car, 0.0, 0.01)
    assert angle == car.steering_ratio * wheelbase(car) * 0.01


@pytest.mark.parametrize("name", sorted(CARS))
def test_every_car_understeers(name: str) -> None:
    assert understeer_coefficient(CARS[name]) > 0.0


def test_understeer_of_the_default_car_by_hand() -> None:
    # 1500 (1.6 · 120e3 - 1.1 · 110e3) / (2.7 · 110e3 · 120e3) = 2.9882e-3 s²/m
    assert understeer_coefficient(DEFAULT_CAR) == pytest.approx(2.9882e-3, rel=1e-4)


@given(NAMES, SPEEDS)
def test_the_holding_torque_overcomes_spring_and_tyres(name: str, speed: float) -> None:
    car, column, curvature = CARS[name], ColumnParameters(), 2e-3
    angle = steady_steering_wheel_angle(car, speed, curvature)
    tyres = car.aligning_stiffness * steady_front_slip_angle(car, speed, curvature)
    held = holding_stiffness(car, column, speed) * angle
    assert held == pytest.approx(column.stiffness * angle - tyres)


def test_the_cars_are_those_of_the_specification() -> None:
    rows = {name: tuple(car[:8]) for name, car in CARS.items()}
    assert rows["compact"] == (1100, 2940, 1.00, 1.635, 107e3, 234e3, 17, 163)
    assert rows["large"] == (1835, 2800, 1.249, 1.56, 104e3, 109e3, 14.54, 54)
    assert rows["default"][:7] == (1500, 2500, 1.10, 1.60, 110e3, 120e3, 16)


def test_a_batch_of_speeds_gives_what_its_members_give() -> None:
    speeds = np.linspace(5.0, 40.0, 9)
    batch = holding_stiffness(DEFAULT_CAR, ColumnParameters(), speeds)
    members = [
        holding_stiffness(DEFAULT_CAR, ColumnParameters(), v) for v in speeds.tolist()
    ]
    assert batch.tolist() == members
