"""Signals of Eq. (1): order, mirror, scale."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.intention.features import (
    FEATURE_LIMIT,
    FEATURES,
    INPUTS,
    NUM_FEATURES,
    NUM_SCALED,
    VARIANTS,
    IntentionSample,
    adjacent_side,
    approach_series,
    approach_velocity,
    beyond_bend,
    curvature_series,
    facing,
    feature_series,
    full_windows,
    hide,
    mirrored,
    network_inputs,
    scaled,
    valid_samples,
)
from costeer.plant.parameters import CARS, DEFAULT_CAR, CarParameters

BENDS = st.floats(-1.0 / 300.0, 1.0 / 300.0)
SPEEDS = st.floats(10.0, 40.0)

SAMPLE = IntentionSample(
    head_yaw=0.5,
    longitudinal_acceleration=1.0,
    longitudinal_velocity=20.0,
    steering_wheel_angle=0.1,
    distance_to_adjacent_lane=1.2,
    yaw_angle=0.02,
)


def test_signals_stand_in_the_order_of_the_paper() -> None:
    assert FEATURES == (
        "head_yaw",
        "longitudinal_acceleration",
        "longitudinal_velocity",
        "steering_wheel_angle",
        "distance_to_adjacent_lane",
        "yaw_angle",
    )


def test_an_adjacent_lane_on_the_right_leaves_the_sample_alone() -> None:
    assert facing(SAMPLE, -1.0) == SAMPLE


def test_an_adjacent_lane_on_the_left_mirrors_what_has_a_side() -> None:
    turned = facing(SAMPLE, 1.0)
    assert turned == IntentionSample(-0.5, 1.0, 20.0, -0.1, 1.2, -0.02)
    assert facing(turned, 1.0) == SAMPLE


def test_a_series_equals_its_samples() -> None:
    rows = np.random.default_rng(0).normal(size=(20, 6))
    side = np.where(np.arange(20) < 7, -1, 1).astype(np.int8)
    series = feature_series(dict(zip(FEATURES, rows.T, strict=True)), side)
    for row, one_side, faced in zip(rows, side, series, strict=True):
        assert tuple(faced) == facing(IntentionSample(*row), float(one_side))


def test_the_adjacent_lane_lies_left_of_the_right_lane() -> None:
    np.testing.assert_array_equal(adjacent_side(np.array([0, 1])), [1, -1])


def test_a_third_lane_is_refused() -> None:
    with pytest.raises(ValueError, match=r"\[2\].*0 \(right\) and 1 \(left\)"):
        adjacent_side(np.array([0, 1, 2]))


def test_scaling_keeps_nan_and_holds_the_rest_within_the_limit() -> None:
    values = np.array([[np.nan, 1e30, -1e30, 3.0, 2.0, 1.0]])
    result = scaled(values, np.full(6, 1.0), np.full(6, 2.0))[0]
    assert np.isnan(result[0])
    np.testing.assert_array_equal(
        result[1:], [FEATURE_LIMIT, -FEATURE_LIMIT, 1.0, 0.5, 0.0]
    )


@given(st.floats(1.0, 60.0), st.floats(1.0, 60.0), st.floats(-0.2, 0.2))
def test_the_same_motion_in_the_lane_approaches_alike_at_every_speed(
    one_speed: float, other_speed: float, sine: float
) -> None:
    # Scaled so that v sin(yaw) is the same and the larger yaw keeps its sine.
    lateral = sine * min(one_speed, other_speed)
    one, other = (
        approach_velocity(speed, math.asin(lateral / speed))
        for speed in (one_speed, other_speed)
    )
    # Two functions and their inverse, each rounded to 1e-16, of at most 12 m/s.
    assert one == pytest.approx(-lateral, abs=1e-13)
    assert other == pytest.approx(one, abs=1e-13)


def test_a_car_that_points_right_approaches_the_line_on_the_right() -> None:
    assert approach_velocity(20.0, -0.02) > 0.0
    assert approach_velocity(20.0, 0.0) == 0.0


def test_an_approach_without_velocity_or_yaw_is_unknown() -> None:
    rows = np.tile(np.array(SAMPLE), (4, 1))
    rows[1, FEATURES.index("yaw_angle")] = np.nan
    rows[2, FEATURES.index("longitudinal_velocity")] = np.nan
    rows[3, FEATURES.index("yaw_angle")] = np.inf
    np.testing.assert_array_equal(
        np.isnan(approach_series(rows)), [False, True, True, True]
    )


def test_a_series_in_the_mirror_is_that_of_the_other_side() -> None:
    rows = np.random.default_rng(0).normal(size=(20, 6))
    side = np.where(np.arange(20) < 7, -1, 1).astype(np.int8)
    named = dict(zip(FEATURES, rows.T, strict=True))
    series = feature_series(named, side)
    np.testing.assert_array_equal(mirrored(series), feature_series(named, -side))
    np.testing.assert_array_equal(mirrored(mirrored(series)), series)


def test_a_missing_signal_is_its_mean_and_raises_its_flag_alone() -> None:
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(NUM_FEATURES, NUM_FEATURES))
    mean, scale = rng.normal(size=NUM_SCALED), rng.uniform(0.5, 2.0, NUM_SCALED)
    whole = network_inputs(rows, mean, scale)
    assert whole.shape[1] == len(INPUTS)
    assert (whole[:, NUM_SCALED:] == 0.0).all()
    np.fill_diagonal(rows, np.nan)
    values, flags = np.split(network_inputs(rows, mean, scale), [NUM_SCALED], axis=1)
    np.testing.assert_array_equal(flags, np.eye(NUM_FEATURES))
    lost = np.isnan(np.column_stack([rows, approach_series(rows)]))
    np.testing.assert_array_equal(values == 0.0, lost)
    np.testing.assert_array_equal(values[~lost], whole[:, :NUM_SCALED][~lost])


@pytest.mark.parametrize("broken", [math.nan, math.inf])
def test_only_a_head_can_be_lost(broken: float) -> None:
    features = np.zeros((NUM_FEATURES, NUM_FEATURES))
    np.fill_diagonal(features, broken)
    lost_head = [n == "head_yaw" and math.isnan(broken) for n in FEATURES]
    np.testing.assert_array_equal(valid_samples(features), lost_head)
    absent = ("head_yaw", "yaw_angle")
    np.testing.assert_array_equal(
        valid_samples(features, absent), [n in absent for n in FEATURES]
    )


def test_a_window_is_full_after_180_valid_samples() -> None:
    features = np.zeros((600, 6))
    features[250, 3] = np.nan
    full = np.flatnonzero(full_windows(features))
    np.testing.assert_array_equal(
        full, np.concatenate([np.arange(179, 250), np.arange(430, 600)])
    )
    without = np.flatnonzero(full_windows(features, ("steering_wheel_angle",)))
    np.testing.assert_array_equal(without, np.arange(179, 600))


def test_what_is_hidden_is_hidden_in_a_copy() -> None:
    rows = np.ones((3, 2, 6))
    hidden = hide(rows, ("head_yaw", "yaw_angle"))
    assert np.isnan(hidden[..., [0, 5]]).all()
    assert (hidden[..., 1:5] == 1.0).all()
    assert (rows == 1.0).all()


def test_no_variant_lacks_the_velocity_and_the_first_lacks_nothing() -> None:
    assert all("longitudinal_velocity" not in absent for absent in VARIANTS.values())
    assert next(iter(VARIANTS.values())) == ()


def on_circle(car: CarParameters, speed: float, curvature: float) -> IntentionSample:
    """A car that drives along a circle, from the force that each axle has to give.

    The lateral forces m v² kappa b / L in front and m v² kappa a / L behind need slip
    angles; the wheel points where the front axle goes and by its slip angle further,
    and the car out of its own way by what the rear axle's radius and slip ask for.
    """
    length = car.front_distance + car.rear_distance
    force = car.mass * speed**2 * curvature / length
    front_slip = force * car.rear_distance / car.front_cornering_stiffness
    rear_slip = force * car.front_distance / car.rear_cornering_stiffness
    sideslip = car.rear_distance * curvature - rear_slip
    front_way = sideslip + car.front_distance * curvature
    return SAMPLE._replace(
        longitudinal_velocity=speed,
        steering_wheel_angle=car.steering_ratio * (front_way + front_slip),
        yaw_angle=-sideslip,
    )


@pytest.mark.parametrize("car", CARS.values(), ids=CARS)
@given(speed=SPEEDS, curvature=BENDS)
def test_a_circle_looks_as_a_straight_road(
    car: CarParameters, speed: float, curvature: float
) -> None:
    seen = beyond_bend(car, on_circle(car, speed, curvature), curvature)
    straight = on_circle(car, speed, 0.0)
    # Angles of at most 3 rad from some ten roundings.
    assert seen == pytest.approx(straight, rel=0.0, abs=1e-14)


@given(speed=SPEEDS, curvature=BENDS, angle=st.floats(-0.3, 0.3))
def test_what_is_steered_more_than_the_bend_asks_is_seen_whole(
    speed: float, curvature: float, angle: float
) -> None:
    circle = on_circle(DEFAULT_CAR, speed, curvature)
    more = circle._replace(
        steering_wheel_angle=circle.steering_wheel_angle + angle,
        yaw_angle=circle.yaw_angle + angle / 10.0,
    )
    seen = beyond_bend(DEFAULT_CAR, more, curvature)
    assert seen.steering_wheel_angle == pytest.approx(angle, abs=1e-14)
    assert seen.yaw_angle == pytest.approx(angle / 10.0, abs=1e-14)


@given(speed=SPEEDS, angle=st.floats(-3.0, 3.0), yaw=st.floats(-0.2, 0.2))
def test_on_a_straight_road_nothing_is_taken_off(
    speed: float, angle: float, yaw: float
) -> None:
    sample = SAMPLE._replace(
        longitudinal_velocity=speed, steering_wheel_angle=angle, yaw_angle=yaw
    )
    assert beyond_bend(DEFAULT_CAR, sample, 0.0) == sample


@given(speed=SPEEDS, curvature=BENDS, side=st.sampled_from([-1.0, 1.0]))
def test_a_bend_in_the_mirror_looks_the_same(
    speed: float, curvature: float, side: float
) -> None:
    sample = SAMPLE._replace(longitudinal_velocity=speed)
    mirror = sample._replace(head_yaw=-0.5, steering_wheel_angle=-0.1, yaw_angle=-0.02)
    here = facing(beyond_bend(DEFAULT_CAR, sample, curvature), side)
    there = facing(beyond_bend(DEFAULT_CAR, mirror, -curvature), -side)
    assert here == there


def test_a_series_in_bends_equals_its_samples() -> None:
    rng = np.random.default_rng(0)
    rows, side = rng.normal(size=(20, 6)), np.ones(20, np.int8)
    columns = dict(zip(FEATURES, rows.T, strict=True))
    columns["road_curvature"] = rng.uniform(-0.002, 0.002, 20)
    columns["lateral_position"] = rng.uniform(-3.5, 0.0, 20)
    car = CARS["compact"]
    places = zip(columns["road_curvature"], columns["lateral_position"], strict=True)
    for row, (bend, place), seen in zip(
        rows, places, feature_series(columns, side, car), strict=True
    ):
        # A line beside the reference line has its radius less the distance.
        line = 1.0 / (1.0 / bend - place)
        one = beyond_bend(car, IntentionSample(*row), line)
        assert seen == pytest.approx(tuple(facing(one, 1.0)), rel=1e-12)


def test_where_the_road_is_not_known_nothing_is_taken_off() -> None:
    rows = np.random.default_rng(0).normal(size=(4, 6))
    named, side = dict(zip(FEATURES, rows.T, strict=True)), np.full(4, -1, np.int8)
    np.testing.assert_array_equal(feature_series(named, side), rows)
    partly = np.ma.array([0.001, np.nan, 0.001, 0.0], mask=[0, 0, 1, 0])
    known = np.array([True, False, False, False])
    seen = feature_series(named | {"road_curvature": partly}, side)
    np.testing.assert_array_equal((seen != rows).any(axis=1), known)
    bends = curvature_series({"road_curvature": partly})
    np.testing.assert_array_equal(bends, [0.001, 0.0, 0.0, 0.0])
