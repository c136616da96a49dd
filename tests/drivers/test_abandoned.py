"""Lane changes that are given up: how many, when, and what the driver does then."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.bezier import path_point
from costeer.drivers import decision, driver
from costeer.drivers.decision import (
    CHANGING,
    CRUISING,
    NEVER,
    PASSING,
    PREPARING,
    PREPARING_RETURN,
    RETURNING,
    DecisionParameters,
    DecisionState,
    Draws,
    Surroundings,
)
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverNoise, Knowledge
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import lane_centre
from tests.drivers.samples import DT, LEFT, NO_LEADER, RIGHT, SPEED, driving, leader

FAITHFUL = DecisionParameters()
FICKLE = DecisionParameters(abandoned_share=1.0)
PREPARATION, DURATION = FICKLE.preparation_time, FICKLE.change_duration
LATEST = PREPARATION + FICKLE.abandoned_latest * DURATION
ROAD = RoadParameters()


def draws(abandoned_uniform: float) -> Draws:
    """Of a median lane change."""
    return Draws(
        duration_normal=0.0,
        preparation_normal=0.0,
        glance_uniform=0.5,
        abandoned_uniform=abandoned_uniform,
    )


def behind(
    parameters: DecisionParameters, uniform: float, seconds: float
) -> list[DecisionState]:
    """What a driver is up to behind a leader who stays 20 m ahead."""
    states = [decision.initial_state()]
    slower = Surroundings(driving(), leader(20.0, SPEED - 3.0), SPEED)
    for _ in range(round(seconds / DT)):
        states.append(decision.step(parameters, states[-1], slower, draws(uniform), DT))
    return states[1:]


def overtaking(uniform: float, share: float = 0.0) -> list[DecisionState]:
    """Two minutes behind, beside and ahead of a leader 15 km/h slower."""
    parameters = FAITHFUL._replace(abandoned_share=share)
    state, states = decision.initial_state(), []
    for k in range(round(120.0 / DT)):
        out = state.phase in {CHANGING, PASSING, PREPARING_RETURN}
        around = Surroundings(
            measurement=driving(SPEED * DT * k, lane=RIGHT if out else LEFT),
            leader=leader(100.0 + (SPEED - 15.0 / 3.6) * DT * k, SPEED - 15.0 / 3.6),
            wanted_speed=SPEED,
        )
        state = decision.step(parameters, state, around, draws(uniform), DT)
        states.append(state)
    return states


def phases(states: list[DecisionState]) -> list[float]:
    return [phase for phase, _ in itertools.groupby(s.phase for s in states)]


@pytest.mark.parametrize(
    "uniform", [0.0, *(pytest.param(u, marks=pytest.mark.slow) for u in (0.5, 0.999))]
)
def test_without_a_share_no_lane_change_is_given_up(uniform: float) -> None:
    states = overtaking(uniform)
    order = [CRUISING, PREPARING, CHANGING, PASSING, PREPARING_RETURN, RETURNING]
    assert phases(states) == [*order, CRUISING]
    assert states == overtaking(0.7)
    assert {s.gives_up_after for s in states} == {NEVER}
    assert {s.pause for s in states} == {0.0}


@pytest.mark.slow
def test_a_lane_change_whose_lot_is_not_drawn_is_as_without_a_share() -> None:
    assert overtaking(0.5, share=0.4) == overtaking(0.5)
    assert overtaking(0.39, share=0.4) != overtaking(0.39)


@given(
    st.floats(0.01, 1.0),
    st.floats(0.0, 1.0, exclude_max=True),
    st.floats(0.1, 5.0),
    st.floats(3.0, 12.0),
)
def test_the_moment_of_giving_up_is_uniform_from_decision_to_latest(
    share: float, uniform: float, preparation: float, duration: float
) -> None:
    parameters = FAITHFUL._replace(abandoned_share=share)
    moment = decision.abandoned_after(parameters, uniform, preparation, duration)
    latest = preparation + parameters.abandoned_latest * duration
    if uniform < share:
        # A uniform number below the share, over the share, is uniform below 1.
        assert moment == pytest.approx(uniform / share * latest)
        assert 0.0 <= moment < latest * (1.0 + 1e-12)
    else:
        assert moment == NEVER


def test_of_many_lane_changes_the_share_is_given_up() -> None:
    parameters = FAITHFUL._replace(abandoned_share=0.05)
    uniforms = (np.arange(10_000) + 0.5) / 10_000
    moments = np.array(
        [
            decision.abandoned_after(parameters, u, PREPARATION, DURATION)
            for u in uniforms.tolist()
        ]
    )
    given_up = moments[moments < NEVER]
    assert len(given_up) == 500
    np.testing.assert_allclose(given_up, (np.arange(500) + 0.5) / 500 * LATEST)


@pytest.mark.parametrize("uniform", [0.1, 0.3, 0.6, 0.9])
def test_every_decision_of_a_fickle_driver_is_given_up_at_its_moment(
    uniform: float,
) -> None:
    states = behind(FICKLE, uniform, 60.0)
    assert set(phases(states)) <= {CRUISING, PREPARING, CHANGING}
    decided = [k for k, s in enumerate(states) if s.decided]
    if states[-1].phase != CRUISING:
        decided.pop()  # the end comes before the last is given up
    assert len(decided) > 2
    for k in decided:
        after = next(i for i, s in enumerate(states[k:]) if s.phase == CRUISING)
        # Each phase is left up to two steps late, and there are at most two.
        assert after * DT == pytest.approx(uniform * LATEST, abs=4.0 * DT)


def test_no_decision_falls_before_the_other_car_has_passed() -> None:
    states = behind(FICKLE, 0.5, 60.0)
    gaps = [
        len(list(group)) * DT
        for phase, group in itertools.groupby(s.phase for s in states)
        if phase == CRUISING
    ]
    for gap in gaps[:-1]:
        assert gap == pytest.approx(FICKLE.abandoned_pause, abs=2.5 * DT)
        assert gap > FICKLE.abandoned_pause - 0.5 * DT


def test_nothing_is_meant_after_giving_up() -> None:
    for state in behind(FICKLE, 0.8, 60.0):
        means = decision.direction(state, -1.0)
        assert means == (-1.0 if state.phase in {PREPARING, CHANGING} else 0.0)
        if state.phase == CRUISING:
            assert decision.time_to_crossing(state) == NEVER


def test_a_change_given_up_while_it_is_prepared_is_never_steered() -> None:
    uniform = 0.9 * PREPARATION / LATEST
    states = behind(FICKLE, uniform, 60.0)
    assert phases(states)[:3] == [PREPARING, CRUISING, PREPARING]
    assert not any(state.started for state in states)


def test_a_change_given_up_on_the_way_is_steered_out_and_back() -> None:
    states = behind(FICKLE, 1.1 * PREPARATION / LATEST, 60.0)
    steers = [state.phase for state in states if state.started]
    assert steers[:4] == [CHANGING, CRUISING, CHANGING, CRUISING]
    before = [s.phase for s, after in itertools.pairwise(states) if after.started]
    assert before[:4] == [PREPARING, CHANGING, PREPARING, CHANGING]


def test_a_plan_to_give_up_is_drawn_once_per_lane_change() -> None:
    first = behind(FICKLE, 0.6, DT)[-1]
    slower = Surroundings(driving(0.3), leader(20.2, SPEED - 3.0), SPEED)
    later = decision.step(FICKLE, first, slower, draws(0.1), DT)
    assert first.decided
    assert later.gives_up_after == first.gives_up_after == pytest.approx(0.6 * LATEST)


def on_the_way(phase: float, since: float) -> DecisionState:
    """A driver who gives up at this step."""
    return decision.initial_state()._replace(
        phase=phase,
        time_in_phase=since,
        preparation_time=1.0,
        change_duration=DURATION,
        gives_up_after=1.0 + since if phase in {CHANGING, RETURNING} else since,
    )


@pytest.mark.parametrize(
    ("phase", "stays"),
    [
        (PREPARING, CRUISING),
        (CHANGING, CRUISING),
        (PREPARING_RETURN, PASSING),
        (RETURNING, PASSING),
    ],
)
def test_who_gives_up_stays_in_the_lane_of_the_decision(
    phase: float, stays: float
) -> None:
    alone = Surroundings(driving(lane=RIGHT), NO_LEADER, SPEED)
    state = decision.step(FICKLE, on_the_way(phase, 0.5), alone, draws(0.5), DT)
    assert state.phase == stays
    assert state.pause == FICKLE.abandoned_pause
    assert state.time_in_phase == 0.0
    early = on_the_way(phase, 0.5)._replace(time_in_phase=0.5 - 2.0 * DT)
    assert decision.step(FICKLE, early, alone, draws(0.5), DT).phase == phase


@pytest.mark.parametrize("settled", [CRUISING, PASSING])
def test_a_settled_driver_has_nothing_to_give_up(settled: float) -> None:
    state = decision.initial_state()._replace(phase=settled, gives_up_after=0.0)
    assert not decision.gives_up(state._replace(time_in_phase=100.0))


@pytest.mark.parametrize(
    ("phase", "lane"), [(CHANGING, LEFT), (RETURNING, RIGHT), (PREPARING, None)]
)
def test_the_path_leads_back_to_the_lane_it_came_from(
    phase: float, lane: float | None
) -> None:
    quiet = DriverNoise(*([0.0] * len(DriverNoise._fields)))
    knowledge = Knowledge(CarParameters(), ColumnParameters(), ROAD)
    car = driving(100.0, -0.6 if phase == CHANGING else -2.9, yaw_angle=0.01)
    before = driver.initial_state(DriverParameters(), -9.0)
    around = Surroundings(car, leader(120.0, SPEED - 3.0), SPEED)
    after = decision.step(FICKLE, on_the_way(phase, 2.0), around, draws(0.5), DT)
    aimed, _ = driver.aim(DriverParameters(), before, knowledge, car, after, quiet, DT)
    end = path_point(aimed.path, 1000.0).lateral_position
    if lane is None:
        assert aimed.path == before.tracking.path
        return
    assert end == pytest.approx(lane_centre(ROAD, lane))
    start = path_point(aimed.path, car.longitudinal_position)
    assert start.lateral_position == pytest.approx(car.lateral_position)
    assert start.slope == pytest.approx(math.tan(car.yaw_angle))
