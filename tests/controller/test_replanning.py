"""A new plan is made when the guidance has faded, and only then."""

from __future__ import annotations

import pytest

from costeer.controller.replanning import ReplanningParameters, replan
from costeer.controller.strength import StrengthParameters, haptic_gain


@pytest.mark.parametrize(
    ("gain", "consistent", "verdict"),
    [
        (0.049, False, True),
        (0.05, False, False),
        (0.049, True, False),
        (1.0, False, False),
    ],
)
def test_a_faded_gain_in_conflict_calls_for_a_new_plan(
    gain: float, consistent: bool, verdict: bool
) -> None:
    assert replan(ReplanningParameters(), gain, consistent) is verdict


def test_from_full_gain_the_new_plan_comes_after_1_37_seconds() -> None:
    # (1 - tanh(4 (t - 1))) / 2 = 0.05 at t = 1 + artanh(0.9) / 4 = 1.368 s.
    faded = [
        replan(
            ReplanningParameters(),
            haptic_gain(StrengthParameters(), False, time, 1.0),
            False,
        )
        for time in (1.36, 1.37)
    ]
    assert faded == [False, True]
