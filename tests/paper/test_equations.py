"""Equations (3) to (13) and Tables III and IV against values computed by hand.

The numbers are worked out in the comments from the printed equations, with the column
and the default car of the specification: B_eq 1.5 N·m·s/rad, K_Fz 2.0 N·m/rad,
friction 0.25 N·m, k_s = 0.6 · 0.026 · 110000 / 16 = 107.25 N·m/rad.
"""

from __future__ import annotations

import math

import pytest

from costeer.base.bezier import path_point
from costeer.controller import consistency, strength
from costeer.controller.actuation import (
    STRONG,
    WEAK,
    ActuationParameters,
    applied_torque,
)
from costeer.controller.consistency import ConsistencyParameters, is_consistent
from costeer.controller.guidance import (
    GuidanceParameters,
    disturbance_torque,
    estimated_driver_torque,
    instructed_torque,
)
from costeer.controller.preview import PreviewParameters, preview
from costeer.controller.signals import LANE_CHANGING, Preview, Target
from costeer.controller.strength import StrengthParameters, haptic_gain
from costeer.controller.trajectory import TrajectoryParameters, plan_path
from costeer.plant.parameters import DEFAULT_CAR, ColumnParameters
from tests.controller.samples import DT, ROAD, sample

# Gains of Eq. (5) that make sums easy to follow.
GAINS = GuidanceParameters(
    lateral_error_gain=1.5,
    heading_error_rate_gain=1.0,
    steering_angle_gain=3.0,
    slip_angle_gain=48.0,
    friction_smoothing=0.3,
    friction_rate_weight=4.0,
)
COLUMN = ColumnParameters()
WHEEL = Preview(
    lateral_error=0.4,
    heading_error=0.01,
    heading_error_rate=0.05,
    steering_angle_error=-0.1,
    slip_angle_error=0.002,
    planned_steering_angle=0.2,
    planned_steering_rate=0.1,
    planned_slip_angle=-0.004,
)
# 1.5 · 0.4 + 1.0 · 0.05 + 3.0 · (-0.1) + 48 · 0.002 = 0.6 + 0.05 - 0.3 + 0.096
ESTIMATE = 0.446
# 0.004 · 107.25 = 0.429; 4 · 1.5 · 0.1 - 0.446 = 0.154;
# 0.25 · tanh(0.154 / 0.3 = 0.51333) = 0.25 · 0.472538 = 0.118135
DISTURBANCE = 0.547135


def exactly(value: float) -> object:
    """To the digits of the hand computation: six."""
    return pytest.approx(value, abs=1e-6)


def test_eq_3_a_quarter_of_the_way_is_a_tenth_of_the_width() -> None:
    # 10 / 64 - 15 / 256 + 6 / 1024 = 0.103516 of 3.5 m; L = 20 m/s · 6 s.
    path = plan_path(TrajectoryParameters(change_duration=6.0), ROAD, sample(), 0.0)
    assert path.length == 120.0
    assert path_point(path, 30.0).lateral_position == exactly(-0.362305)
    assert path_point(path, 60.0).lateral_position == exactly(-1.75)


def test_eq_4_is_damping_stiffness_and_disturbance_less_the_estimate() -> None:
    # 1.5 · 0.1 + 2.0 · 0.2 + 0.547135 - 0.446
    torque = instructed_torque(COLUMN, WHEEL, DISTURBANCE, ESTIMATE)
    assert torque == exactly(0.651135)


def test_eq_4_disturbance_is_aligning_torque_and_friction() -> None:
    torque = disturbance_torque(GAINS, DEFAULT_CAR, COLUMN, WHEEL, ESTIMATE)
    assert torque == exactly(DISTURBANCE)


def test_eq_5_is_the_weighted_sum_of_four_errors() -> None:
    assert estimated_driver_torque(GAINS, WHEEL) == exactly(ESTIMATE)


def test_fig_4_errors_by_hand() -> None:
    # v 20 m/s, kappa_d 0.001 1/m, y_d -1, psi_p -0.05.
    # K_us = 1500 (192000 - 121000) / (2.7 · 1.32e10) = 2.988215e-3 s²/m
    # theta_d = 16 (2.7 + 2.988215e-3 · 400) 0.001 = 0.062325
    # alpha_d = -1500 · 1.6 · 400 · 0.001 / (2.7 · 110000) = -0.003232
    # psi_d = -0.05 - (1.6 - 1.1 · 1500 · 400 / (2.7 · 120000)) 0.001 = -0.049563
    # e_y = (-0.9 + 1) + 20 · 1.5 · (-0.04 + 0.049563) = 0.386889
    target = Target(
        mode=LANE_CHANGING,
        lane=0.0,
        lateral_position=-1.0,
        heading=-0.05,
        curvature=0.001,
        curvature_rate=0.002,
        path=plan_path(TrajectoryParameters(), ROAD, sample(), 0.0),
    )
    measurement = sample(
        lateral_position=-0.9,
        yaw_angle=-0.04,
        yaw_rate=0.03,
        steering_wheel_angle=0.1,
        front_slip_angle=-0.002,
    )
    errors = preview(PreviewParameters(), DEFAULT_CAR, target, measurement)
    assert errors == Preview(
        lateral_error=exactly(0.386889),
        heading_error=exactly(0.009563),
        heading_error_rate=exactly(0.01),
        steering_angle_error=exactly(0.037675),
        slip_angle_error=exactly(0.001232),
        planned_steering_angle=exactly(0.062325),
        planned_steering_rate=exactly(0.124649),
        planned_slip_angle=exactly(-0.003232),
    )


