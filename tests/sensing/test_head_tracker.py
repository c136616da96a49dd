"""The head tracker loses the face now and then and finds it again."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.sensing.sensors import (
    HeadTracker,
    SensorParameters,
    TrackerNoise,
    initial_tracker,
    measured_head_yaw,
    track_head,
)

DT = 1.0 / 60.0
SENSORS = SensorParameters()
AHEAD, TURNED = 0.1, 0.7
NUM_HEADS = 2000
YAWS = st.floats(-1.0, 1.0)
NORMALS = st.floats(-4.0, 4.0)


class Tracked(NamedTuple):
    """What the trackers of many heads say, shape `(time, head)`."""

    head_yaw: NDArray[np.float64]
    valid: NDArray[np.bool_]


@cache
def tracked(
    head_yaw: float, seconds: float, sensors: SensorParameters = SENSORS
) -> Tracked:
    """Many heads that are held still."""
    generator, num_heads = np.random.default_rng(17), NUM_HEADS
    state = initial_tracker()
    yaws, flags = [], []
    for _ in range(round(seconds / DT)):
        noise = TrackerNoise(
            generator.standard_normal(num_heads), generator.random(num_heads)
        )
        state = track_head(sensors, state, np.full(num_heads, head_yaw), noise, DT)
        yaws.append(state.head_yaw)
        flags.append(state.valid)
    return Tracked(np.array(yaws), np.array(flags))


@pytest.mark.parametrize("head_yaw", [AHEAD, TURNED])
def test_a_lost_face_keeps_its_last_angle_and_is_flagged(head_yaw: float) -> None:
    found = tracked(head_yaw, 15.0)
    lost = ~found.valid[1:]
    assert lost.any()
    kept = found.head_yaw[1:] == found.head_yaw[:-1]
    assert kept[lost].all()
    assert not kept[~lost].any()  # noise moves every angle that is seen


def shares(head_yaw: float, rate: float) -> tuple[float, float, float]:
    """Share of lost samples, what the rates say of it, and its standard error."""
    seconds = 75.0
    found = tracked(head_yaw, seconds)
    lost = ~found.valid[round(5.0 / DT) :]  # settled after many times 0.3 s
    expected = rate * SENSORS.loss_time / (1.0 + rate * SENSORS.loss_time)
    # Losses are rare and independent: their number is about Poisson, each lasts an
    # exponential time, which doubles the variance of their sum.
    num_losses = rate * (1.0 - expected) * seconds * NUM_HEADS
    return float(lost.mean()), expected, expected * math.sqrt(2.0 / num_losses)


@pytest.mark.parametrize(
    ("head_yaw", "rate"),
    [(AHEAD, SENSORS.loss_rate), (TURNED, SENSORS.turned_loss_rate)],
)
def test_share_of_lost_samples_is_rate_times_time(head_yaw: float, rate: float) -> None:
    share, expected, error = shares(head_yaw, rate)
    assert share == pytest.approx(expected, abs=4.0 * error)
    assert error < 0.1 * expected


def test_a_turned_head_is_lost_more_often() -> None:
    ahead, turned = (
        float(np.mean(~tracked(yaw, 15.0).valid)) for yaw in (AHEAD, TURNED)
    )
    assert turned > 10.0 * ahead > 0.0


def test_a_face_is_found_again_after_its_mean_time() -> None:
    valid = tracked(TURNED, 75.0).valid
    lost = ~valid
    num_losses = np.count_nonzero(lost[1:] & valid[:-1])
    # An exponential time's mean is known to one over the root of their number.
    mean = np.count_nonzero(lost) * DT / num_losses
    allowed = 4.0 * SENSORS.loss_time / math.sqrt(num_losses)
    assert mean == pytest.approx(SENSORS.loss_time, abs=allowed)


def test_a_face_is_never_lost_at_a_rate_of_zero() -> None:
    perfect = SENSORS._replace(loss_rate=0.0, turned_loss_rate=0.0)
    for yaw in (AHEAD, TURNED):
        assert tracked(yaw, 15.0, perfect).valid.all()
    assert track_head(
        perfect, initial_tracker(), AHEAD, TrackerNoise(0.0, 0.0), DT
    ).valid


@given(YAWS, NORMALS)
def test_a_face_that_is_seen_is_measured(head_yaw: float, normal: float) -> None:
    said = track_head(
        SENSORS, initial_tracker(), head_yaw, TrackerNoise(normal, 0.9), DT
    )
    assert said == HeadTracker(measured_head_yaw(SENSORS, head_yaw, normal), True)


@given(YAWS, YAWS, NORMALS, st.floats(0.0, 1.0), st.booleans())
def test_a_mirrored_head_is_tracked_in_the_mirror(
    before: float, head_yaw: float, normal: float, uniform: float, valid: bool
) -> None:
    here = track_head(
        SENSORS, HeadTracker(before, valid), head_yaw, TrackerNoise(normal, uniform), DT
    )
    there = track_head(
        SENSORS,
        HeadTracker(-before, valid),
        -head_yaw,
        TrackerNoise(-normal, uniform),
        DT,
    )
    assert there == HeadTracker(-here.head_yaw, here.valid)
