"""Pseudo-work and the verdict of Table III."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller.consistency import (
    WINDOW_LENGTH,
    ConsistencyParameters,
    ConsistencyState,
    initial_state,
    is_consistent,
    step,
)
from costeer.controller.signals import Consistency
from tests.controller.samples import DT

PARAMETERS = ConsistencyParameters(inconsistency_threshold=0.1)
HELD = ConsistencyParameters(inconsistency_threshold=0.1, hold_time=0.2)


def judged(
    products: Iterable[tuple[float, float, float]],
    parameters: ConsistencyParameters = PARAMETERS,
    state: ConsistencyState | None = None,
) -> list[Consistency]:
    """Verdicts over samples of guidance torque, driver torque, heading-error rate."""
    state = state or initial_state()
    every = []
    for guidance, driver, rate in products:
        state, verdict = step(parameters, state, guidance, driver, rate, DT)
        every.append(verdict)
    return every


@pytest.mark.parametrize(
    ("gap", "agreement", "verdict"),
    [
        (0.2, -1.0, False),
        (-0.2, -1.0, False),
        (0.2, 1.0, True),
        (-0.2, 1.0, True),
        (0.05, -1.0, True),
        (-0.05, -1.0, True),
        (0.05, 1.0, True),
        (0.1, -1.0, True),
        (0.2, 0.0, True),
        (math.nan, -1.0, True),
    ],
)
def test_only_opposed_torques_with_works_apart_are_inconsistent(
    gap: float, agreement: float, verdict: bool
) -> None:
    assert is_consistent(PARAMETERS, gap, 0.0, agreement) is verdict
    assert is_consistent(PARAMETERS, 0.0, gap, agreement) is verdict


def test_until_the_window_is_full_driver_and_system_agree() -> None:
    verdicts = judged([(-1.0, 1.0, 5.0)] * WINDOW_LENGTH)
    assert [v.consistent for v in verdicts] == [True] * 59 + [False]
    assert all(math.isnan(v.guidance_pseudo_work) for v in verdicts[:-1])
    assert verdicts[-1].guidance_pseudo_work == -5.0
    assert verdicts[-1].driver_pseudo_work == 5.0


@given(st.integers(0, 1000))
def test_pseudo_work_is_the_mean_of_the_last_sixty_products(seed: int) -> None:
    signals = np.random.default_rng(seed).normal(size=(75, 3))
    last = judged(map(tuple, signals.tolist()))[-1]
    guidance, driver, rate = signals[-60:].T
    # Rounding of a sum of sixty numbers.
    assert last.guidance_pseudo_work == pytest.approx(
        np.mean(guidance * rate), abs=1e-14
    )
    assert last.driver_pseudo_work == pytest.approx(np.mean(driver * rate), abs=1e-14)
    assert last.torque_agreement == guidance[-1] * driver[-1]


def test_turning_the_other_way_changes_no_verdict() -> None:
    signals = np.random.default_rng(0).normal(size=(200, 3)).tolist()
    one = judged((g, d, r) for g, d, r in signals)
    other = judged((-g, -d, -r) for g, d, r in signals)
    assert [v.consistent for v in one] == [v.consistent for v in other]
    assert not all(v.consistent for v in one)


def test_with_a_hold_time_a_verdict_stays_at_least_as_long() -> None:
    chatter = [(-1.0, 1.0, 5.0), (1.0, 1.0, 5.0)] * 120
    literal = [v.consistent for v in judged(chatter)][60:]
    held = [v.consistent for v in judged(chatter, HELD)][60:]
    assert literal == [False, True] * 90
    changes = np.flatnonzero(np.diff(held))
    assert len(changes) > 10
    assert np.diff(changes).min() >= 12  # 0.2 s are 12 control steps


def test_a_hold_time_lasts_as_many_steps_as_it_says() -> None:
    # The verdict turned one step ago; 0.2 s are twelve steps, that one included.
    turned = initial_state()._replace(consistent=False, time_in_verdict=DT)
    verdicts = judged([(1.0, 1.0, 5.0)] * 20, HELD, turned)
    assert [v.consistent for v in verdicts] == [False] * 11 + [True] * 9


@pytest.mark.parametrize("lost", range(3))
def test_a_lost_sample_does_not_blind_the_verdict(lost: int) -> None:
    conflict = (-1.0, 1.0, 5.0)
    gap = [math.nan if k == lost else conflict[k] for k in range(3)]
    verdicts = judged([*[conflict] * 70, tuple(gap), conflict])
    assert not verdicts[-1].consistent
    assert math.isfinite(verdicts[-1].guidance_pseudo_work)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_lost_sample_counts_as_no_power(value: float) -> None:
    conflict = (-1.0, 1.0, 5.0)
    last = judged([*[conflict] * 70, (value, value, 5.0), conflict])[-1]
    assert last.guidance_pseudo_work == pytest.approx(-5.0 * 59 / 60)
    assert last.driver_pseudo_work == pytest.approx(5.0 * 59 / 60)


@pytest.mark.parametrize("lost", [0, 1])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_without_a_torque_the_last_verdict_stays(lost: int, value: float) -> None:
    conflict, agreement = (-1.0, 1.0, 5.0), (1.0, 1.0, 5.0)
    for last, consistent in ((conflict, False), (agreement, True)):
        gap = [value if k == lost else last[k] for k in range(3)]
        verdicts = judged([*[conflict] * 70, last, tuple(gap), last])
        assert [v.consistent for v in verdicts[-3:]] == [consistent] * 3


def test_the_numbers_are_those_of_the_decisions() -> None:
    usual = ConsistencyParameters()
    assert usual.inconsistency_threshold == 0.023  # docs/decisions/0006-threshold.md
    assert usual.hands_on_threshold == 0.1
    assert initial_state().consistent


def test_a_hold_time_of_whole_steps_holds_no_step_more() -> None:
    # Three steps: the verdict may turn again at the third.
    held = PARAMETERS._replace(hold_time=3.0 * DT)
    turned = initial_state()._replace(consistent=False, time_in_verdict=DT)
    verdicts = judged([(1.0, 1.0, 5.0)] * 5, held, turned)
    assert [v.consistent for v in verdicts] == [False] * 2 + [True] * 3


def test_a_hold_time_counts_from_the_start_of_the_trial_too() -> None:
    # Conflict from the first step on; the window is full after one second.
    held = PARAMETERS._replace(hold_time=2.0)
    verdicts = judged([(-1.0, 1.0, 5.0)] * 130, held)
    assert [v.consistent for v in verdicts] == [True] * 120 + [False] * 10


@pytest.mark.parametrize(("asked", "whole"), [(3.4, 3), (3.6, 4), (2.6, 3)])
def test_a_hold_time_is_rounded_to_the_nearest_step(asked: float, whole: int) -> None:
    held = PARAMETERS._replace(hold_time=asked * DT)
    turned = initial_state()._replace(consistent=False, time_in_verdict=DT)
    verdicts = judged([(1.0, 1.0, 5.0)] * 6, held, turned)
    wanted = [False] * (whole - 1) + [True] * (7 - whole)
    assert [v.consistent for v in verdicts] == wanted
