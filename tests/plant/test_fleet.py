"""The other cars: what each meets, when it appears, what it is told, how it moves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from costeer.plant.fleet import (
    AT_PLACE,
    AT_TIME,
    CARS,
    FROM_START,
    MOST_CARS,
    TIME_TO_COLLISION,
    WITHIN,
    Car,
    CarKind,
    Fleet,
    FleetParameters,
    Order,
    fleet_parameters,
    initial_fleet,
    with_ego,
    write_cars,
)
from costeer.plant.fleet_motion import World, moved
from costeer.plant.following import LONGEST_GAP, FollowingParameters
from costeer.plant.outlook import NOBODY, Spot, neighbours, outlook
from costeer.plant.parameters import RoadParameters

DT = 1.0 / 20.0
"""Three times the control step: plain Python moves the cars here."""
ROAD = RoadParameters()
THREE = RoadParameters(num_lanes=3.0)
LAW = FollowingParameters()
EGO_SPEED = 20.0


def ego_at(position: float, lateral: float = 0.0, speed: float = EGO_SPEED) -> Car:
    lane = 1.0 if lateral > -1.75 else 0.0
    return Car(1.0, position, lateral, speed, lane=lane, desired=speed)


def there(position: float, lane: float = 1.0, **about: Any) -> CarKind:
    """A car from the start on a two-lane road, with the ego car's speed."""
    settings = {"trigger": float(FROM_START), "velocity": EGO_SPEED} | about
    settings.setdefault("desired", settings["velocity"])
    return CarKind(position=position, lateral=3.5 * (lane - 1.0), lane=lane, **settings)


def drive(
    parameters: FleetParameters,
    seconds: float,
    road: RoadParameters = ROAD,
    ego_speed: float = EGO_SPEED,
    ego_lateral: float = 0.0,
) -> list[list[Car]]:
    """Where all cars are after each step; the driven car runs straight on."""
    fleet, history = initial_fleet(parameters), []
    used = range(int(parameters.num_places))
    for k in range(round(seconds / DT)):
        ego = ego_at(ego_speed * k * DT, ego_lateral, ego_speed)
        fleet = with_ego(fleet, ego)
        fleet = moved(parameters, fleet, World(road, LAW, k * DT, DT))
        history.append([CARS.read(fleet.cars, place) for place in used])
    return history


def placed(*cars: Car) -> Fleet:
    """A fleet with the driven car at 0 and others where they are told to be."""
    fleet = initial_fleet(fleet_parameters(()))
    for place, car in enumerate((ego_at(0.0), *cars)):
        CARS.write(fleet.cars, place, car)
    return fleet


def test_gaps_are_from_bumper_to_bumper_to_the_next_car_each_way() -> None:
    kinds = [there(0.0), there(0.0, length=12.0, width=2.5), there(0.0), there(0.0)]
    parameters = fleet_parameters(kinds, own=CarKind(length=4.0))
    fleet = placed(
        Car(1.0, 90.0, 0.0, 21.0),
        Car(1.0, 50.0, 0.3, 19.0, desired=24.0),
        Car(1.0, -30.0, 0.0, 22.0),
        Car(0.0, 10.0, 0.0, 1.0),  # not on the road
    )
    seen = outlook(parameters, fleet, Spot(0, 0.0, 0.0, 0.9))
    assert seen.ahead.gap == pytest.approx(50.0 - (12.0 + 4.0) / 2.0)
    assert seen.ahead[1:] == (19.0, 24.0, 0.3, 2.5)
    assert seen.behind.gap == pytest.approx(30.0 - (4.5 + 4.0) / 2.0)
    assert seen.behind.velocity == 22.0


@pytest.mark.parametrize(
    ("lateral", "is_seen"), [(1.79, True), (-1.79, True), (1.81, False), (-3.5, False)]
)
def test_a_car_is_in_the_way_if_it_reaches_into_the_own_band(
    lateral: float, is_seen: bool
) -> None:
    parameters = fleet_parameters([there(0.0)])
    seen = outlook(parameters, placed(Car(1.0, 40.0, lateral)), Spot(0, 0.0, 0.0, 0.9))
    assert (seen.ahead.gap < LONGEST_GAP) == is_seen


def test_a_car_on_its_way_to_a_lane_counts_there_already() -> None:
    parameters = fleet_parameters([there(0.0)])
    fleet = placed(Car(1.0, 40.0, -3.5, 20.0, lane=1.0))
    around = neighbours(parameters, fleet, ROAD, 0.0)
    assert around.left.ahead.gap == pytest.approx(35.5)  # its new lane
    assert around.own.ahead.gap == LONGEST_GAP  # in the ego car's way it is not yet


