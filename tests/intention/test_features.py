"""Signals of Eq. (1): order, mirror, scale."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.features import (
    FEATURE_LIMIT,
    FEATURES,
    IntentionSample,
    adjacent_side,
    facing,
    feature_series,
    scaled,
)

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
