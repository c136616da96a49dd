"""What the sensors say of a world that is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant import world
from costeer.plant.alignment import Bend
from costeer.plant.parameters import DEFAULT_CAR, RoadParameters
from costeer.plant.steering import ColumnState
from costeer.plant.vehicle import VehicleState
from costeer.plant.world import WorldState
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import (
    HeadTracker,
    SensorParameters,
    measure,
    measured_head_yaw,
)

ROAD = RoadParameters()
SENSORS = SensorParameters()
WORLDS = st.builds(
    WorldState,
    st.builds(
        VehicleState,
        longitudinal_position=st.floats(0.0, 8e3),
        lateral_position=st.floats(-5.0, 1.7),
        yaw_angle=st.floats(-0.3, 0.3),
        longitudinal_velocity=st.floats(5.0, 40.0),
        lateral_velocity=st.floats(-2.0, 2.0),
        yaw_rate=st.floats(-0.5, 0.5),
        drive=st.floats(-4.0, 3.0),
    ),
    st.builds(ColumnState, st.floats(-2.0, 2.0), st.floats(-5.0, 5.0), st.just(0.3)),
)


def measured(state: WorldState) -> Measurement:
    """The sample with 0.7 N·m of the driver and the head at 0.2."""
    return measure(DEFAULT_CAR, ROAD, state, 0.7, HeadTracker(0.2, True))


@given(WORLDS)
def test_the_simulators_own_signals_are_exact(state: WorldState) -> None:
    sample = measured(state)
    for part in (state.vehicle, state.column):
        for name in set(part._fields) & set(Measurement._fields):
            assert getattr(sample, name) == getattr(part, name)
    assert (sample.driver_torque, sample.head_yaw) == (0.7, 0.2)


@given(WORLDS)
def test_the_front_slip_is_where_the_tyre_goes_minus_where_it_points(
    state: WorldState,
) -> None:
    vehicle = state.vehicle
    sideways = vehicle.lateral_velocity + DEFAULT_CAR.front_distance * vehicle.yaw_rate
    pointing = state.column.steering_wheel_angle / DEFAULT_CAR.steering_ratio
    going = math.atan2(sideways, vehicle.longitudinal_velocity)
    # Rounding of angles under one radian.
    assert measured(state).front_slip_angle == pytest.approx(
        going - pointing, abs=1e-14
    )


def test_straight_ahead_at_constant_speed_no_acceleration_is_felt() -> None:
    sample = measured(world.initial_state(DEFAULT_CAR, -3.5, 20.0))
    assert sample.longitudinal_acceleration == 0.0
    assert sample.lateral_acceleration == 0.0
    assert sample.front_slip_angle == 0.0


@pytest.mark.parametrize(
    ("position", "lane", "side", "distance"),
    [(0.5, 1.0, -1.0, 2.25), (-1.5, 1.0, -1.0, 0.25), (-3.0, 0.0, 1.0, 1.25)],
)
def test_the_line_to_the_adjacent_lane_is_measured_in_the_lane_the_car_is_in(
    position: float, lane: float, side: float, distance: float
) -> None:
    sample = measured(world.initial_state(DEFAULT_CAR, position, 20.0))
    assert (sample.lane, sample.side) == (lane, side)
    assert sample.distance_to_adjacent_lane == distance


@given(st.floats(-1.0, 1.0), st.floats(-4.0, 4.0))
def test_a_measured_head_stays_within_what_heads_do(head: float, draw: float) -> None:
    yaw = measured_head_yaw(SENSORS, head, draw)
    assert -1.0 <= yaw <= 1.0
    assert yaw == pytest.approx(
        min(max(head + draw / 90.0, -1.0), 1.0)
    )  # one degree of ninety


@pytest.mark.parametrize(
    ("yaw", "seen", "valid"),
    [(0.4, True, True), (0.4, False, False), (math.nan, True, False)],
)
def test_a_head_is_valid_if_it_is_seen_and_known(
    yaw: float, seen: bool, valid: bool
) -> None:
    car = world.initial_state(DEFAULT_CAR, 0.0, 20.0)
    sample = measure(DEFAULT_CAR, ROAD, car, 0.0, HeadTracker(yaw, seen))
    assert sample.head_yaw == pytest.approx(yaw, nan_ok=True)
    assert sample.head_yaw_valid == valid


def test_a_batch_gives_what_its_members_give() -> None:
    positions = np.linspace(-5.0, 1.5, 8)
    angles = np.linspace(-1.0, 1.0, 8)

    def turned(position: float, angle: float) -> Measurement:
        state = world.initial_state(DEFAULT_CAR, position, 20.0)
        return measured(state._replace(column=ColumnState(angle, 0.0, 0.0)))

    batch = turned(positions, angles)
    for k, pair in enumerate(zip(positions.tolist(), angles.tolist(), strict=True)):
        member = turned(*pair)
        for name in ("lane", "side", "front_slip_angle", "lateral_acceleration"):
            # NumPy's tangent may differ in the last place.
            assert getattr(batch, name)[k] == pytest.approx(getattr(member, name))


def test_the_bend_of_the_road_is_measured_where_the_car_is() -> None:
    state = world.initial_state(DEFAULT_CAR, 0.0, 20.0)
    head = HeadTracker(0.0, True)
    bent = measure(DEFAULT_CAR, ROAD, state, 0.0, head, Bend(0.0, -0.002, 1e-5))
    assert (bent.road_curvature, bent.road_curvature_slope) == (-0.002, 1e-5)
    straight = measure(DEFAULT_CAR, ROAD, state, 0.0, head)
    assert (straight.road_curvature, straight.road_curvature_slope) == (0.0, 0.0)
    assert bent._replace(road_curvature=0.0, road_curvature_slope=0.0) == straight
