"""Methods whose gain answers the driver: by power, by work, by the size of a torque."""

from __future__ import annotations

import math
from typing import Any

import pytest

from costeer.methods.ibhs import IBHS
from costeer.methods.registry import METHODS
from tests.controller.samples import DT, RIGHT_LANE, sample
from tests.methods.rides import parameters_of, placed, shown

STATUS = METHODS["cooperative-status"]
WORK = METHODS["pseudo-work"]
TRADED = METHODS["traded"]

STEPS = 300


def gains(method: Any, samples: list[Any], **values: float) -> list[float]:
    answers = shown(method, parameters_of(method, **values), samples)
    return [answer.haptic_gain for answer in answers.given]


def off_centre(velocity: float, driver_torque: float) -> list[Any]:
    """A car right of the centre that moves across; guidance pulls to the left."""
    return [
        placed(
            k,
            -0.8,
            velocity,
            driver_torque=driver_torque,
            yaw_angle=0.0,
            lateral_velocity=velocity,
        )
        for k in range(STEPS)
    ]


def test_where_the_driver_leads_against_the_guidance_the_gain_falls() -> None:
    # Both move right: the driver's power is 2 N·m times 0.5 m/s, the guidance's is
    # negative. The window is full after 60 samples; 2 s later Eq. (10) has λ (t - γ)
    # = 4 behind it.
    found = gains(STATUS, off_centre(-0.5, -2.0))
    assert found[58] == 1.0
    after = 59 + round(2.0 / DT)
    assert found[after] == pytest.approx((1.0 - math.tanh(4.0)) / 2.0, abs=1e-6)


def test_where_the_system_leads_the_gain_stays_though_the_driver_resists() -> None:
    assert set(gains(STATUS, off_centre(0.5, -2.0))) == {1.0}


def test_where_the_driver_leads_and_both_mean_the_same_the_gain_stays() -> None:
    # A driver who brings the car back with more torque than the guidance.
    assert set(gains(STATUS, off_centre(0.5, 4.0))) == {1.0}


def test_a_lead_within_the_threshold_is_none() -> None:
    # Powers of 1.0 and about -0.7 W·m: less than 2 apart.
    samples = off_centre(-0.5, -2.0)
    assert set(gains(STATUS, samples, cooperation__initiative_threshold=2.0)) == {1.0}


def test_the_followed_lane_goes_with_the_driver() -> None:
    given = parameters_of(STATUS)
    answers = shown(STATUS, given, [placed(k, -2.1) for k in range(3)])
    assert answers.given[-1].target.lane == RIGHT_LANE


def verdicts(method: Any, samples: list[Any], threshold: float) -> list[bool]:
    values = {"consistency__inconsistency_threshold": threshold}
    answers = shown(method, parameters_of(method, **values), samples)
    return [bool(answer.consistency.consistent) for answer in answers.given]


def across(velocity: float, yaw_rate: float) -> list[Any]:
    """A driver who pushes right against guidance that pulls left."""
    return [
        sample(
            k,
            lateral_position=-0.8,
            lateral_velocity=velocity,
            yaw_rate=yaw_rate,
            driver_torque=-2.0,
        )
        for k in range(90)
    ]


@pytest.mark.parametrize(
    ("velocity", "yaw_rate", "paper", "lateral"),
    [(-0.5, 0.0, True, False), (0.0, -0.1, False, True)],
)
def test_pseudo_work_judges_by_lateral_velocity_and_the_paper_by_heading(
    velocity: float, yaw_rate: float, paper: bool, lateral: bool
) -> None:
    samples = across(velocity, yaw_rate)
    assert verdicts(IBHS, samples, 0.1)[-1] is paper
    assert verdicts(WORK, samples, 0.1)[-1] is lateral


def test_where_velocity_and_heading_error_rate_differ_in_sign_so_do_the_works() -> None:
    samples = across(-0.5, 0.1)
    work = {
        method.name: shown(method, parameters_of(method), samples)
        .given[-1]
        .consistency.driver_pseudo_work
        for method in (IBHS, WORK)
    }
    assert work["ibhs"] == pytest.approx(-2.0 * 0.1)
    assert work["pseudo-work"] == pytest.approx(-2.0 * -0.5)


def held(torque: float, seconds: float = 4.0) -> list[Any]:
    """A car that turns left under guidance to the left, and a torque on its wheel."""
    return [
        placed(k, -0.8, driver_torque=torque, yaw_rate=0.1)
        for k in range(round(seconds / DT))
    ]


def test_traded_control_cannot_tell_help_from_resistance_and_the_paper_can() -> None:
    help_, resist = held(1.0), held(-1.0)
    assert gains(TRADED, help_) == gains(TRADED, resist)
    assert gains(IBHS, help_)[-1] == 1.0
    assert gains(IBHS, resist)[-1] < 0.05


def test_authority_follows_the_logistic_function_of_the_time_of_holding() -> None:
    # x rises from -0.5 by 1/s: 1.5 after 2 s, 3 at most; and falls as fast.
    found = gains(TRADED, held(0.2, 6.0) + held(0.05, 6.0))
    for time, x in ((2.0, 1.5), (5.9, 3.0), (7.0, 2.0), (11.9, -0.5)):
        expected = 1.0 - 1.0 / (1.0 + math.exp(-3.0 * (x - 0.5)))
        assert found[round(time / DT) - 1] == pytest.approx(expected, abs=1e-9)


def test_traded_control_plans_anew_once_it_has_given_way() -> None:
    answers = shown(TRADED, parameters_of(TRADED), held(1.0))
    for answer in answers.given:
        assert answer.replan is (answer.haptic_gain < 0.05)
