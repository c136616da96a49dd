"""Mode and path: when they change, where they start, what they keep."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.bezier import path_point
from costeer.controller.signals import LANE_CHANGING, LANE_KEEPING, Intention, Target
from costeer.controller.trajectory import (
    TrajectoryParameters,
    TrajectoryState,
    initial_state,
    plan_path,
    step,
)
from costeer.sensing.measurement import Measurement
from tests.controller.samples import LEFT_LANE, RIGHT_LANE, ROAD, SPEED, sample

PARAMETERS = TrajectoryParameters(change_duration=6.0)
LENGTH = 6.0 * SPEED
WANTED = Intention(detected=True, side=-1.0)
UNWANTED = Intention(detected=False, side=-1.0)
KEEPING = initial_state(ROAD, LEFT_LANE)


def stepped(
    state: TrajectoryState,
    measurement: Measurement,
    intention: Intention = UNWANTED,
    consistent: bool = True,
    replan: bool = False,
) -> tuple[TrajectoryState, Target]:
    """One step of mode and plan."""
    return step(PARAMETERS, state, ROAD, measurement, intention, consistent, replan)


CHANGING, _ = stepped(KEEPING, sample(), WANTED)


def test_without_an_intention_the_lane_is_kept() -> None:
    state, target = stepped(KEEPING, sample(lateral_position=0.7, yaw_angle=0.05))
    assert (state.mode, state.lane) == (LANE_KEEPING, LEFT_LANE)
    assert target[2:6] == (0.0, 0.0, 0.0, 0.0)


BEND = 1.0 / 500.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_in_a_bend_the_lane_that_is_kept_has_its_own_curvature(side: float) -> None:
    right = initial_state(ROAD, RIGHT_LANE)
    bent = sample(
        lateral_position=-3.5,
        lane=RIGHT_LANE,
        road_curvature=side * BEND,
        road_curvature_slope=side * 1e-5,
    )
    _, target = stepped(right, bent)
    # 3.5 m to the right of the reference line: outside in a left bend.
    assert target.curvature == pytest.approx(1.0 / (side * 500.0 + 3.5))
    assert target.curvature_rate == pytest.approx(SPEED * side * 1e-5)
    assert (target.lateral_position, target.heading) == (-3.5, 0.0)


def test_a_path_in_a_bend_begins_without_the_roads_own_turn() -> None:
    # The car follows its lane: yaw rate v kappa. Along the road its path is straight.
    bent = sample(road_curvature=BEND, yaw_rate=SPEED * BEND)
    path = plan_path(PARAMETERS, ROAD, bent, RIGHT_LANE)
    straight = plan_path(PARAMETERS, ROAD, sample(), RIGHT_LANE)
    assert path == pytest.approx(straight, abs=1e-15)


def test_curvature_of_path_and_road_add_up() -> None:
    bent = {"road_curvature": BEND, "yaw_rate": SPEED * BEND}
    state, _ = stepped(KEEPING, sample(**bent), WANTED)
    for share in (0.2, 0.5, 0.8):
        place = {"longitudinal_position": share * LENGTH}
        _, plain = stepped(CHANGING, sample(**place))
        _, on_road = stepped(state, sample(**place, **bent))
        line = BEND / (1.0 - BEND * plain.lateral_position)
        assert on_road.curvature == pytest.approx(plain.curvature + line, abs=1e-12)
        assert on_road.lateral_position == pytest.approx(plain.lateral_position)


@pytest.mark.parametrize("consistent", [True, False])
def test_an_intention_changes_the_lane_if_the_verdict_is_consistent(
    consistent: bool,
) -> None:
    state, _ = stepped(KEEPING, sample(), WANTED, consistent)
    wanted = (LANE_CHANGING, RIGHT_LANE) if consistent else (LANE_KEEPING, LEFT_LANE)
    assert (state.mode, state.lane) == wanted


@given(
    st.floats(-1.5, 1.5), st.floats(-0.1, 0.1), st.floats(-0.2, 0.2), st.floats(10, 40)
)
def test_the_path_starts_at_the_car_with_its_slope_and_curvature(
    position: float, yaw: float, yaw_rate: float, speed: float
) -> None:
    measurement = sample(
        3,
        lateral_position=position,
        yaw_angle=yaw,
        yaw_rate=yaw_rate,
        longitudinal_velocity=speed,
    )
    _, target = stepped(KEEPING, measurement, WANTED)
    # Rounding of metres over lengths of 60 m and more.
    assert target.lateral_position == pytest.approx(position, abs=1e-13)
    assert target.heading == pytest.approx(yaw, abs=1e-13)
    assert target.curvature == pytest.approx(yaw_rate / speed, abs=1e-13)


def test_the_path_is_as_long_as_the_speed_at_the_trigger_says() -> None:
    path = plan_path(PARAMETERS, ROAD, sample(longitudinal_velocity=30.0), RIGHT_LANE)
    assert path.length == 180.0
    assert path_point(path, 180.0).lateral_position == -3.5


def test_a_speed_that_changes_later_moves_no_path() -> None:
    faster = sample(60, longitudinal_velocity=35.0)
    state, _ = stepped(CHANGING, faster, WANTED)
    assert state.path == CHANGING.path


def test_the_path_ends_after_its_length_and_then_the_lane_is_kept() -> None:
    before, _ = stepped(CHANGING, sample(longitudinal_position=LENGTH - 1e-6), WANTED)
    assert (before.mode, before.path_ended) == (LANE_CHANGING, False)
    there = sample(longitudinal_position=LENGTH, lane=RIGHT_LANE, lateral_position=-3.4)
    ended, target = stepped(CHANGING, there, WANTED)
    assert (ended.mode, ended.lane, ended.path_ended) == (
        LANE_KEEPING,
        RIGHT_LANE,
        True,
    )
    assert target.lateral_position == -3.5
    later, _ = stepped(ended, there)
    assert not later.path_ended


def test_a_path_that_ends_in_the_old_lane_leaves_the_car_there() -> None:
    stuck = sample(longitudinal_position=LENGTH, lateral_position=-1.5)
    ended, _ = stepped(CHANGING, stuck)
    assert ended.lane == LEFT_LANE


def test_a_replan_keeps_the_lane_that_the_car_is_in_and_ends_no_path() -> None:
    for lane in (LEFT_LANE, RIGHT_LANE):
        state, target = stepped(CHANGING, sample(60, lane=lane), WANTED, replan=True)
        assert (state.mode, state.lane, state.path_ended) == (LANE_KEEPING, lane, False)
        assert target.lateral_position == -3.5 * (LEFT_LANE - lane)


def test_a_replan_at_the_end_of_a_path_counts_as_a_replan() -> None:
    state, _ = stepped(CHANGING, sample(longitudinal_position=LENGTH), replan=True)
    assert (state.mode, state.path_ended) == (LANE_KEEPING, False)  # so: no lock


def test_a_line_crossed_without_a_trigger_does_not_move_the_target() -> None:
    across = sample(60, lane=RIGHT_LANE, lateral_position=-2.2, side=1.0)
    state, target = stepped(KEEPING, across)
    assert (state.lane, target.lateral_position) == (LEFT_LANE, 0.0)
    replanned, target = stepped(state, across, replan=True)
    assert (replanned.lane, target.lateral_position) == (RIGHT_LANE, -3.5)


def test_an_intention_within_a_lane_change_starts_no_other() -> None:
    state, _ = stepped(CHANGING, sample(200, lane=RIGHT_LANE, side=1.0), WANTED)
    assert state.path == CHANGING.path
    assert state.lane == RIGHT_LANE


def test_the_targets_rate_of_curvature_is_that_along_the_drive() -> None:
    step_length = 1e-3
    curvatures = [
        stepped(CHANGING, sample(longitudinal_position=40.0 + k * step_length))[1]
        for k in (-1.0, 0.0, 1.0)
    ]
    slope = (curvatures[2].curvature - curvatures[0].curvature) / (2.0 * step_length)
    # Central difference: the error is step² / 6 times a third derivative.
    assert curvatures[1].curvature_rate == pytest.approx(SPEED * slope, rel=1e-6)


@pytest.mark.parametrize(
    "name", ["longitudinal_position", "lateral_position", "yaw_rate", "lane", "side"]
)
def test_a_sample_that_is_not_finite_changes_no_plan(name: str) -> None:
    lost = sample(**{name: math.nan})
    assert stepped(KEEPING, lost, WANTED)[0] == KEEPING
    late = sample(**({"longitudinal_position": LENGTH} | {name: math.nan}))
    assert stepped(CHANGING, late)[0] == CHANGING
    assert stepped(CHANGING, sample(60, **{name: math.nan}), replan=True)[0] == CHANGING
