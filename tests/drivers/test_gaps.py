"""Gaps that a driver accepts, and lanes that are worth changing to."""

from __future__ import annotations

import math

import pytest

from costeer.drivers import decision
from costeer.drivers.decision import (
    CHANGING,
    CRUISING,
    PASSING,
    PREPARING,
    RETURNING,
    DecisionParameters,
    DecisionState,
    Draws,
    Surroundings,
    accepts,
    is_worth_overtaking,
    is_worth_returning,
    next_phase,
    wants_to_return,
)
from costeer.plant.following import LONGEST_GAP, Ahead, LaneOutlook
from tests.drivers.samples import DT, NO_LEADER, RIGHT, SPEED, driving, leader

PARAMETERS = DecisionParameters()
FREE = LaneOutlook()
EPSILON = 1e-6


def lane(
    ahead: float = LONGEST_GAP,
    behind: float = LONGEST_GAP,
    faster: float = 0.0,
) -> LaneOutlook:
    """A lane whose cars are faster than the own one by so much [m/s]."""
    return LaneOutlook(
        Ahead(gap=ahead, velocity=SPEED + faster),
        Ahead(gap=behind, velocity=SPEED + faster),
    )


def test_an_empty_lane_is_accepted() -> None:
    assert accepts(PARAMETERS, FREE, driving())


@pytest.mark.parametrize("faster", [0.0, 1.0, 5.0, 15.0])
def test_the_gap_behind_is_a_headway_of_the_car_there_or_its_time_to_come(
    faster: float,
) -> None:
    # 0.8 s of the car behind, or 5 s of what it is faster, whatever is more.
    needed = max(0.8 * (SPEED + faster), 5.0 * faster)
    assert not accepts(
        PARAMETERS, lane(behind=needed - EPSILON, faster=faster), driving()
    )
    assert accepts(PARAMETERS, lane(behind=needed + EPSILON, faster=faster), driving())


@pytest.mark.parametrize("slower", [0.0, 1.0, 5.0, 15.0])
def test_the_gap_ahead_is_the_own_headway_or_the_time_to_reach_it(
    slower: float,
) -> None:
    needed = max(0.6 * SPEED, 5.0 * slower)
    assert not accepts(
        PARAMETERS, lane(ahead=needed - EPSILON, faster=-slower), driving()
    )
    assert accepts(PARAMETERS, lane(ahead=needed + EPSILON, faster=-slower), driving())


def test_a_car_that_falls_behind_or_flees_needs_no_time_to_close() -> None:
    assert accepts(
        PARAMETERS, lane(behind=0.8 * (SPEED - 10.0) + EPSILON, faster=-10.0), driving()
    )
    assert accepts(
        PARAMETERS, lane(ahead=0.6 * SPEED + EPSILON, faster=10.0), driving()
    )


@pytest.mark.parametrize("gap", [-2.0, 0.0])
def test_a_car_beside_is_no_gap(gap: float) -> None:
    assert not accepts(PARAMETERS, lane(ahead=gap), driving())
    assert not accepts(PARAMETERS, lane(behind=gap), driving())


def around(
    outer: LaneOutlook = FREE, home: LaneOutlook = FREE, asked: float = 0.0
) -> Surroundings:
    """A slow leader ahead, near enough to overtake."""
    slow = leader(12.0, SPEED - 5.0)
    return Surroundings(driving(), slow, SPEED, outer, home, asked)


def test_overtaking_is_worth_it_into_a_free_or_a_faster_lane() -> None:
    far = PARAMETERS.return_room * PARAMETERS.headway * SPEED
    slow = -5.0  # as slow as the leader
    assert is_worth_overtaking(PARAMETERS, around(lane(far + EPSILON, faster=slow)))
    assert not is_worth_overtaking(PARAMETERS, around(lane(far - EPSILON, faster=slow)))
    enough = slow + PARAMETERS.worthwhile_difference
    assert is_worth_overtaking(PARAMETERS, around(lane(20.0, faster=enough + EPSILON)))
    assert not is_worth_overtaking(
        PARAMETERS, around(lane(20.0, faster=enough - EPSILON))
    )


