"""Experience grows within minutes, fades soon, and changes reliance and tension."""

from __future__ import annotations

import math

import pytest

from costeer.drivers import learning
from costeer.drivers.learning import LearningParameters, LearningState
from costeer.drivers.reliance import RelianceParameters

DT = 1.0 / 60.0
LEARNS = LearningParameters(share=1.0, before=0.0)
OWN = RelianceParameters(reliance=0.6, cocontraction=2.0)


def after(seconds: float, felt: float, start: LearningState) -> LearningState:
    state = start
    for _ in range(round(seconds / DT)):
        state = learning.step(LEARNS, state, felt, False, DT)
    return state


def test_experience_follows_two_time_constants() -> None:
    begun = learning.initial_state(LEARNS)
    assert begun.experience == 0.0
    known = after(180.0, 0.5, begun)
    assert known.experience == pytest.approx(1.0 - math.exp(-1.0), rel=1e-3)
    forgotten = after(30.0, 0.0, known)
    assert forgotten.experience == pytest.approx(
        known.experience * math.exp(-1.0), rel=1e-3
    )


def test_what_was_driven_before_counts_as_if_driven_now() -> None:
    before = learning.initial_state(LEARNS._replace(before=180.0))
    driven = after(180.0, 0.5, learning.initial_state(LEARNS))
    assert before.experience == pytest.approx(driven.experience, rel=1e-3)


def test_reliance_grows_and_tension_falls_with_experience() -> None:
    new, known = LearningState(0.0, 1.0, False), LearningState(1.0, 1.0, False)
    first = learning.experienced(LEARNS, new, OWN)
    last = learning.experienced(LEARNS, known, OWN)
    assert (first.reliance, last.reliance) == pytest.approx((0.3, 0.6))
    assert (first.cocontraction, last.cocontraction) == pytest.approx((2.0, 1.7))


def test_every_dispute_costs_trust_once_and_it_comes_back() -> None:
    state = LearningState(1.0, 1.0, False)
    for _ in range(60):
        state = learning.step(LEARNS, state, 0.5, True, DT)
    assert state.trust == pytest.approx(0.8, abs=0.01)
    state = after(180.0, 0.5, state)
    assert 1.0 - state.trust == pytest.approx(0.2 * math.exp(-1.0), abs=0.01)


def test_without_a_share_nothing_is_learnt() -> None:
    nobody = LEARNS._replace(share=0.0)
    for state in (LearningState(0.0, 0.5, False), LearningState(1.0, 1.0, True)):
        assert learning.experienced(nobody, state, OWN) == OWN