def test_an_empty_road_shows_nobody() -> None:
    parameters = fleet_parameters(())
    around = neighbours(parameters, placed(), ROAD, 1.0)
    for lane in (around.own, around.left, around.right):
        assert lane.ahead.gap == lane.behind.gap == LONGEST_GAP
    assert around == NOBODY


def test_forty_cars_drive_and_a_forty_first_is_refused() -> None:
    many = [there(60.0 * (k + 1), k % 2) for k in range(MOST_CARS)]
    last = drive(fleet_parameters(many), 0.1)[-1]
    assert len(last) == MOST_CARS + 1
    assert all(car.present == 1.0 for car in last[1:])
    assert last[-1].position == pytest.approx(60.0 * MOST_CARS + 0.1 * EGO_SPEED)
    with pytest.raises(ValueError, match="41 other cars; give at most 40"):
        fleet_parameters([*many, there(0.0)])


def first_present(parameters: FleetParameters, seconds: float) -> float:
    """When the first other car appears [s]."""
    seen = [cars[1].present for cars in drive(parameters, seconds)]
    return seen.index(1.0) * DT


@pytest.mark.parametrize(
    ("trigger", "value", "time"),
    [
        (FROM_START, 0.0, 0.0),
        (AT_TIME, 1.5, 1.5),
        (AT_PLACE, 25.0, 25.0 / EGO_SPEED),
        # A stopped car at 100 m: its gap, middle to middle, is 100 - v t.
        (WITHIN, 40.0, 60.0 / EGO_SPEED),
    ],
)
def test_a_car_appears_at_its_trigger(trigger: int, value: float, time: float) -> None:
    kind = there(100.0, velocity=0.0, trigger=float(trigger), value=value)
    found = first_present(fleet_parameters([kind]), 5.0)
    assert found == pytest.approx(time, abs=1.01 * DT)


def test_a_headway_is_the_time_to_collision_with_something_that_stands() -> None:
    own = CarKind(length=4.0)
    kind = CarKind(length=1.0, trigger=float(AT_PLACE), value=10.0, headway=2.5)
    history = drive(fleet_parameters([kind], own=own), 1.0)
    k = [cars[1].present for cars in history].index(1.0)
    ego, obstacle = history[k]
    gap = obstacle.position - ego.position - (4.0 + 1.0) / 2.0
    assert gap / EGO_SPEED == pytest.approx(2.5)
    assert obstacle.velocity == 0.0
    assert history[-1][1].position == obstacle.position


def test_orders_are_given_once_each_at_their_moment() -> None:
    # Slower at 1 s, faster at 2 s: an order that was given again would undo the other.
    kind = there(
        200.0,
        first=Order(float(AT_TIME), 1.0, velocity=15.0, rate=10.0),
        second=Order(float(AT_TIME), 2.0, velocity=22.0, rate=3.0),
    )
    history = drive(fleet_parameters([kind]), 5.5)
    speeds = np.array([cars[1].velocity for cars in history])
    times = (1.0 + np.arange(len(speeds))) * DT
    # 20 m/s; 10 m/s² down from 1 s to 1.5 s; 3 m/s² up from 2 s to 4.33 s; 22 m/s.
    wanted = np.interp(times, [0, 1, 1.5, 2, 2 + 7 / 3, 9], [20, 20, 15, 15, 22, 22])
    np.testing.assert_allclose(speeds, wanted, atol=10.0 * DT + 1e-9)
    assert [history[-1][1][k] for k in (-3, -2, -1)] == [1.0, 1.0, 0.0]


def test_an_order_waits_until_the_car_is_there() -> None:
    kind = there(
        200.0,
        trigger=float(AT_TIME),
        value=2.0,
        first=Order(float(AT_TIME), 1.0, velocity=15.0, rate=10.0),
    )
    history = drive(fleet_parameters([kind]), 2.5)
    assert history[round(1.5 / DT)][1].velocity == EGO_SPEED
    assert history[-1][1].velocity == pytest.approx(15.0, abs=0.1)


def ordered_at(trigger: int, value: float) -> float:
    """Gap, middle to middle, at which a slower car at 60 m gets its order [m]."""
    order = Order(float(trigger), value, lane=0.0)
    kind = there(60.0, velocity=12.0, first=order)
    for cars in drive(fleet_parameters([kind]), 6.0):
        if cars[1].first > 0.5:
            return cars[1].position - cars[0].position
    return math.nan


def test_an_order_by_gap_comes_at_that_gap() -> None:
    assert ordered_at(WITHIN, 32.0) == pytest.approx(32.0, abs=EGO_SPEED * DT)


def test_an_order_by_time_to_collision_comes_at_that_time() -> None:
    # Bumpers are 4.5 m nearer than middles; a closing of 8 m/s.
    gap = ordered_at(TIME_TO_COLLISION, 4.0)
    assert (gap - 4.5) / 8.0 == pytest.approx(4.0, abs=3.0 * DT)


