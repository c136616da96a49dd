"""All stages in their order: what one step hands to the next."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.controller import step as controller
from costeer.controller.actuation import WEAK, ActuationParameters
from costeer.controller.consistency import ConsistencyParameters
from costeer.controller.signals import LANE_CHANGING, LANE_KEEPING, Assistance
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.plant.parameters import RoadParameters
from costeer.sensing.measurement import Measurement
from tests.controller.samples import (
    DT,
    LEFT_LANE,
    RIGHT_LANE,
    SPEED,
    mirrored,
    run,
    sample,
)

PARAMETERS = ControllerParameters()
WEAKER = ControllerParameters(actuation=ActuationParameters(strength_factor=WEAK))
PATIENT = ControllerParameters(
    consistency=ConsistencyParameters(inconsistency_threshold=1e9)
)
MIRRORED_ROAD = ControllerParameters(road=RoadParameters(overtaking_side=1.0))
UNPLANNED = {
    "longitudinal_acceleration",
    "lateral_velocity",
    "lateral_acceleration",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "front_slip_angle",
    "driver_torque",
    "head_yaw",
    "distance_to_adjacent_lane",
    "road_curvature_slope",
}
"""What no plan is made of."""

START = controller.initial_state(PARAMETERS, LEFT_LANE)


def weaving(num_steps: int, driver_torque: float = 1.0) -> list[Measurement]:
    """A car that weaves in its lane under a driver's steady torque."""
    return [
        sample(
            k,
            lateral_position=0.3 * math.sin(k / 9.0),
            yaw_angle=0.01 * math.cos(k / 9.0),
            yaw_rate=0.05 + 0.02 * math.sin(k / 7.0),
            steering_wheel_angle=0.05 * math.sin(k / 5.0),
            front_slip_angle=0.002 * math.cos(k / 5.0),
            driver_torque=driver_torque,
        )
        for k in range(num_steps)
    ]


CONFLICT = weaving(220, driver_torque=4.0)


def torques(signals: list[Assistance]) -> list[float]:
    """What is asked of the motor."""
    return [s.applied_torque for s in signals]


def test_a_straight_drive_in_the_middle_of_the_lane_is_left_alone() -> None:
    _, signals = run(PARAMETERS, START, [sample(k) for k in range(200)])
    assert set(torques(signals)) == {0.0}
    assert {s.haptic_gain for s in signals} == {1.0}


def test_a_trigger_starts_a_lane_change_at_its_third_positive() -> None:
    samples = [sample(k) for k in range(5)]
    _, signals = run(PARAMETERS, START, samples, crossing_probability=0.9)
    modes = [s.target.mode for s in signals]
    assert modes == [LANE_KEEPING] * 2 + [LANE_CHANGING] * 3
    assert signals[2].target.lane == RIGHT_LANE


def test_a_request_from_outside_starts_one_at_once() -> None:
    _, signals = run(PARAMETERS, START, [sample()], requested=True)
    assert signals[0].target.mode == LANE_CHANGING
    assert signals[0].intention


def test_in_a_conflict_an_intention_starts_no_lane_change() -> None:
    state, signals = run(PARAMETERS, START, CONFLICT[:70])
    assert not signals[-1].consistency.consistent
    _, signals = run(PARAMETERS, state, CONFLICT[70:75], requested=True)
    assert signals[0].intention
    assert {s.target.mode for s in signals} == {LANE_KEEPING}


def test_a_conflict_fades_the_gain_then_the_plan_is_made_anew() -> None:
    state, signals = run(PARAMETERS, START, CONFLICT[:2], requested=True)
    state, signals = run(PARAMETERS, state, CONFLICT[2:])
    replans = [s.replan for s in signals]
    first = replans.index(True)
    assert not signals[first].consistency.consistent
    assert signals[first].haptic_gain < 0.05
    # The flag is carried into the next step, where it changes the mode.
    assert signals[first].target.mode == LANE_CHANGING
    assert signals[first + 1].target.mode == LANE_KEEPING
    assert not state.trajectory.path_ended
    assert not state.inference.locked


def test_a_change_of_mode_clears_no_pseudo_work() -> None:
    samples = weaving(90)
    state, _ = run(PATIENT, START, samples[:70])
    kept = state.consistency.guidance_power
    state, _ = run(PATIENT, state, samples[70:71], requested=True)
    assert state.trajectory.mode == LANE_CHANGING
    window = state.consistency.guidance_power
    assert window.num_samples == 60
    newest = kept.next_index
    assert np.delete(window.values, newest).tolist() == (
        np.delete(kept.values, newest).tolist()
    )


def test_pseudo_work_is_that_of_the_guidance_before_gain_and_strength() -> None:
    _, strong = run(PARAMETERS, START, CONFLICT)
    _, weak = run(WEAKER, START, CONFLICT)
    assert strong[-1].consistency == weak[-1].consistency
    assert strong[70].consistency.guidance_pseudo_work == pytest.approx(
        np.mean(
            [
                s.guidance.instructed_torque * s.preview.heading_error_rate
                for s in strong[11:71]
            ]
        )
    )


