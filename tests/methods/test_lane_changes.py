"""Methods that begin a path: by time to the line, by indicator, by a torque."""

from __future__ import annotations

import math
from typing import Any

import pytest

from costeer.controller.signals import LANE_CHANGING, LANE_KEEPING, Request
from costeer.methods.registry import METHODS
from costeer.plant.parameters import RoadParameters
from tests.controller.samples import DT, LEFT_LANE, RIGHT_LANE, SPEED, sample
from tests.methods.rides import (
    NOTHING,
    Answers,
    change_to_the_right,
    moved,
    parameters_of,
    placed,
    shown,
    still,
)

CROSSING = METHODS["lane-crossing-time"]
KEEPING = METHODS["lane-keeping"]
INDICATOR = METHODS["indicator"]
ACSF = METHODS["indicator-acsf"]
INCLUSION = METHODS["inclusion"]

RIGHT, LEFT = Request(indicator=-1.0), Request(indicator=1.0)
THREE_LANES = RoadParameters(num_lanes=3.0)


def first(answers: Answers, mode: float = LANE_CHANGING) -> float:
    """When a mode begins [s]; infinite if never."""
    modes = [answer.target.mode for answer in answers.given]
    return modes.index(mode) * DT if mode in modes else math.inf


def test_a_short_time_to_the_line_begins_a_path_that_helps() -> None:
    change = moved(3.0, change_to_the_right)
    given = parameters_of(CROSSING, trigger__crossing_time=2.0)
    helped, kept = (
        shown(CROSSING, given, change),
        shown(KEEPING, parameters_of(KEEPING), change),
    )
    last = helped.given[-1].target
    assert (last.mode, last.lane) == (LANE_CHANGING, RIGHT_LANE)
    # At the line lane keeping pulls back to the left; the path does so by far less.
    assert kept.torques[-1] > 2.0
    assert helped.torques[-1] < 0.5 * kept.torques[-1]


def test_a_drift_of_hands_off_triggers_as_a_lane_change_does() -> None:
    # 1.75 m to the line at 0.25 m/s: 2 s are left at 5 s; three samples make a trigger.
    drift = moved(6.0, lambda t: -0.25 * t)
    given = parameters_of(CROSSING, trigger__crossing_time=2.0)
    assert first(shown(CROSSING, given, drift)) == pytest.approx(
        5.0 + 2.0 * DT, abs=1.5 * DT
    )


def test_there_is_no_path_to_where_there_is_no_lane() -> None:
    drift = moved(6.0, lambda t: 0.25 * t)
    given = parameters_of(CROSSING, trigger__crossing_time=2.0)
    assert first(shown(CROSSING, given, drift)) == math.inf


def test_nothing_ends_a_path_of_lane_crossing_time_early() -> None:
    stays = moved(1.0, lambda t: -1.0 - t) + still(4.0, -0.5, driver_torque=4.0)
    given = parameters_of(CROSSING, trigger__crossing_time=2.0)
    answers = shown(
        CROSSING,
        given,
        [
            seen._replace(longitudinal_position=SPEED * DT * k)
            for k, seen in enumerate(stays)
        ],
    )
    begun = round(first(answers) / DT)
    modes = {answer.target.mode for answer in answers.given[begun:]}
    assert modes == {LANE_CHANGING}


def test_the_indicator_begins_a_path_to_its_side_at_once() -> None:
    answers = shown(INDICATOR, parameters_of(INDICATOR), still(0.2, 0.0), RIGHT)
    assert first(answers) == 0.0
    assert answers.given[0].intention
    assert answers.given[-1].target.lane == RIGHT_LANE


def test_the_indicator_to_the_side_without_a_lane_does_nothing() -> None:
    answers = shown(INDICATOR, parameters_of(INDICATOR), still(5.0, 0.0), LEFT)
    assert first(answers) == math.inf


def test_the_lever_that_stays_on_makes_one_lane_change() -> None:
    given = parameters_of(INDICATOR, "strong-rapid", road=THREE_LANES)
    # From the left lane of three, at 0 m, to the middle one, and along it.
    ride = [
        sample(k, lateral_position=change_to_the_right(k * DT, 4.0)) for k in range(600)
    ]
    ride = [s._replace(lane=2.0 if s.lateral_position > -1.75 else 1.0) for s in ride]
    answers = shown(INDICATOR, given, ride, RIGHT)
    begun = sum(answer.intention for answer in answers.given)
    assert begun == 1
    assert answers.given[-1].target.mode == LANE_KEEPING
    assert answers.given[-1].target.lane == 1.0


def test_a_mirrored_lever_gives_the_mirrored_torque() -> None:
    road = RoadParameters(overtaking_side=1.0)
    here = still(3.0, 0.1)
    there = [placed(k, -3.6, lane=RIGHT_LANE, side=1.0) for k in range(len(here))]
    right = shown(INDICATOR, parameters_of(INDICATOR), here, RIGHT)
    left = shown(INDICATOR, parameters_of(INDICATOR, road=road), there, LEFT)
    assert left.torques == pytest.approx([-each for each in right.torques], abs=1e-12)


def test_acsf_waits_for_three_seconds_and_is_done_in_five() -> None:
    answers = shown(ACSF, parameters_of(ACSF, "strong-gentle"), still(9.0, 0.0), RIGHT)
    aims = [answer.target.lateral_position for answer in answers.given]
    waiting = [aim for k, aim in enumerate(aims) if k * DT < 3.0 - DT / 2.0]
    assert set(waiting) == {0.0}
    assert first(answers) == pytest.approx(3.0, abs=1.5 * DT)
    path = answers.given[round(4.0 / DT)].target.path
    assert path.length == pytest.approx(5.0 * SPEED)
    assert aims[round(7.9 / DT)] == pytest.approx(-3.5, abs=0.01)
    over = answers.given[round(8.1 / DT)].target
    assert over.mode == LANE_KEEPING


