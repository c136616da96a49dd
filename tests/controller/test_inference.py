"""From probability to trigger: debounce, lock, release."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller.inference import (
    InferenceParameters,
    InferenceState,
    initial_state,
    settled,
    step,
)
from tests.controller.samples import DT, ROAD, sample

PARAMETERS = InferenceParameters()
UNSETTLED = sample(lateral_position=0.8)


def detections(
    probabilities: Iterable[float], state: InferenceState, **changes: float
) -> list[bool]:
    """The trigger at each step."""
    found = []
    for probability in probabilities:
        state, intention = step(
            PARAMETERS, state, ROAD, sample(**changes), probability, False, DT
        )
        found.append(intention.detected)
    return found


def locked_for(**changes: float) -> int:
    """Steps without a trigger after the end of a path, all verdicts positive."""
    state, intention = step(
        PARAMETERS, initial_state(), ROAD, sample(**changes), 1.0, True, DT
    )
    assert not intention.detected
    return detections([1.0] * 300, state, **changes).index(True) + 1


@given(st.lists(st.sampled_from([0.0, 0.49, 0.5, 1.0, math.nan]), max_size=40))
def test_three_positives_in_a_row_make_a_trigger(probabilities: list[float]) -> None:
    positive = [p >= 0.5 for p in probabilities]
    wanted = [k >= 2 and all(positive[k - 2 : k + 1]) for k in range(len(positive))]
    assert detections(probabilities, initial_state()) == wanted


def test_the_side_is_that_of_the_adjacent_lane() -> None:
    for side in (-1.0, 1.0):
        _, intention = step(
            PARAMETERS, initial_state(), ROAD, sample(side=side), 1.0, False, DT
        )
        assert intention.side == side


def test_no_lock_without_the_end_of_a_path() -> None:
    assert detections([1.0] * 3, initial_state()) == [False, False, True]


def test_a_settled_car_is_free_again_after_half_a_second() -> None:
    # 30 steps of rest, then three positives; the sum of 30 steps may round down.
    assert locked_for() in (32, 33)


def test_an_unsettled_car_is_free_again_after_three_seconds() -> None:
    # 180 steps, then three positives, the first of them at the step of release.
    assert locked_for(lateral_position=0.8) in (182, 183)


def test_settling_that_is_interrupted_starts_again() -> None:
    state, _ = step(PARAMETERS, initial_state(), ROAD, sample(), 1.0, True, DT)
    for measurement in [*[sample()] * 25, UNSETTLED, *[sample()] * 25]:
        state, _ = step(PARAMETERS, state, ROAD, measurement, 1.0, False, DT)
    assert state.locked


@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({}, True),
        ({"lateral_position": 0.29}, True),
        ({"lateral_position": 0.31}, False),
        ({"lateral_position": -0.31}, False),
        ({"yaw_angle": math.radians(0.49)}, True),
        ({"yaw_angle": math.radians(-0.51)}, False),
        ({"lateral_position": -3.4, "lane": 0.0}, True),
        ({"lateral_position": -3.4}, False),
        ({"lateral_position": math.nan}, False),
    ],
)
def test_a_settled_car_is_near_the_centre_and_straight(
    changes: dict[str, float], verdict: bool
) -> None:
    assert settled(PARAMETERS, ROAD, sample(**changes)) is verdict


def test_a_second_end_of_a_path_begins_a_new_lock() -> None:
    state, _ = step(PARAMETERS, initial_state(), ROAD, UNSETTLED, 1.0, True, DT)
    for _ in range(170):
        state, _ = step(PARAMETERS, state, ROAD, UNSETTLED, 1.0, False, DT)
    state, _ = step(PARAMETERS, state, ROAD, UNSETTLED, 1.0, True, DT)
    assert detections([1.0] * 179, state, lateral_position=0.8) == [False] * 179
