"""Head: glances without a lane change, and the shape of one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.drivers import decision, gaze
from costeer.drivers.decision import CHANGING, CRUISING, PREPARING, DecisionState
from costeer.drivers.gaze import GazeDraws, GazeParameters
from tests.drivers.samples import DT

PARAMETERS = GazeParameters()
NO_DRAW = GazeDraws(
    start_uniform=1.0, side_uniform=0.0, amplitude_normal=0.0, drift_normal=0.0
)


def in_phase(phase: float, **changes: object) -> DecisionState:
    return decision.initial_state()._replace(phase=phase, **changes)


def head_after_decision(looks: bool, seconds: float) -> list[float]:
    """Head yaw after an overtaking to the right was decided."""
    state, yaws = gaze.initial_state(), []
    for k in range(round(seconds / DT)):
        decided = in_phase(PREPARING, looks=looks, decided=k == 0)
        state = gaze.step(PARAMETERS, state, decided, -1.0, NO_DRAW, DT)
        yaws.append(gaze.head_yaw(PARAMETERS, state))
    return yaws


def test_a_decision_turns_the_head_to_its_side_and_back() -> None:
    yaws = head_after_decision(looks=True, seconds=2.0)
    # A raised cosine: no jump larger than its steepest slope over one step.
    steepest = PARAMETERS.amplitude * math.pi / 2.0 / PARAMETERS.turning_time * DT
    assert min(yaws) == pytest.approx(-PARAMETERS.amplitude, rel=1e-3)
    assert max(np.abs(np.diff(yaws))) <= steepest + 1e-12
    assert yaws[-1] == 0.0


def test_a_glance_lasts_as_long_as_its_parameter() -> None:
    turned = np.count_nonzero(np.array(head_after_decision(True, 2.0)) < 0.0) * DT
    # It begins and ends at zero: two samples do not show.
    assert turned == pytest.approx(PARAMETERS.duration, abs=2.5 * DT)


def test_a_driver_who_does_not_look_keeps_the_head_ahead() -> None:
    assert set(head_after_decision(looks=False, seconds=2.0)) == {0.0}


def false_glances(num_drivers: int, seconds: float) -> tuple[int, int]:
    """Glances to the left and to the right of drivers who cruise."""
    generator = np.random.default_rng(5)
    state = gaze.initial_state()
    left = right = 0
    for _ in range(round(seconds / DT)):
        before = state
        draws = GazeDraws(
            start_uniform=generator.random(num_drivers),
            side_uniform=generator.random(num_drivers),
            amplitude_normal=np.zeros(num_drivers),
            drift_normal=np.zeros(num_drivers),
        )
        state = gaze.step(PARAMETERS, state, in_phase(CRUISING), 0.0, draws, DT)
        begun = state.glancing & (np.asarray(state.time_in_glance) == 0.0)
        assert not (begun & before.glancing & (before.time_in_glance < 1.0)).any()
        left += int(np.count_nonzero(begun & (state.side > 0.0)))
        right += int(np.count_nonzero(begun & (state.side < 0.0)))
    return left, right


def test_glances_without_a_lane_change_come_at_their_rate_to_either_side() -> None:
    num_drivers, seconds = 4000, 30.0
    counts = false_glances(num_drivers, seconds)
    # A glance begins 1 / (2 · rate) s after the last has ended, on average.
    cycle = 0.5 / PARAMETERS.false_rate + PARAMETERS.duration
    expected = 0.5 * num_drivers * seconds / cycle
    for count in counts:  # about Poisson: four standard deviations
        assert count == pytest.approx(expected, abs=4.0 * math.sqrt(expected))


def test_15_percent_of_6_s_windows_hold_a_glance_to_one_side() -> None:
    # Jain et al. (2015) count head yaw above 0.25 to 0.3 rad; the window may also
    # hold the rest of a glance that began up to its duration before.
    seen = PARAMETERS.false_rate * (6.0 + PARAMETERS.duration)
    assert 1.0 - math.exp(-seen) == pytest.approx(0.15, abs=0.03)


def test_no_glance_starts_by_itself_after_the_line_is_crossed() -> None:
    late = in_phase(CHANGING, looks=True, time_in_phase=4.0, change_duration=6.0)
    early = in_phase(CHANGING, looks=True, time_in_phase=1.0, change_duration=6.0)
    assert gaze.start_probability(PARAMETERS, late, -1.0, DT) == 0.0
    assert gaze.start_probability(PARAMETERS, early, -1.0, DT) == pytest.approx(
        0.25 * DT
    )


def test_a_driver_who_forgets_to_look_has_no_glance_on_the_way() -> None:
    for phase in (PREPARING, CHANGING):
        forgot = in_phase(phase, looks=False, change_duration=6.0)
        assert gaze.start_probability(PARAMETERS, forgot, -1.0, DT) == 0.0


def test_a_glance_is_mostly_large_enough_to_be_counted() -> None:
    # Log-normal around 0.29 · 90 deg = 0.456 rad; 0.25 rad is three deviations below.
    deviations = math.log(0.25 / (PARAMETERS.amplitude * math.pi / 2.0)) / 0.2
    assert deviations < -3.0


def test_head_yaw_stays_in_its_range() -> None:
    wild = gaze.initial_state()._replace(
        glancing=True, time_in_glance=0.5, amplitude=3.0, drift=0.5
    )
    assert gaze.head_yaw(PARAMETERS, wild) == 1.0
