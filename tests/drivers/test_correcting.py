"""Evidence gathers until a lane change is planned anew, at the driver's own pace."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.base.bezier import path_point, quintic
from costeer.drivers import correcting, decision, tracking
from costeer.drivers.correcting import CorrectingParameters, CorrectingState
from costeer.drivers.interface import Draw
from costeer.drivers.registry import driver_named
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import RoadParameters
from costeer.records.record import TrialRecord
from costeer.sensing.measurement import standing_start

DT = 1.0 / 60.0
GATHERS = CorrectingParameters(usual_error=0.2, evidence_rate=2.0, forgetting_time=1.0)
CHANGING = decision.initial_state()._replace(phase=decision.CHANGING)
PATH = quintic(0.0, 100.0, 0.0, 0.0, 0.0, -3.5)
CAR = standing_start(RoadParameters())


def judged(error: float, seconds: float, parameters: CorrectingParameters) -> list[int]:
    """Steps at which a new plan is made by a car that stays `error` beside its path."""
    aimed = tracking.initial_state(0.0)._replace(path=PATH)
    state = correcting.initial_state()
    there = path_point(PATH, 50.0).lateral_position + error
    car = CAR._replace(longitudinal_position=50.0, lateral_position=there)
    due = []
    for k in range(int(seconds / DT)):
        state = correcting.step(parameters, state, aimed, car, CHANGING, -1.0, DT)
        due += [k] if state.due else []
    return due


def test_no_plan_is_given_up_within_the_usual_error() -> None:
    assert judged(0.19, 20.0, GATHERS) == []


def test_a_larger_error_is_corrected_sooner_and_not_more_often_than_once_a_second() -> (
    None
):
    small, large = judged(0.4, 10.0, GATHERS), judged(0.8, 10.0, GATHERS)
    assert small[0] >= large[0]
    assert np.diff(large).min() * DT >= GATHERS.pause - DT
    assert judged(-0.8, 10.0, GATHERS) == large


def test_without_a_rate_nothing_is_planned_anew() -> None:
    assert judged(3.0, 20.0, GATHERS._replace(evidence_rate=0.0)) == []


@pytest.mark.parametrize(("way", "duration"), [(3.5, 6.0), (0.875, 3.0), (0.1, 2.0)])
def test_the_pace_stays_the_drivers_own(way: float, duration: float) -> None:
    # Peak lateral acceleration of a quintic is 5.77 way / duration², so with a quarter
    # of the way half of the time is left; the shortest is 2 s.
    plan = CorrectingState(0.0, 3.0, way=3.5, duration=6.0, due=False)
    assert correcting.paced(GATHERS, plan, way) == pytest.approx(duration)


def driven(rate: float, condition: str = "strong-rapid") -> TrialRecord:
    setup = TrialSetup(condition=condition, intention="scripted", length=3000.0)
    plans = (
        ("driver.correcting.evidence_rate", rate),
        ("driver.correcting.usual_error", 0.3),
    )
    return simulate_trial(setup._replace(parameters=plans))


def test_a_driver_who_plans_anew_drives_another_lane_change_with_guidance() -> None:
    once, anew = driven(0.0), driven(2.5)
    apart = once.columns["lateral_position"] - anew.columns["lateral_position"]
    assert np.abs(apart).max() > 0.05


def test_population_2_never_plans_anew() -> None:
    drawn = driver_named("virtual-2").parameters(Draw(seed=1, participant=1))
    assert judged(3.0, 20.0, drawn.correcting) == []
