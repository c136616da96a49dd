"""Decision to overtake and to return: when, in which order, how long, with a glance."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from costeer.drivers import decision
from costeer.drivers.decision import (
    CHANGING,
    CRUISING,
    PASSING,
    PREPARING,
    PREPARING_RETURN,
    RETURNING,
    DecisionParameters,
    DecisionState,
    Draws,
)
from costeer.plant.traffic import LeaderState
from tests.drivers.samples import DT, NO_LEADER, RIGHT, SPEED, driving, leader

PARAMETERS = DecisionParameters()
MEDIAN = Draws(duration_normal=0.0, preparation_normal=0.0, glance_uniform=0.5)


def overtaking() -> list[DecisionState]:
    """Two minutes behind, beside and ahead of a leader 15 km/h slower."""
    state, states = decision.initial_state(), []
    for k in range(round(120.0 / DT)):
        changed = state.phase in {CHANGING, PASSING, PREPARING_RETURN}
        car = driving(SPEED * DT * k, lane=RIGHT if changed else 1.0)
        ahead = leader(100.0 + (SPEED - 15.0 / 3.6) * DT * k, SPEED - 15.0 / 3.6)
        state = decision.step(PARAMETERS, state, car, ahead, MEDIAN, DT)
        states.append(state)
    return states


def first_step(leader_now: LeaderState, draws: Draws = MEDIAN) -> DecisionState:
    """The first step of a driver who comes up behind a leader."""
    start = decision.initial_state()
    return decision.step(PARAMETERS, start, driving(), leader_now, draws, DT)


def test_phases_run_once_in_their_order() -> None:
    phases = [phase for phase, _ in itertools.groupby(s.phase for s in overtaking())]
    order = [CRUISING, PREPARING, CHANGING, PASSING, PREPARING_RETURN, RETURNING]
    assert phases == [*order, CRUISING]


def test_each_phase_lasts_as_planned() -> None:
    counted = {
        phase: len(list(states)) * DT
        for phase, states in itertools.groupby(s.phase for s in overtaking())
    }
    settling = PARAMETERS.settling_time
    # A phase ends at the first step at or past its time, and is left at the next.
    assert counted[PREPARING] == pytest.approx(2.0, abs=2.0 * DT)
    assert counted[CHANGING] == pytest.approx(6.9 + settling, abs=2.0 * DT)
    assert counted[PREPARING_RETURN] == pytest.approx(0.7, abs=2.0 * DT)
    assert counted[RETURNING] == pytest.approx(6.9 + settling, abs=2.0 * DT)


def test_overtaking_is_decided_at_the_drivers_headway() -> None:
    close = PARAMETERS.headway * SPEED
    assert first_step(leader(close - 0.1, SPEED - 2.0)).phase == PREPARING
    assert first_step(leader(close + 0.1, SPEED - 2.0)).phase == CRUISING


def test_a_leader_that_drives_away_is_never_overtaken() -> None:
    for gap in (5.0, 10.0, 20.0, 40.0):
        assert first_step(leader(gap, SPEED + 0.6)).phase == CRUISING


def test_a_leader_in_the_other_lane_is_never_overtaken() -> None:
    assert first_step(leader(20.0, SPEED - 3.0, lane=RIGHT)).phase == CRUISING


def test_an_empty_road_gives_no_reason_to_overtake() -> None:
    assert first_step(NO_LEADER).phase == CRUISING


def test_a_driver_who_does_not_decide_stays_behind() -> None:
    passive = DecisionParameters(decides=0.0)
    state = decision.step(
        passive, decision.initial_state(), driving(), leader(9.0, 15.0), MEDIAN, DT
    )
    assert state.phase == CRUISING


def test_return_is_decided_when_the_leader_is_far_enough_behind() -> None:
    passing = decision.initial_state()._replace(phase=PASSING)

    def phase(distance_ahead: float) -> float:
        behind = leader(500.0 - distance_ahead, SPEED - 3.0)
        car = driving(500.0, lane=RIGHT)
        return decision.step(PARAMETERS, passing, car, behind, MEDIAN, DT).phase

    assert phase(PARAMETERS.return_distance - 1.0) == PASSING
    assert phase(PARAMETERS.return_distance + 1.0) == PREPARING_RETURN


@pytest.mark.parametrize("normal", [-2.0, 0.0, 1.0])
def test_planned_duration_is_log_normal_around_the_drivers_median(
    normal: float,
) -> None:
    draws = MEDIAN._replace(duration_normal=normal, preparation_normal=normal)
    planned = first_step(leader(20.0, SPEED - 3.0), draws)
    assert planned.change_duration == pytest.approx(6.9 * math.exp(0.17 * normal))
    assert planned.preparation_time == pytest.approx(2.0 * math.exp(0.35 * normal))


def test_plans_are_drawn_once_per_lane_change() -> None:
    planned = first_step(leader(20.0, SPEED - 3.0))
    other = Draws(duration_normal=3.0, preparation_normal=3.0, glance_uniform=0.99)
    next_state = decision.step(
        PARAMETERS, planned, driving(0.3), leader(20.2, SPEED - 3.0), other, DT
    )
    assert next_state.change_duration == planned.change_duration
    assert next_state.looks == planned.looks
    assert not next_state.decided


def test_share_of_lane_changes_with_a_glance_is_the_parameter() -> None:
    uniforms = np.random.default_rng(3).random(4000)
    looks = [
        first_step(
            leader(20.0, SPEED - 3.0), MEDIAN._replace(glance_uniform=float(u))
        ).looks
        for u in uniforms
    ]
    # Binomial: four standard deviations of 4000 draws.
    share, sd = 0.84, math.sqrt(0.84 * 0.16 / 4000)
    assert np.mean(looks) == pytest.approx(share, abs=4.0 * sd)


def test_direction_is_that_of_the_overtaking_lane_then_back() -> None:
    sides = {
        phase: decision.direction(decision.initial_state()._replace(phase=phase), -1.0)
        for phase in (CRUISING, PREPARING, CHANGING, PASSING, PREPARING_RETURN, 5.0)
    }
    assert list(sides.values()) == [0.0, -1.0, -1.0, 0.0, 1.0, 1.0]


def test_time_to_crossing_runs_down_without_a_jump_when_steering_starts() -> None:
    times = [
        decision.time_to_crossing(s)
        for s in overtaking()
        if s.phase in {PREPARING, CHANGING}
    ]
    steps = -np.diff(times)
    # The step at which steering starts may fall up to one step late.
    assert steps.min() > -DT
    assert steps.max() < 2.0 * DT + 1e-12
    assert times[0] == pytest.approx(2.0 + 6.9 / 2.0)
    assert times[-1] < 0.0