@pytest.mark.parametrize(
    ("factor", "gain", "torque"),
    [(STRONG, 1.0, 2.0), (STRONG, 0.5, 1.0), (WEAK, 1.0, 0.8), (WEAK, 0.5, 0.4)],
)
def test_eq_6_and_table_4_scale_the_instruction(
    factor: float, gain: float, torque: float
) -> None:
    parameters = ActuationParameters(strength_factor=factor)
    assert applied_torque(parameters, gain, 2.0) == exactly(torque)


def test_eqs_7_to_9_by_hand() -> None:
    # Sixty samples: guidance 1, 2, ..., 60 N·m, driver -0.5 N·m, rate 0.1 rad/s.
    # W_hapi = 0.1 · 61 / 2 = 3.05; W_dr = -0.05; S_c = 60 · (-0.5) = -30.
    state = consistency.initial_state()
    for torque in range(1, 61):
        state, verdict = consistency.step(
            ConsistencyParameters(), state, float(torque), -0.5, 0.1, DT
        )
    assert verdict.guidance_pseudo_work == exactly(3.05)
    assert verdict.driver_pseudo_work == exactly(-0.05)
    assert verdict.torque_agreement == exactly(-30.0)
    assert not verdict.consistent


@pytest.mark.parametrize(
    ("agreement", "gap", "verdict"),
    [(1.0, 0.01, True), (1.0, 0.9, True), (-1.0, 0.01, True), (-1.0, 0.9, False)],
)
def test_table_3(agreement: float, gap: float, verdict: bool) -> None:
    parameters = ConsistencyParameters(inconsistency_threshold=0.1)
    assert is_consistent(parameters, gap, 0.0, agreement) is verdict


@pytest.mark.parametrize(
    ("time", "gain"),
    [
        (0.0, 0.999665),  # (1 - tanh(-4)) / 2, tanh 4 = 0.999329
        (0.5, 0.982014),  # (1 - tanh(-2)) / 2, tanh 2 = 0.964028
        (1.0, 0.5),
        (1.5, 0.017986),
        (2.0, 0.000335),
    ],
)
def test_eq_10_fades_out(time: float, gain: float) -> None:
    assert haptic_gain(StrengthParameters(), False, time, 1.0) == exactly(gain)


@pytest.mark.parametrize(
    ("time", "gain"),
    [
        (0.0, 0.200268),  # 0.2 + 0.8 · 0.000335
        (0.5, 0.214389),  # 0.2 + 0.8 · 0.017986
        (1.0, 0.6),
        (2.0, 0.999732),
    ],
)
def test_eq_11_fades_in_from_the_gain_at_the_switch(time: float, gain: float) -> None:
    assert haptic_gain(StrengthParameters(), True, time, 0.2) == exactly(gain)


def test_eqs_12_and_13_the_gain_at_a_switch_is_about_that_before_it() -> None:
    state = strength.initial_state()
    before = 1.0
    for consistent in [False] * 61 + [True] * 31 + [False]:
        switched = consistent != state.consistent
        state, gain = strength.step(StrengthParameters(), state, consistent, DT)
        if switched:
            # 3.4e-4 is (1 - tanh 4) / 2, of a way to go of at most 1.
            assert gain == pytest.approx(before, abs=3.4e-4)
            assert state.gain_at_switch == before
        before = gain


def test_a_fade_that_a_consistent_moment_interrupts_starts_its_time_again() -> None:
    # 0.5 s out: 0.982014. One step in and one out leave t = 0, so that half a second
    # later the gain is 0.982 · (1 - 0.018) and not the 0.5 of a whole second.
    state = strength.initial_state()
    for consistent in [False] * 31 + [True] + [False] * 31:
        state, gain = strength.step(StrengthParameters(), state, consistent, DT)
    assert gain == pytest.approx(0.964, abs=1e-3)
    assert math.isclose(state.time_in_verdict, 0.5)