def test_acsf_is_cancelled_by_the_lever_until_it_begins() -> None:
    ride, given = still(6.0, 0.0), parameters_of(ACSF)
    lever = [RIGHT if k * DT < 2.9 else NOTHING for k in range(len(ride))]
    assert first(shown(ACSF, given, ride, lever)) == math.inf
    again = [NOTHING if 2.0 < k * DT < 2.1 else RIGHT for k in range(len(ride))]
    assert first(shown(ACSF, given, ride, again)) == pytest.approx(5.1, abs=2.0 * DT)


@pytest.mark.parametrize(("method", "start"), [(INDICATOR, 0.0), (ACSF, 3.0)])
def test_a_script_that_asks_for_a_moment_is_served_once(
    method: Any, start: float
) -> None:
    ride = still(10.0, 0.0)
    asked = [Request(requested=k * DT < 0.1) for k in range(len(ride))]
    answers = shown(method, parameters_of(method, "strong-rapid"), ride, asked)
    assert first(answers) == pytest.approx(start, abs=1.5 * DT)
    assert sum(answer.intention for answer in answers.given) == 1


def pushed(
    seconds: float, torque: float, rest: float = 0.0, **values: float
) -> Answers:
    """A driver who pushes for a while, and then lets go."""
    given = parameters_of(INCLUSION, **({"intent__threshold": 1.0} | values))
    ride = still(seconds, 0.0, driver_torque=torque) + still(rest, 0.0)
    ride = [
        seen._replace(longitudinal_position=SPEED * DT * k)
        for k, seen in enumerate(ride)
    ]
    return shown(INCLUSION, given, ride)


def test_a_torque_of_a_moment_shifts_the_reference_and_not_the_plan() -> None:
    answers = pushed(0.25, -3.0, rest=3.0)
    assert first(answers) == math.inf
    # 0.75 N·m·s at most, of which 2 s forget some: 0.2 m/(N·m·s) of it.
    most = min(answer.target.lateral_position for answer in answers.given)
    assert -0.2 * 0.75 <= most < -0.2 * 0.75 * math.exp(-0.25 / 2.0)
    assert abs(answers.given[-1].target.lateral_position) < 0.05


def test_a_torque_that_persists_changes_the_plan() -> None:
    # The leaky integral of 1 N·m is 2 (1 - exp(-t / 2)) N·m·s, 1 at 2 ln 2.
    answers = pushed(2.0, -1.0)
    assert first(answers) == pytest.approx(2.0 * math.log(2.0), abs=3.0 * DT)
    last = answers.given[-1]
    assert (last.target.lane, last.intention) == (RIGHT_LANE, False)
    assert sum(answer.intention for answer in answers.given) == 1


def test_a_torque_to_where_there_is_no_lane_shifts_the_reference_up_to_its_limit() -> (
    None
):
    answers = pushed(6.0, 2.0)
    assert first(answers) == math.inf
    assert answers.given[-1].target.lateral_position == pytest.approx(0.3)


def test_a_torque_against_a_running_change_plans_back() -> None:
    given = parameters_of(INCLUSION, intent__threshold=1.0)
    change = [
        seen._replace(driver_torque=1.0 if k * DT > 1.0 else 0.0)
        for k, seen in enumerate(moved(2.7, change_to_the_right))
    ]
    asked = [Request(requested=k == 0) for k in range(len(change))]
    answers = shown(INCLUSION, given, change, asked)
    lanes = [answer.target.lane for answer in answers.given]
    turned = [answer.replan for answer in answers.given].index(True)
    assert turned * DT == pytest.approx(1.0 + 2.0 * math.log(2.0), abs=4.0 * DT)
    assert (lanes[0], lanes[turned - 1], lanes[turned]) == (0.0, 0.0, LEFT_LANE)
    assert answers.given[turned].target.mode == LANE_CHANGING


def test_a_torque_along_a_running_change_is_no_second_one() -> None:
    given = parameters_of(INCLUSION, intent__threshold=1.0)
    change = moved(6.5, change_to_the_right, driver_torque=-2.0)
    answers = shown(INCLUSION, given, change)
    assert sum(answer.intention for answer in answers.given) == 1
    assert not any(answer.replan for answer in answers.given)


def test_what_weak_guidance_leaves_to_the_driver_on_a_curve_is_no_intent() -> None:
    curvature = 1.0 / 400.0
    given = parameters_of(INCLUSION, "weak-normal", intent__threshold=1.0)
    # Steady cornering on 400 m at 20 m/s, written out: tyres carry m v² kappa, the
    # aligning torque is 0.6 · 0.026 m of the front's over the ratio.
    force = 1500.0 * SPEED**2 * curvature
    front, rear = force * 1.6 / 2.7, force * 1.1 / 2.7
    wheel = 16.0 * (2.7 * curvature + front / 110e3 - rear / 120e3)
    holding = 0.6 * (2.0 * wheel + 0.6 * 0.026 / 16.0 * front)
    ride = [
        sample(
            k,
            road_curvature=curvature,
            yaw_rate=SPEED * curvature,
            steering_wheel_angle=wheel,
            driver_torque=holding,
        )
        for k in range(600)
    ]
    answers = shown(INCLUSION, given, ride)
    assert abs(answers.states[-1].intent.integral) < 0.05