def test_returning_is_worth_it_into_a_free_or_a_fast_lane() -> None:
    far = PARAMETERS.return_room * PARAMETERS.headway * SPEED
    for gap, worth in ((far + EPSILON, True), (far - EPSILON, False)):
        assert (
            is_worth_returning(PARAMETERS, around(home=lane(gap, faster=-3.0))) == worth
        )
    assert is_worth_returning(PARAMETERS, around(home=lane(20.0)))


def waiting(phase: float) -> DecisionState:
    """Long in a phase, so that only what is around decides."""
    return decision.initial_state()._replace(phase=phase, time_in_phase=100.0)


def then(phase: float, surroundings: Surroundings) -> float:
    return float(next_phase(PARAMETERS, waiting(phase), surroundings))


SHUT = lane(behind=1.0)


@pytest.mark.parametrize(
    ("phase", "onwards"), [(CRUISING, PREPARING), (PREPARING, CHANGING)]
)
def test_nobody_goes_out_into_a_gap_that_is_shut(phase: float, onwards: float) -> None:
    assert then(phase, around()) == onwards
    assert then(phase, around(outer=SHUT)) == phase
    assert then(phase, around(home=SHUT)) == onwards


def passing(home: LaneOutlook = FREE, asked: float = 0.0) -> Surroundings:
    away = leader(-100.0, SPEED - 5.0)
    beside = driving(lateral_position=-3.5, lane=RIGHT)
    return Surroundings(beside, away, SPEED, FREE, home, asked)


@pytest.mark.parametrize(
    ("phase", "onwards"), [(PASSING, PASSING + 1.0), (PASSING + 1.0, RETURNING)]
)
def test_nobody_returns_into_a_gap_that_is_shut(phase: float, onwards: float) -> None:
    assert then(phase, passing()) == onwards
    assert then(phase, passing(home=SHUT)) == phase


def test_a_lane_change_that_is_asked_for_needs_a_gap_and_nothing_else() -> None:
    nothing = Surroundings(driving(), NO_LEADER, SPEED)
    assert then(CRUISING, nothing) == CRUISING
    assert then(CRUISING, nothing._replace(asked=1.0)) == PREPARING
    assert then(CRUISING, nothing._replace(asked=1.0, outer=SHUT)) == CRUISING
    assert then(CRUISING, nothing._replace(asked=-1.0)) == CRUISING
    near = passing(home=lane(20.0, faster=-5.0))
    assert then(PASSING, near) == PASSING  # not worth it
    assert then(PASSING, near._replace(asked=-1.0, home=lane(80.0))) == PASSING + 1.0


def test_a_leader_in_the_own_lane_is_no_reason_to_stay_out() -> None:
    out = driving(position=100.0, lateral_position=-3.5, lane=RIGHT)
    beside = leader(80.0, 15.0)  # in the left lane, 20 m behind
    assert not wants_to_return(PARAMETERS, out, beside)
    assert wants_to_return(PARAMETERS, out, beside._replace(lane=RIGHT))


def test_a_driver_waits_for_the_gap_and_then_goes() -> None:
    state, phases = decision.initial_state(), []
    draws = Draws(0.0, 0.0, 0.5, 0.5)
    for k in range(round(20.0 / DT)):
        open_now = k * DT >= 10.0
        asked = around(outer=FREE if open_now else SHUT, asked=1.0)
        state = decision.step(PARAMETERS, state, asked, draws, DT)
        phases.append(float(state.phase))
    before = phases[: round(10.0 / DT)]
    assert max(before) <= PREPARING
    assert CHANGING in phases
    assert not math.isnan(state.change_duration)
