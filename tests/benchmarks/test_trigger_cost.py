"""False and missed triggers, provoked: what they are and what they cost."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from benchmarks.trigger_cost import (
    ANNOUNCED_CROSSING,
    EVENTS,
    FALSE_TRIGGER,
    MISSED_CROSSING,
    NO_TRIGGER,
    SEED,
    Provoked,
    falsely_triggered,
    provoke,
    spread,
    trial_of,
)
from costeer.loop.scenario import PILOT_SEED
from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.configuration import PUBLISHED_STUDY
from costeer.study.trigger_costs import COST_COLUMNS

DRIVEN = ("manual", "strong-rapid", "strong-gentle", "weak-rapid")


@cache
def one_driver() -> dict[tuple[str, str], Provoked]:
    return {(p.condition, p.event): p for p in provoke(SEED, 1, DRIVEN)}


def found(condition: str, event: str) -> Provoked:
    return one_driver()[condition, event]


def alike(one: Provoked, other: Provoked) -> bool:
    return all(
        np.array_equal(one.costs[name], other.costs[name], equal_nan=True)
        for name in COST_COLUMNS
    )


def test_the_drivers_are_in_no_study_and_no_pilot_run() -> None:
    assert SEED not in (PUBLISHED_STUDY.seed, PILOT_SEED)


def test_all_conditions_meet_the_same_driver_with_the_same_noise() -> None:
    for make in (trial_of, lambda *of: falsely_triggered(*of, trial=2)):
        setups = [make(name, SEED, 3) for name in CONDITION_NAMES]
        assert (
            len({(s.participant, s.seed, s.condition, s.length) for s in setups}) == 1
        )
        assert {s.intention for s in setups} == {"off"}


@pytest.mark.slow
def test_a_false_trigger_comes_once_to_a_driver_who_has_nothing_to_overtake() -> None:
    setups = [falsely_triggered("weak-rapid", SEED, 1, trial) for trial in range(4)]
    assert [len(setup.trigger_times) for setup in setups] == [1] * 4
    assert not any(setup.events for setup in setups)
    assert found("weak-rapid", FALSE_TRIGGER).num_events == 4
    assert found("weak-rapid", NO_TRIGGER).num_events == 4


@pytest.mark.slow
def test_in_manual_driving_neither_a_trigger_nor_its_absence_costs_anything() -> None:
    assert alike(found("manual", FALSE_TRIGGER), found("manual", NO_TRIGGER))
    assert alike(found("manual", MISSED_CROSSING), found("manual", ANNOUNCED_CROSSING))
    assert np.isnan(found("manual", FALSE_TRIGGER).costs["gain_minimum"]).all()


@pytest.mark.slow
@pytest.mark.parametrize("condition", DRIVEN[1:])
def test_a_false_trigger_is_a_conflict_where_there_was_none(condition: str) -> None:
    false, none = found(condition, FALSE_TRIGGER), found(condition, NO_TRIGGER)
    assert (false.costs["inconsistent"] == 1.0).all()
    assert (none.costs["inconsistent"] == 0.0).all()
    for name in ("peak_driver_torque", "peak_opposing_torque", "time_to_settle"):
        assert (false.costs[name] > none.costs[name]).all(), name
    # The car is where it was at the trigger, with the trigger and without.
    same = ("initial_deviation",)
    assert all(np.array_equal(false.costs[k], none.costs[k]) for k in same)


@pytest.mark.slow
def test_all_eight_changes_of_a_course_are_missed_or_all_announced() -> None:
    for event in (MISSED_CROSSING, ANNOUNCED_CROSSING):
        assert [found(name, event).num_events for name in DRIVEN] == [8] * len(DRIVEN)


@pytest.mark.slow
def test_a_system_that_notices_nothing_never_uses_its_duration() -> None:
    rapid, gentle = (
        found(f"strong-{pace}", MISSED_CROSSING) for pace in ("rapid", "gentle")
    )
    assert alike(rapid, gentle)
    told = (found(f"strong-{pace}", ANNOUNCED_CROSSING) for pace in ("rapid", "gentle"))
    assert not alike(*told)


@pytest.mark.slow
def test_a_missed_change_meets_a_guidance_that_keeps_the_old_lane() -> None:
    missed = found("strong-rapid", MISSED_CROSSING).costs
    told = found("strong-rapid", ANNOUNCED_CROSSING).costs
    assert (missed["inconsistent"] == 1.0).all()
    assert np.median(missed["driver_torque_rms"]) > np.median(told["driver_torque_rms"])


@pytest.mark.slow
def test_threads_change_no_number() -> None:
    again = provoke(SEED, 1, DRIVEN[1:2], jobs=1)
    assert [each.event for each in again] == list(EVENTS)
    assert all(alike(each, found("strong-rapid", each.event)) for each in again)


@pytest.mark.slow
def test_progress_tells_each_driver_of_each_condition() -> None:
    told: list[int] = []
    provoke(SEED, 1, ("manual",), progress=told.append)
    assert told == [1]


def made_up(*values: float) -> Provoked:
    costs = {name: np.array(values) for name in COST_COLUMNS}
    return Provoked("strong-rapid", FALSE_TRIGGER, len(values), costs)


def test_a_spread_is_over_the_events_that_have_the_cost() -> None:
    values = [float(n) for n in range(11)]
    seen = spread(made_up(*values, math.nan), "time_to_recover")
    assert seen[:3] == pytest.approx((1.0, 5.0, 9.0))
    assert (seen.mean, seen.num_known) == (5.0, 11)
    assert spread(made_up(1.0, 0.0, 0.0, 0.0), "left_lane").mean == 0.25


def test_without_an_event_there_is_no_spread() -> None:
    seen = spread(made_up(), "left_lane")
    assert seen.num_known == 0
    assert np.isnan(seen[:4]).all()


def test_an_unknown_cost_is_refused() -> None:
    with pytest.raises(ValueError, match="cost 'money' is not known; choose one of"):
        spread(made_up(1.0), "money")
