"""The car along and across a curved road, against the same car in the plane."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.alignment import STRAIGHT, Alignment, Bend, alignment, bend_at
from costeer.plant.parameters import (
    CARS,
    DEFAULT_CAR,
    CarParameters,
    steady_steering_wheel_angle,
)
from costeer.plant.place import NOWHERE, Place
from costeer.plant.vehicle import (
    VehicleInput,
    VehicleState,
    driven,
    resistance,
    vehicle_rate,
)
from tests.plant.roads import point_on

DT = 1.0 / 60.0
SPEED = 90.0 / 3.6
STATIONS = (0.0, 100.0, 220.0, 700.0, 940.0, 1400.0)
CURVATURES = (0.0, 0.0, 1.0 / 500.0, 1.0 / 500.0, -1.0 / 500.0, -1.0 / 500.0)
ROAD = alignment(STATIONS, CURVATURES)
MIRRORED = ("lateral_position", "yaw_angle", "lateral_velocity", "yaw_rate")
STATES = st.builds(
    VehicleState,
    longitudinal_position=st.floats(0.0, 1500.0),
    lateral_position=st.floats(-6.0, 3.0),
    yaw_angle=st.floats(-0.5, 0.5),
    longitudinal_velocity=st.floats(0.0, 50.0),
    lateral_velocity=st.floats(-3.0, 3.0),
    yaw_rate=st.floats(-1.0, 1.0),
    drive=st.floats(-8.0, 3.0),
)


def start(car: CarParameters, lateral: float = 0.0) -> VehicleState:
    return VehicleState(0.0, lateral, 0.0, SPEED, 0.0, 0.0, resistance(car, SPEED))


def wheel_angle(car: CarParameters, road: Alignment, state: VehicleState) -> float:
    """A driver who holds the wheel for the bend and weaves across both lanes [rad]."""
    bend = bend_at(road, state.longitudinal_position).curvature
    held = steady_steering_wheel_angle(car, SPEED, bend) / car.steering_ratio
    wanted = -1.75 + 1.75 * math.cos(state.longitudinal_position / 80.0)
    off = state.lateral_position - wanted
    return held - 0.004 * off - 0.15 * state.yaw_angle


def both_ways(
    car: CarParameters, seconds: float, gust: float = 0.0
) -> tuple[list[VehicleState], list[VehicleState]]:
    """One drive along the road's coordinates and, with its wheel, in the plane."""
    bent, plane = [start(car)], [start(car)]
    for _ in range(round(seconds / DT)):
        state = bent[-1]
        motion = VehicleInput(
            car=car,
            road_wheel_angle=wheel_angle(car, ROAD, state),
            drive_command=resistance(car, SPEED),
            place=Place(bend_at(ROAD, state.longitudinal_position), gust),
        )
        flat = motion._replace(place=NOWHERE._replace(side_force=gust))
        bent.append(driven(state, motion, DT))
        plane.append(driven(plane[-1], flat, DT))
    return bent, plane


def on_the_plane(state: VehicleState) -> tuple[complex, float]:
    """Where a car along the road is in the plane, by geometry."""
    place, heading = point_on(STATIONS, CURVATURES, state.longitudinal_position)
    across = 1j * complex(math.cos(heading), math.sin(heading))
    return place + state.lateral_position * across, heading + state.yaw_angle


@pytest.mark.parametrize(
    "name",
    ["default", *(pytest.param(n, marks=pytest.mark.slow) for n in sorted(CARS)[::2])],
)
def test_the_curved_road_is_the_plane_seen_along_the_road(name: str) -> None:
    # A minute at 90 km/h from a straight through 500 m to both sides, and across lanes.
    bent, plane = both_ways(CARS[name], 60.0)
    apart, turned = 0.0, 0.0
    for along, flat in zip(bent, plane, strict=True):
        place, heading = on_the_plane(along)
        seen = complex(flat.longitudinal_position, flat.lateral_position)
        apart = max(apart, abs(place - seen))
        turned = max(turned, abs(heading - flat.yaw_angle))
    lateral = [state.lateral_position for state in bent]
    assert bent[-1].longitudinal_position > STATIONS[-1]
    assert min(lateral) < -2.5
    assert max(lateral) > -1.0
    print(f"{name}: {apart * 1e3:.3f} mm, {turned * 1e6:.2f} microrad")
    # The bend is held, and its slope, for a step of 0.4 m: behind a station the road's
    # direction is off by 0.4² / 2 of the step of the slope, 1.4 microrad, at most.
    assert turned < 4.0 * 0.42**2 / 2.0 / (500.0 * 120.0)
    assert apart < 3e-3


