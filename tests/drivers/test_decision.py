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
    Surroundings,
)
from costeer.plant.traffic import LeaderState
from costeer.sensing.measurement import Measurement
from tests.drivers.samples import DT, NO_LEADER, RIGHT, SPEED, driving, leader

PARAMETERS = DecisionParameters()
MEDIAN = Draws(
    duration_normal=0.0,
    preparation_normal=0.0,
    glance_uniform=0.5,
    abandoned_uniform=0.5,
)


def around(
    car: Measurement, ahead: LeaderState, wanted_speed: float = SPEED
) -> Surroundings:
    return Surroundings(measurement=car, leader=ahead, wanted_speed=wanted_speed)


def overtaking() -> list[DecisionState]:
    """Two minutes behind, beside and ahead of a leader 15 km/h slower."""
    state, states = decision.initial_state(), []
    for k in range(round(120.0 / DT)):
        changed = state.phase in {CHANGING, PASSING, PREPARING_RETURN}
        car = driving(SPEED * DT * k, lane=RIGHT if changed else 1.0)
        ahead = leader(100.0 + (SPEED - 15.0 / 3.6) * DT * k, SPEED - 15.0 / 3.6)
        state = decision.step(PARAMETERS, state, around(car, ahead), MEDIAN, DT)
        states.append(state)
    return states


def first_step(leader_now: LeaderState, draws: Draws = MEDIAN) -> DecisionState:
    """The first step of a driver who comes up behind a leader."""
    start = decision.initial_state()
    return decision.step(PARAMETERS, start, around(driving(), leader_now), draws, DT)


def followed_for(
    difference: float,
    seconds: float,
    start: DecisionState | None = None,
    lane: float = 1.0,
) -> tuple[DecisionState, float]:
    """Follow a leader slower by `difference`; last state and time of the decision."""
    state, decided = start or decision.initial_state(), math.inf
    ahead = leader(20.0, SPEED - difference, lane)
    for k in range(round(seconds / DT)):
        state = decision.step(PARAMETERS, state, around(driving(), ahead), MEDIAN, DT)
        if state.decided:
            return state, k * DT
    return state, decided


def test_phases_run_once_in_their_order() -> None:
    phases = [phase for phase, _ in itertools.groupby(s.phase for s in overtaking())]
    order = [CRUISING, PREPARING, CHANGING, PASSING, PREPARING_RETURN, RETURNING]
    assert phases == [*order, CRUISING]


def test_each_phase_lasts_as_planned() -> None:
    counted = {
        phase: len(list(states)) * DT
        for phase, states in itertools.groupby(s.phase for s in overtaking())
    }
    lasting = PARAMETERS.change_duration + PARAMETERS.settling_time
    # A phase ends at the first step at or past its time, and is left at the next.
    assert counted[PREPARING] == pytest.approx(
        PARAMETERS.preparation_time, abs=2.0 * DT
    )
    assert counted[CHANGING] == pytest.approx(lasting, abs=2.0 * DT)
    assert counted[PREPARING_RETURN] == pytest.approx(
        PARAMETERS.return_preparation_time, abs=2.0 * DT
    )
    assert counted[RETURNING] == pytest.approx(lasting, abs=2.0 * DT)


def test_overtaking_is_decided_at_the_drivers_headway() -> None:
    close = PARAMETERS.headway * SPEED
    assert first_step(leader(close - 0.1, SPEED - 2.0)).phase == PREPARING
    assert first_step(leader(close + 0.1, SPEED - 2.0)).phase == CRUISING


def test_a_leader_faster_than_wanted_is_never_overtaken() -> None:
    for difference in (0.0, -0.01, -0.6, -5.0):
        state, decided = followed_for(difference, 60.0)
        assert decided == math.inf
        assert state.impatience == 0.0


def test_a_clearly_slower_leader_is_overtaken_at_once() -> None:
    # 5 to 15 km/h, as in the experiment; 3.6 km/h is where it begins.
    for difference in (1.01, 5.0 / 3.6, 15.0 / 3.6):
        assert followed_for(difference, 1.0)[1] == 0.0
    assert followed_for(0.99, 1.0)[1] == math.inf


@pytest.mark.parametrize("difference", [0.05, 0.5, 0.99])
def test_a_hardly_slower_leader_is_overtaken_when_patience_ends(
    difference: float,
) -> None:
    # The driver must have waited longer than the patience: one or two steps more.
    decided = followed_for(difference, 20.0)[1]
    assert decided == pytest.approx(PARAMETERS.patience, abs=2.5 * DT)
    assert decided > PARAMETERS.patience


