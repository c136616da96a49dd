"""What is good enough is let go; what is not is corrected when evidence suffices."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.drivers import tolerance
from costeer.drivers.tolerance import ToleranceParameters, ToleranceState
from tests.drivers.samples import DT

PARAMETERS = ToleranceParameters(
    band=0.02,
    evidence_rate=1.5,
    forgetting_time=0.8,
    movement_time=0.4,
    trim_time=1e9,
)
NOBODY = ToleranceParameters(band=0.0)


def states(
    asked: list[float],
    parameters: ToleranceParameters = PARAMETERS,
    watches: bool = False,
) -> list[ToleranceState]:
    """What the driver lets go, step by step."""
    state, found = tolerance.initial_state(), []
    for angle in asked:
        state = tolerance.step(parameters, state, angle, watches, DT)
        found.append(state)
    return found


@given(st.lists(st.floats(-0.5, 0.5), max_size=60))
def test_without_a_band_the_hands_follow_the_eyes(asked: list[float]) -> None:
    assert [s.intended for s in states(asked, NOBODY)] == asked


def test_what_lies_within_the_band_is_let_go() -> None:
    found = states([0.0199] * 600)
    assert max(abs(s.intended) for s in found) < 1e-6  # resting hands learn the trim
    assert not any(s.attends for s in found)


@pytest.mark.parametrize("asked", [0.05, 0.1, -0.3])
def test_a_correction_begins_when_the_evidence_is_complete(asked: float) -> None:
    # A' = c - A / τ with c = r (|offset| / b - 1) reaches 1 after -τ ln(1 - 1 / (c τ)).
    rate = PARAMETERS.evidence_rate * (abs(asked) / PARAMETERS.band - 1.0)
    wanted = -PARAMETERS.forgetting_time * math.log(
        1.0 - 1.0 / (rate * PARAMETERS.forgetting_time)
    )
    first = next(k for k, s in enumerate(states([asked] * 600)) if s.attends)
    assert (first + 1) * DT == pytest.approx(wanted, abs=1.5 * DT)


def test_too_little_evidence_is_forgotten_for_ever() -> None:
    # c τ < 1 never reaches 1.
    weak = PARAMETERS.band * (1.0 + 0.9 / (1.5 * 0.8))
    assert not any(s.attends for s in states([weak] * 6000))


def test_a_correction_is_one_steering_movement() -> None:
    asked = 0.2
    found = [s.intended for s in states([asked] * 120)]
    first = next(k for k, angle in enumerate(found) if angle > 1e-6) - 1
    movement = np.array(found[first : first + round(0.4 / DT) + 1])
    assert np.all(np.diff(movement) > 0.0)
    assert 0.94 * asked < movement[-1] < asked


def test_hands_come_to_rest_where_the_wheel_has_been() -> None:
    # A steady need of 0.2 for three time constants: 1 - exp(-3) of it are known.
    parameters = PARAMETERS._replace(trim_time=5.0)
    found = states([0.2] * 900, parameters)
    assert found[-1].trim == pytest.approx(0.2 * (1.0 - math.exp(-3.0)), rel=0.01)
    assert not found[-1].attends
    assert found[-1].intended == pytest.approx(found[-1].trim, abs=1e-3)


def test_after_a_correction_the_hands_let_go() -> None:
    found = states([0.2] * 60 + [0.0] * 120)
    assert found[59].intended > 0.19
    assert not found[-1].attends
    assert abs(found[-1].intended) < 1e-3


def test_in_a_lane_change_the_eyes_do_not_leave_the_path() -> None:
    asked = (0.3 * np.sin(np.arange(600) / 40.0)).tolist()
    found = states(asked, watches=True)
    # What was let go before is made up for; here nothing was.
    assert [s.intended for s in found] == pytest.approx(asked)


@given(st.lists(st.floats(-0.5, 0.5), max_size=60))
def test_left_and_right_are_alike(asked: list[float]) -> None:
    here = [s.intended for s in states(asked)]
    there = [s.intended for s in states([-angle for angle in asked])]
    assert here == [-angle for angle in there]


@given(st.lists(st.floats(-0.5, 0.5), min_size=1, max_size=200))
def test_nobody_intends_more_than_was_ever_seen_to_be_needed(
    asked: list[float],
) -> None:
    reach = max(map(abs, asked))
    # A movement that begins at one end may still go on when the other is asked for.
    assert all(abs(s.intended) <= 3.0 * reach for s in states(asked))
    assert all(0.0 <= s.evidence <= 1.0 for s in states(asked))
