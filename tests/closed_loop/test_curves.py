"""Strong guidance without hands on curves: the bounds of the specification."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.hands_off import hands_off_setup
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS
from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import Bent, Road, Scenario
from costeer.scenarios.reading import scenario_named

RADIUS = 500.0
SPIRAL = 150.0
BEGINS, ENDS = 300.0, 1500.0
"""Of the arc along the road [m]."""

PATH_ERROR, STEADY_OFFSET = 0.25, 0.1
"""Bounds of the issue at 90 km/h [m]."""


def road(radius: float) -> Road:
    """A straight, a clothoid, an arc, a clothoid, a straight."""
    stations = (
        Bent(BEGINS - SPIRAL),
        Bent(BEGINS, radius),
        Bent(ENDS, radius),
        Bent(ENDS + SPIRAL),
    )
    return Road(length=2000.0, stations=stations)


def setup(car: str, kmh: float, radius: float) -> TrialSetup:
    speed = kmh / 3.6
    return hands_off_setup(car, speed, 2000.0 / speed)._replace(
        scenario=Scenario("bend", road=road(radius))
    )


@cache
def drive(car: str, kmh: float = 90.0, radius: float = RADIUS) -> TrialRecord:
    return simulate_trial(setup(car, kmh, radius))


@cache
def change(car: str) -> TrialRecord:
    """The same with a lane change asked for in the middle of the arc."""
    trial = setup(car, 90.0, RADIUS)
    return simulate_trial(trial._replace(trigger_times=(700.0 / trial.speed,)))


def path_error(record: TrialRecord) -> float:
    columns = record.columns
    off = columns["lateral_position"] - columns["target_lateral_position"]
    return float(np.abs(off).max())


def on_the_arc(record: TrialRecord) -> NDArray[np.float64]:
    """Lateral positions from where the way into the bend has died out [m]."""
    place = record.columns["longitudinal_position"]
    lateral: NDArray[np.float64] = record.columns["lateral_position"]
    return lateral[(place > BEGINS + 500.0) & (place < ENDS)]


@pytest.mark.parametrize("car", sorted(CARS))
def test_no_car_leaves_its_path_or_cuts_the_bend(car: str) -> None:
    error, offset = path_error(drive(car)), abs(on_the_arc(drive(car)).mean())
    print(f"{car}: path error {error:.3f} m, steady offset {offset:.3f} m")
    assert np.abs(drive(car).columns["road_curvature"]).max() == 1.0 / RADIUS
    assert error < PATH_ERROR
    assert offset < STEADY_OFFSET


@pytest.mark.parametrize("car", sorted(CARS))
def test_a_lane_change_inside_the_bend_keeps_its_path(car: str) -> None:
    record = change(car)
    error = path_error(record)
    print(f"{car}: path error {error:.3f} m")
    assert error < PATH_ERROR
    late = record.columns["time"] > 700.0 / (90.0 / 3.6) + 9.0
    inside = late & (record.columns["longitudinal_position"] < ENDS)
    ended = record.columns["lateral_position"][inside]
    assert set(record.columns["lane"][inside]) == {0}
    assert abs(ended.mean() + 3.5) < STEADY_OFFSET


@pytest.mark.slow
@pytest.mark.parametrize("car", sorted(CARS))
def test_the_bounds_hold_at_110_km_h_too(car: str) -> None:
    error = path_error(drive(car, 110.0))
    print(f"{car} at 110 km/h: path error {error:.3f} m")
    assert error < PATH_ERROR


def test_a_right_bend_is_the_mirror_image_of_a_left_one() -> None:
    # On the reference line itself, so that both lines are equally long.
    left, right = drive("default").columns, drive("default", 90.0, -RADIUS).columns
    for name in ("lateral_position", "steering_wheel_angle", "applied_torque"):
        np.testing.assert_array_equal(left[name], -right[name])
    for name in ("longitudinal_position", "longitudinal_velocity"):
        np.testing.assert_array_equal(left[name], right[name])


def test_the_wheel_stands_as_steady_cornering_asks() -> None:
    # Ackermann and understeer: i (L + K v²) / R with the car's own values.
    car, speed = CARS["default"], 90.0 / 3.6
    base = car.front_distance + car.rear_distance
    rear = car.rear_distance / car.front_cornering_stiffness
    front = car.front_distance / car.rear_cornering_stiffness
    understeer = car.mass * (rear - front) / base
    expected = car.steering_ratio * (base + understeer * speed**2) / RADIUS
    columns = drive("default").columns
    place = columns["longitudinal_position"]
    inside = (place > BEGINS + 500.0) & (place < ENDS)
    angle = columns["steering_wheel_angle"][inside].mean()
    assert angle == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("car", sorted(CARS))
def test_among_other_cars_the_guidance_keeps_its_lane(car: str) -> None:
    trial = setup(car, 80.0, RADIUS)
    dense = scenario_named("dense-traffic")
    scenario = dense._replace(road=road(RADIUS))
    record = simulate_trial(trial._replace(scenario=scenario))
    error = path_error(record)
    slowest = record.columns["longitudinal_velocity"].min() * 3.6
    print(f"{car}: path error {error:.3f} m, slowest {slowest:.0f} km/h")
    assert record.columns["contact"][-1] == 0
    assert slowest < 78.0  # the others hold it up
    assert error < PATH_ERROR


@pytest.mark.slow
@pytest.mark.parametrize("car", sorted(CARS))
def test_the_shipped_curves_are_driven_without_hands(car: str) -> None:
    trial = hands_off_setup(car, 25.0, 320.0)
    error = path_error(simulate_trial(trial._replace(scenario="expressway-curves")))
    print(f"{car}: path error {error:.3f} m at 90 km/h")
    assert error < PATH_ERROR