def test_impatience_is_forgotten_when_the_way_is_free() -> None:
    waited, decided = followed_for(0.5, PARAMETERS.patience - 0.1)
    assert decided == math.inf
    assert waited.impatience == pytest.approx(PARAMETERS.patience - 0.1, abs=DT)
    free = decision.step(PARAMETERS, waited, around(driving(), NO_LEADER), MEDIAN, DT)
    assert free.impatience == 0.0
    assert followed_for(0.5, 20.0, free)[1] == pytest.approx(
        PARAMETERS.patience, abs=2.5 * DT
    )


def test_impatience_is_forgotten_after_an_overtaking() -> None:
    assert {state.impatience for state in overtaking() if state.phase != CRUISING} == {
        0.0
    }


def test_whoever_wants_to_be_faster_overtakes_the_same_leader() -> None:
    close = leader(20.0, SPEED - 0.5)
    start = decision.initial_state()
    phases = [
        decision.step(
            PARAMETERS, start, around(driving(), close, wanted), MEDIAN, DT
        ).phase
        for wanted in (SPEED, SPEED + 1.0)
    ]
    assert phases == [CRUISING, PREPARING]


def test_a_leader_in_the_other_lane_is_never_overtaken() -> None:
    assert first_step(leader(20.0, SPEED - 3.0, lane=RIGHT)).phase == CRUISING


def test_an_empty_road_gives_no_reason_to_overtake() -> None:
    assert first_step(NO_LEADER).phase == CRUISING


def test_a_driver_who_does_not_decide_stays_behind() -> None:
    passive = DecisionParameters(decides=0.0)
    state = decision.initial_state()._replace(impatience=100.0)
    near = around(driving(), leader(9.0, 15.0))
    assert decision.step(passive, state, near, MEDIAN, DT).phase == CRUISING


def test_return_is_decided_when_the_leader_is_far_enough_behind() -> None:
    passing = decision.initial_state()._replace(phase=PASSING)

    def phase(distance_ahead: float) -> float:
        behind = leader(500.0 - distance_ahead, SPEED - 3.0)
        car = driving(500.0, lane=RIGHT)
        return decision.step(PARAMETERS, passing, around(car, behind), MEDIAN, DT).phase

    enough = PARAMETERS.return_headway * SPEED
    assert phase(enough - 0.1) == PASSING
    assert phase(enough + 0.1) == PREPARING_RETURN


def test_a_driver_returns_when_no_leader_is_left() -> None:
    passing = decision.initial_state()._replace(phase=PASSING)
    alone = around(driving(lane=RIGHT), NO_LEADER)
    assert decision.step(PARAMETERS, passing, alone, MEDIAN, DT).phase == (
        PREPARING_RETURN
    )


@pytest.mark.parametrize("normal", [-2.0, 0.0, 1.0])
def test_planned_duration_is_log_normal_around_the_drivers_median(
    normal: float,
) -> None:
    draws = MEDIAN._replace(duration_normal=normal, preparation_normal=normal)
    planned = first_step(leader(20.0, SPEED - 3.0), draws)
    assert planned.change_duration == pytest.approx(
        PARAMETERS.change_duration * math.exp(0.1 * normal)
    )
    assert planned.preparation_time == pytest.approx(
        PARAMETERS.preparation_time * math.exp(0.35 * normal)
    )


def test_plans_are_drawn_once_per_lane_change() -> None:
    planned = first_step(leader(20.0, SPEED - 3.0))
    other = Draws(
        duration_normal=3.0,
        preparation_normal=3.0,
        glance_uniform=0.99,
        abandoned_uniform=0.0,
    )
    next_state = decision.step(
        PARAMETERS, planned, around(driving(0.3), leader(20.2, 16.0)), other, DT
    )
    assert next_state.change_duration == planned.change_duration
    assert next_state.looks == planned.looks
    assert next_state.looks_over_shoulder == planned.looks_over_shoulder
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


def test_a_look_over_the_shoulder_is_one_of_a_driver_who_looks() -> None:
    plans = [
        first_step(leader(20.0, SPEED - 3.0), MEDIAN._replace(glance_uniform=u))
        for u in np.linspace(0.0, 0.999, 1000).tolist()
    ]
    assert all(plan.looks for plan in plans if plan.looks_over_shoulder)
    # Uniform numbers 1/1000 apart.
    shoulder = np.mean([plan.looks_over_shoulder for plan in plans])
    assert shoulder == pytest.approx(PARAMETERS.shoulder_share, abs=2e-3)


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
    assert times[0] == pytest.approx(
        PARAMETERS.preparation_time + PARAMETERS.change_duration / 2.0
    )
    assert times[-1] < 0.0