def test_wind_moves_the_car_in_the_plane_too() -> None:
    bent, plane = both_ways(DEFAULT_CAR, 10.0, gust=400.0)
    place, _ = on_the_plane(bent[-1])
    seen = complex(plane[-1].longitudinal_position, plane[-1].lateral_position)
    assert abs(place - seen) < 1e-3
    calm, _ = both_ways(DEFAULT_CAR, 10.0)
    assert bent[-1].lateral_position > calm[-1].lateral_position + 0.05


def test_the_road_turns_under_a_car_that_runs_straight() -> None:
    # On a tangent of the circle: s = R atan(x / (R - y0)), y = R - hypot(x, R - y0).
    radius, lateral = 500.0, -3.5
    circle = alignment((0.0,), (1.0 / radius,))
    state = start(DEFAULT_CAR, lateral)._replace(drive=0.0)
    free = DEFAULT_CAR._replace(rolling_resistance=0.0, air_resistance=0.0)
    for _ in range(round(4.0 / DT)):
        bend = bend_at(circle, state.longitudinal_position)
        # No side force may act: the front wheels point where the car goes.
        state = driven(state, VehicleInput(free, 0.0, 0.0, Place(bend)), DT)
    run = SPEED * 4.0
    angle = math.atan(run / (radius - lateral))
    assert state.longitudinal_position == pytest.approx(radius * angle, abs=1e-6)
    beyond = radius - math.hypot(run, radius - lateral)
    assert state.lateral_position == pytest.approx(beyond, abs=1e-6)
    assert state.yaw_angle == pytest.approx(-angle, abs=1e-9)


def test_the_outer_line_of_a_bend_is_longer() -> None:
    # At a lateral position y the way along the road is v / (1 - y / R).
    bend = Place(Bend(0.0, 1.0 / 500.0, 0.0))
    for lateral in (-3.5, 0.0, 3.5):
        rate = vehicle_rate(
            start(DEFAULT_CAR, lateral), VehicleInput(DEFAULT_CAR, 0.0, 0.0, bend)
        )
        expected = SPEED * 500.0 / (500.0 - lateral)
        assert rate.longitudinal_position == pytest.approx(expected, rel=1e-12)


@given(STATES, st.floats(-0.3, 0.3), st.floats(0.0, 1e4))
def test_no_curvature_gives_the_very_bits_of_a_straight_road(
    state: VehicleState, angle: float, place: float
) -> None:
    plain = driven(state, VehicleInput(DEFAULT_CAR, angle, 0.5), DT)
    no_bend = Place(bend_at(STRAIGHT, place))
    assert driven(state, VehicleInput(DEFAULT_CAR, angle, 0.5, no_bend), DT) == plain
    # And those are the bits of planar motion, without a term for the road.
    rate = vehicle_rate(state, VehicleInput(DEFAULT_CAR, angle, 0.5, no_bend))
    cosine, sine = math.cos(state.yaw_angle), math.sin(state.yaw_angle)
    forward, left = state.longitudinal_velocity, state.lateral_velocity
    assert rate.longitudinal_position == forward * cosine - left * sine
    assert rate.yaw_angle == state.yaw_rate


@given(
    STATES,
    st.floats(-0.3, 0.3),
    st.floats(-1 / 300, 1 / 300),
    st.floats(-3e-5, 3e-5),
    st.floats(-2e3, 2e3),
)
def test_a_mirrored_bend_and_gust_move_the_car_in_the_mirror(
    state: VehicleState, angle: float, curvature: float, slope: float, gust: float
) -> None:
    def then(side: float) -> VehicleState:
        turned = {name: side * getattr(state, name) for name in MIRRORED}
        here = VehicleState(**(state._asdict() | turned))
        bend = Bend(state.longitudinal_position, side * curvature, side * slope)
        place = Place(bend, side * gust)
        return driven(here, VehicleInput(DEFAULT_CAR, side * angle, 0.5, place), DT)

    left, right = then(1.0), then(-1.0)
    np.testing.assert_array_equal(
        right,
        [
            -value if name in MIRRORED else value
            for name, value in left._asdict().items()
        ],
    )


def test_a_car_that_has_hit_something_stands() -> None:
    state = start(DEFAULT_CAR, -2.0)._replace(yaw_angle=0.1, yaw_rate=0.3)
    stopped = VehicleInput(DEFAULT_CAR, 0.05, 2.0, Place(stopped=True))
    after = driven(state, stopped, DT)
    assert after == state._replace(
        longitudinal_velocity=0.0, yaw_rate=0.0, lateral_velocity=0.0, drive=0.0
    )
    assert driven(after, stopped, DT) == after