def test_a_lane_change_of_another_car_is_smooth_and_ends_in_the_centre() -> None:
    kind = there(80.0, offset=0.2, first=Order(float(AT_TIME), 1.0, lane=0.0))
    kind = kind._replace(lateral=0.2)
    history = drive(fleet_parameters([kind]), 7.0)
    lateral = np.array([cars[1].lateral for cars in history])
    first, last = round(1.0 / DT), round((1.0 + LAW.change_duration) / DT)
    np.testing.assert_array_equal(lateral[: first - 1], 0.2)
    np.testing.assert_allclose(lateral[last + 2 :], -3.3, atol=1e-12)
    assert (np.diff(lateral) <= 1e-12).all()
    # Least jerk: 15/8 of the mean speed in the middle, 10/√3 w/T² acceleration.
    speed = np.diff(lateral) / DT
    assert np.abs(speed).max() == pytest.approx(1.875 * 3.5 / 4.5, rel=1e-2)
    acceleration = np.diff(speed) / DT
    assert np.abs(acceleration).max() == pytest.approx(
        10.0 / math.sqrt(3.0) * 3.5 / 4.5**2, rel=2e-2
    )
    middle = lateral[(first + last) // 2]
    assert middle == pytest.approx(0.2 - 1.75, abs=0.05)


@pytest.mark.slow
def test_a_car_that_follows_keeps_its_distance_to_the_driven_car() -> None:
    behind = there(-50.0, velocity=23.0, desired=30.0, follows=1.0)
    history = drive(fleet_parameters([behind]), 45.0)
    # The driven car has not moved yet at this step.
    ahead = history[-1][0].position + EGO_SPEED * DT
    gap = ahead - history[-1][1].position - 4.5
    expected = (2.0 + 1.6 * EGO_SPEED) / math.sqrt(1.0 - (EGO_SPEED / 30.0) ** 4)
    assert history[-1][1].velocity == pytest.approx(EGO_SPEED, abs=0.05)
    assert gap == pytest.approx(expected, abs=0.1)


def test_a_car_without_a_law_keeps_its_speed_whatever_is_ahead() -> None:
    blind = there(50.0, velocity=12.5)
    last = drive(fleet_parameters([blind, there(70.0, velocity=5.0)]), 4.0)[-1]
    assert last[1].position == pytest.approx(50.0 + 12.5 * 4.0)
    assert last[1].velocity == 12.5


@pytest.mark.slow
def test_a_faster_car_overtakes_the_driven_one_and_returns() -> None:
    fast = there(-80.0, velocity=28.0, desired=28.0, follows=1.0, changes=1.0)
    history = drive(fleet_parameters([fast]), 40.0)
    lanes = [cars[1].lane for cars in history]
    assert lanes[0] == 1.0 == lanes[-1]
    assert 0.0 in lanes
    beside = [c[1].lateral for c in history if abs(c[1].position - c[0].position) < 4.5]
    assert beside
    assert max(beside) < -1.8  # a car's width from the ego car's centre


def test_overtaking_is_the_mirror_image_under_the_other_traffic() -> None:
    home, ego = 1.0, 0.0
    fast = there(-80.0, home, velocity=28.0, desired=28.0, follows=1.0, changes=1.0)
    slow = there(120.0, home, velocity=18.0, follows=1.0)
    parameters = fleet_parameters([fast, slow])
    history = drive(parameters, 10.0, ROAD, ego_lateral=ego)
    lateral = np.array([[car.lateral for car in cars[1:]] for cars in history])
    place = np.array([[car.position for car in cars[1:]] for cars in history])
    other = ROAD._replace(overtaking_side=1.0)
    kinds = [
        kind._replace(lane=1.0 - home, lateral=-3.5 - kind.lateral)
        for kind in (fast, slow)
    ]
    mirror = drive(fleet_parameters(kinds), 10.0, other, ego_lateral=-3.5 - ego)
    np.testing.assert_allclose(
        lateral,
        [[-3.5 - car.lateral for car in cars[1:]] for cars in mirror],
        atol=1e-9,
    )
    np.testing.assert_allclose(
        place, [[car.position for car in cars[1:]] for cars in mirror], atol=1e-9
    )
    assert np.abs(np.diff(lateral[:, 0])).max() > 0.0


def test_nobody_leaves_the_road_by_a_lane_change() -> None:
    # Two cars that both would like to pass a slow one, on a road of one lane.
    lone = RoadParameters(num_lanes=1.0)
    kinds = [
        CarKind(position=-40.0 * k, velocity=25.0, desired=30.0, follows=1.0)._replace(
            changes=1.0, trigger=float(FROM_START)
        )
        for k in range(1, 3)
    ]
    history = drive(fleet_parameters(kinds), 5.0, lone, ego_speed=15.0)
    assert {car.lane for cars in history for car in cars[1:]} == {0.0}


def test_a_car_of_a_stream_comes_in_again_at_the_other_end() -> None:
    slow = there(-20.0, 0.0, velocity=10.0, streams=1.0, follows=1.0)
    single = there(-20.0, velocity=10.0)
    history = drive(fleet_parameters([slow, single], reach=50.0), 6.0)
    away = np.array(
        [[c.position - cars[0].position for c in cars[1:]] for cars in history]
    )
    jumps = np.flatnonzero(np.diff(away[:, 0]) > 50.0)
    assert len(jumps) == 1
    assert away[jumps[0], 0] == pytest.approx(-50.0, abs=0.5)
    assert away[jumps[0] + 1, 0] == pytest.approx(50.0, abs=0.5)
    assert (np.diff(away[:, 1]) < 0.0).all()  # who is no stream stays behind


def ring(speeds: list[float], reach: float) -> FleetParameters:
    """Cars of a stream in one lane, evenly over twice the reach."""
    step = 2.0 * reach / len(speeds)
    return fleet_parameters(
        [
            there(step * (k + 0.5) - reach, 0.0, velocity=v, streams=1.0, follows=1.0)
            for k, v in enumerate(speeds)
        ],
        reach=reach,
    )


@pytest.mark.slow
def test_a_stream_does_not_thin_out() -> None:
    # 40 m to each car: less than following keeps free to both sides of a newcomer.
    history = drive(ring([24.0, 17.0, 23.0, 18.0, 22.0], reach=100.0), 40.0)
    away = np.array(
        [[c.position - cars[0].position for c in cars[1:]] for cars in history]
    )
    assert np.abs(away).max() < 101.5
    assert np.count_nonzero(np.abs(np.diff(away, axis=0)) > 150.0) >= 3
    # Each follows the next one, around the ring: nobody ends up in another.
    order = np.sort(away, axis=1)
    gaps = np.diff(np.concatenate([order, order[:, :1] + 200.0], axis=1), axis=1)
    assert gaps.min() > 4.5 + 2.0


def test_cars_of_a_stream_see_each_other_across_its_ends() -> None:
    parameters = ring([20.0, 20.0], reach=100.0)
    fleet = placed(Car(1.0, -90.0, 0.0, 21.0), Car(1.0, 95.0, 0.0, 19.0))
    seen = outlook(parameters, fleet, Spot(2, 95.0, 0.0, 0.9))
    assert seen.ahead.gap == pytest.approx(200.0 - 185.0 - 4.5)
    assert seen.ahead.velocity == 21.0
    # The driven car is in no stream, and is not seen around the ring.
    assert seen.behind.gap == pytest.approx(95.0 - 4.5)
    own = outlook(parameters, fleet, Spot(0, 0.0, 0.0, 0.9))
    assert own.behind.gap == pytest.approx(90.0 - 4.5)


def test_a_car_of_a_stream_waits_while_another_is_where_it_would_come_in() -> None:
    slow = there(-40.0, 0.0, velocity=10.0, streams=1.0, follows=1.0)
    there_already = there(50.0, 0.0, velocity=EGO_SPEED)
    history = drive(fleet_parameters([slow, there_already], reach=50.0), 6.0)
    assert history[-1][1].position < history[-1][0].position - 50.0


def test_rows_say_where_cars_are_that_are_on_the_road() -> None:
    parameters = fleet_parameters(
        [there(60.0, 0.0), there(9.0, trigger=1.0, value=9.0)]
    )
    fleet = moved(
        parameters,
        with_ego(initial_fleet(parameters), ego_at(0.0)),
        World(ROAD, LAW, 0.0, DT),
    )
    row = np.full(8, 7.0)
    write_cars(row, 2, fleet)
    np.testing.assert_allclose(row[:5], [7.0, 7.0, 60.0 + 20.0 * DT, -3.5, 20.0])
    assert np.isnan(row[5:]).all()


def test_a_second_lane_change_begins_where_the_car_is() -> None:
    orders = [
        Order(float(AT_TIME), time, lane=to) for time, to in ((0.5, 0.0), (3.0, 1.0))
    ]
    kind = there(80.0, first=orders[0], second=orders[1])
    history = drive(fleet_parameters([kind]), 8.0)
    lateral = np.array([cars[1].lateral for cars in history])
    # Turned back half-way, without a jump: never faster than a whole change is.
    assert -3.5 < lateral.min() < -1.0
    assert np.abs(np.diff(lateral)).max() <= 1.875 * 3.5 / 4.5 * DT * 1.01
    assert lateral[-1] == pytest.approx(0.0, abs=1e-12)