def test_a_weak_guidance_has_four_tenths_of_the_torque() -> None:
    samples = [sample(k, lateral_position=0.2) for k in range(30)]
    _, strong = run(PARAMETERS, START, samples)
    _, weak = run(WEAKER, START, samples)
    assert torques(weak)[-1] == pytest.approx(0.4 * torques(strong)[-1])
    assert strong[-1].haptic_gain == weak[-1].haptic_gain


def test_after_the_end_of_a_path_the_trigger_is_locked() -> None:
    state, _ = run(PARAMETERS, START, [sample()], requested=True)
    beyond = sample(
        longitudinal_position=6.0 * SPEED + 1.0,
        lateral_position=-2.9,
        lane=RIGHT_LANE,
        side=1.0,
    )
    _, signals = run(PARAMETERS, state, [beyond] * 300, crossing_probability=1.0)
    assert signals[0].target.mode == LANE_KEEPING
    again = [s.target.mode for s in signals].index(LANE_CHANGING)
    # Unsettled, 0.6 m off: three seconds from the step after the end, three positives.
    assert again in (183, 184)


def test_a_mirrored_drive_gives_mirrored_torques_and_the_same_gain() -> None:
    start = controller.initial_state(PARAMETERS, RIGHT_LANE)
    left, left_signals = run(PARAMETERS, START, CONFLICT[:5], requested=True)
    right, right_signals = run(
        MIRRORED_ROAD, start, [mirrored(m) for m in CONFLICT[:5]], requested=True
    )
    _, later_left = run(PARAMETERS, left, CONFLICT[5:])
    _, later_right = run(MIRRORED_ROAD, right, [mirrored(m) for m in CONFLICT[5:]])
    every_left = left_signals + later_left
    every_right = right_signals + later_right
    # Rounding of lateral positions that are mirrored about -1.75 m.
    assert torques(every_right) == pytest.approx(
        [-torque for torque in torques(every_left)], abs=1e-12
    )
    assert [s.haptic_gain for s in every_right] == pytest.approx(
        [s.haptic_gain for s in every_left], abs=1e-12
    )
    assert min(s.haptic_gain for s in every_left) < 0.05


@pytest.mark.parametrize(
    "name", [n for n in Measurement._fields if n != "head_yaw_valid"]
)
def test_one_lost_value_leaves_no_trace_after_100_ms(name: str) -> None:
    samples = weaving(120, driver_torque=0.1)
    lost = samples[100]._replace(**{name: math.nan})
    _, whole = run(PATIENT, START, samples)
    state, before = run(PATIENT, START, samples[:100])
    # Even a lane change that is asked for then is not planned from what was lost.
    state, at = run(PATIENT, state, [lost], requested=name not in UNPLANNED)
    _, after = run(PATIENT, state, samples[101:])
    gap = before + at + after
    assert all(math.isfinite(s.applied_torque) for s in gap)
    assert torques(gap)[-1] == pytest.approx(torques(whole)[-1])
    assert gap[-1].target == whole[-1].target


@pytest.mark.parametrize("name", ["yaw_angle", "driver_torque"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_values_that_stay_lost_end_the_torque_within_100_ms(
    name: str, value: float
) -> None:
    samples = [sample(k, lateral_position=-1.4) for k in range(60)]
    state, before = run(PARAMETERS, START, samples)
    assert before[-1].applied_torque > 2.0
    lost = [
        sample(60 + k, lateral_position=-1.4)._replace(**{name: value})
        for k in range(6)
    ]
    _, signals = run(PARAMETERS, state, lost)
    assert signals[-1].applied_torque == 0.0


def test_a_change_of_mode_is_no_jump_of_the_torque() -> None:
    samples = [sample(k, yaw_angle=0.03, yaw_rate=0.1) for k in range(40)]
    state, before = run(PARAMETERS, START, samples[:20])
    _, after = run(PARAMETERS, state, samples[20:], requested=True)
    every = np.array([*torques(before), *torques(after)])
    assert np.abs(np.diff(every)).max() <= 30.0 * DT + 1e-12  # rounding


def test_a_batch_gives_what_its_members_give() -> None:
    offsets = np.array([-0.4, 0.0, 0.1, 0.6])

    def after(offset: float) -> tuple[ControllerState, list[Assistance]]:
        samples = [sample(k, lateral_position=offset, yaw_rate=0.01) for k in range(3)]
        return run(PARAMETERS, START, samples)

    _, batch = after(offsets)
    members = [after(offset)[1][-1] for offset in offsets.tolist()]
    assert batch[-1].applied_torque == pytest.approx(
        [m.applied_torque for m in members]
    )
    assert batch[-1].preview.lateral_error == pytest.approx(
        [m.preview.lateral_error for m in members]
    )
