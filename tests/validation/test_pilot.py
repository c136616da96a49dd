"""The inconsistency threshold from pilot drivers who agree with the system."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.controller.consistency import ConsistencyParameters
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.validation import pilot
from costeer.validation.pilot import (
    FACTOR,
    PERCENTILE,
    agreeing_setups,
    opposed_gaps,
    pilot_threshold,
)


@cache
def gaps_of_first() -> list[NDArray[np.float64]]:
    return [opposed_gaps(setup) for setup in agreeing_setups(1)]


def test_pilot_runs_are_lane_keeping_and_own_lane_changes_strong_and_weak() -> None:
    setups = agreeing_setups(1)
    assert [s.strength_factor for s in setups] == [1.0, 1.0, 0.4, 0.4]
    assert [s.events for s in setups] == [False, True, False, True]
    assert [s.follows_plan for s in setups] == [False, True, False, True]
    assert {s.intention for s in setups if s.events} == {"scripted"}
    assert {s.seed for s in setups} == {PILOT_SEED}


def test_no_pilot_run_is_ever_judged_inconsistent() -> None:
    columns = simulate_trial(agreeing_setups(1)[1]).columns
    assert columns["consistent"].all()
    assert columns["haptic_gain"].min() > 0.99


@pytest.mark.slow
def test_the_threshold_is_twice_the_percentile_of_all_gaps() -> None:
    result = pilot_threshold(1)
    every = np.concatenate(gaps_of_first())
    assert result.num_samples == every.size > 10_000
    assert result.percentile == np.percentile(every, PERCENTILE)
    assert result.threshold == FACTOR * result.percentile


def test_gaps_are_counted_only_where_the_torques_oppose() -> None:
    columns = simulate_trial(agreeing_setups(1)[0]).columns
    opposed = columns["torque_agreement"] < 0.0
    judged = opposed & np.isfinite(columns["guidance_pseudo_work"])
    assert gaps_of_first()[0].size == np.count_nonzero(judged) < opposed.size


def test_a_pilot_run_that_fails_is_told_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def failing(setup: TrialSetup) -> None:
        raise ValueError("the road is closed")

    monkeypatch.setattr(pilot, "opposed_gaps", failing)
    with pytest.raises(ValueError, match="the road is closed"):
        pilot_threshold(1)


@pytest.mark.slow
def test_the_threshold_in_use_is_that_of_30_pilot_drivers() -> None:
    # The frozen value is rounded to two digits.
    used = ConsistencyParameters().inconsistency_threshold
    assert pilot_threshold(30).threshold == pytest.approx(used, abs=0.0005)
