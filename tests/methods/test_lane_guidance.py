"""Methods that keep a lane: which one, how strongly, and where not at all."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

from costeer.methods.registry import METHODS
from costeer.plant.parameters import CarParameters, ColumnParameters
from tests.controller.samples import DT, LEFT_LANE, RIGHT_LANE, SPEED, sample
from tests.methods.rides import (
    change_to_the_right,
    moved,
    parameters_of,
    shown,
    still,
)

KEEPING = METHODS["lane-keeping"]
SHARING = METHODS["fixed-sharing"]
CHOICES = METHODS["four-design-choices"]
BAND = METHODS["bandwidth"]
CONSTANT = METHODS["bandwidth-constant"]

LINE = -1.75
METRE_RIGHT = 1.75
"""Lane-keeping torque of a car at rest 1 m to the right of its lane's centre: K_y e_y
and, against the friction it has to overcome, 0.25 N·m."""


def steady(method: Any, lateral_position: float, **values: float) -> float:
    """Torque at a place once the rate limit of 30 N·m/s is over."""
    given = parameters_of(method, **values)
    return shown(method, given, still(0.5, lateral_position)).torques[-1]


def test_the_followed_lane_changes_0_3_m_beyond_the_line_and_not_before() -> None:
    there = moved(5.0, lambda t: -0.49 * t)
    back = moved(5.0, lambda t: -2.5 + 0.49 * t)
    lanes = shown(KEEPING, parameters_of(KEEPING), there + back)
    for seen, answer in zip(there, lanes.given, strict=False):
        beyond = LINE - seen.lateral_position > 0.3
        assert answer.target.lane == (RIGHT_LANE if beyond else LEFT_LANE)
    for seen, answer in zip(back, lanes.given[len(there) :], strict=True):
        beyond = seen.lateral_position - LINE > 0.3
        assert answer.target.lane == (LEFT_LANE if beyond else RIGHT_LANE)


def test_beyond_the_outer_line_the_outer_lane_is_followed() -> None:
    answers = shown(KEEPING, parameters_of(KEEPING), still(0.1, 2.5))
    assert answers.given[-1].target.lane == LEFT_LANE


def test_a_lost_place_switches_nothing_and_gives_no_torque() -> None:
    lost = still(0.2, math.nan, lane=LEFT_LANE, side=-1.0)
    answers = shown(KEEPING, parameters_of(KEEPING), still(0.5, -1.0) + lost)
    assert answers.given[-1].target.lane == LEFT_LANE
    assert answers.torques[-1] == 0.0


def test_lane_keeping_gives_the_whole_torque_of_eq_4_at_the_conditions_strength() -> (
    None
):
    assert steady(KEEPING, -1.0) == pytest.approx(METRE_RIGHT, abs=1e-6)
    weak = parameters_of(KEEPING, "weak-rapid")
    answers = shown(KEEPING, weak, still(0.5, -1.0))
    assert answers.torques[-1] == pytest.approx(0.4 * METRE_RIGHT, abs=1e-6)


@pytest.mark.parametrize("level", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
def test_fixed_sharing_opposes_a_lane_change_in_proportion_to_its_level(
    level: float,
) -> None:
    # Just before the line, 1.6 m right of the centre: 1.6 K_y and the friction.
    torque = steady(SHARING, -1.6, sharing__level=level)
    assert torque == pytest.approx(level / 5.0 * (1.5 * 1.6 + 0.25), abs=1e-6)
    change = moved(2.5, change_to_the_right)
    torques = shown(SHARING, parameters_of(SHARING, sharing__level=level), change)
    assert all(each >= 0.0 for each in torques.torques)


def test_the_usual_level_is_the_middle_of_five() -> None:
    assert steady(SHARING, -1.0) == pytest.approx(0.6 * METRE_RIGHT, abs=1e-6)


def curve(curvature: float) -> tuple[Any, float]:
    """A car without error on a curve, and the torque that holds its wheel there.

    Steady cornering of the linear single-track car, written out.
    """
    car, column = CarParameters(), ColumnParameters()
    base = car.front_distance + car.rear_distance
    front = car.mass * car.rear_distance / base * SPEED**2 * curvature
    rear = car.mass * car.front_distance / base * SPEED**2 * curvature
    front_slip = front / car.front_cornering_stiffness
    rear_slip = rear / car.rear_cornering_stiffness
    wheel = car.steering_ratio * (base * curvature + front_slip - rear_slip)
    sideslip = car.rear_distance * curvature - rear_slip
    torque = column.stiffness * wheel + car.aligning_stiffness * front_slip
    seen = sample(
        road_curvature=curvature,
        yaw_angle=-sideslip,
        yaw_rate=SPEED * curvature,
        steering_wheel_angle=wheel,
    )
    return seen, torque


@pytest.mark.parametrize("authority", [0.0, 5.0])
def test_full_support_gives_the_steady_torque_of_a_curve(authority: float) -> None:
    seen, expected = curve(1.0 / 500.0)
    given = parameters_of(CHOICES, choices__authority_level=authority)
    torque = shown(CHOICES, given, [seen] * 30).torques[-1]
    assert torque == pytest.approx(expected, rel=1e-12)


def test_feedback_and_authority_follow_the_published_law() -> None:
    # K_s at 20 m/s from the torque of a curve over its wheel angle.
    seen, torque = curve(1e-3)
    stiffness = torque / seen.steering_wheel_angle
    off = sample(lateral_position=-0.4, yaw_angle=0.002, steering_wheel_angle=0.01)
    feedback = 0.15 * 0.4 - 2.5 * 0.002
    given = parameters_of(CHOICES, choices__authority_level=2.0)
    found = shown(CHOICES, given, [off] * 30).torques[-1]
    expected = stiffness * feedback + 2.0 * (feedback - 0.01)
    assert found == pytest.approx(expected, rel=1e-9)


def test_inside_the_band_there_is_no_torque() -> None:
    weaving = moved(20.0, lambda t: 0.38 * math.sin(0.3 * t))
    for method in (BAND, CONSTANT):
        answers = shown(method, parameters_of(method), weaving)
        assert set(answers.torques) == {0.0}
        assert [state.departed for state in answers.states] == [0.0] * len(weaving)


def test_guidance_lasts_from_the_band_s_edge_until_0_15_m() -> None:
    out_and_back = moved(8.0, lambda t: 0.15 * t if t < 4.0 else 1.2 - 0.15 * t)
    answers = shown(BAND, parameters_of(BAND), out_and_back)
    sides = [state.departed for state in answers.states]
    # Half a second ahead at 0.15 m/s: 0.425 m at 2.83 s; back below 0.15 m at 7 s.
    begins, ends = (sides.index(side) * DT for side in (1.0, 0.0))
    assert ends == 0.0
    assert begins == pytest.approx(0.425 / 0.15, abs=2.0 * DT)
    assert sum(sides) * DT == pytest.approx(7.0 - 0.425 / 0.15, abs=3.0 * DT)


def test_at_the_band_s_edge_guidance_does_not_chatter() -> None:
    trembling = moved(10.0, lambda t: 0.5 + 0.05 * math.sin(20.0 * t))
    for method in (BAND, CONSTANT):
        states = shown(method, parameters_of(method), trembling).states
        switched = sum(a.departed != b.departed for a, b in pairwise(states))
        assert switched <= 1
        assert states[-1].departed == 1.0


@pytest.mark.parametrize(("place", "expected"), [(-0.8, 2.0), (0.8, -2.0), (0.3, 0.0)])
def test_the_torque_of_one_size_points_to_the_centre(
    place: float, expected: float
) -> None:
    assert steady(CONSTANT, place) == expected


def test_outside_the_band_the_torque_is_that_of_lane_keeping() -> None:
    assert steady(BAND, -1.0) == pytest.approx(METRE_RIGHT, abs=1e-6)
