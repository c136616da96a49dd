"""What is compared, what is left out, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

from costeer.comparison.design import (
    SCENARIOS,
    ComparisonSettings,
    checked,
    num_trials,
    planned,
)
from costeer.methods.registry import METHODS
from tests.comparison.fakes import NUM_TRIALS, SMALL


def test_usual_settings_are_all_methods_on_six_roads() -> None:
    settings = checked(ComparisonSettings())
    assert settings.methods == tuple(METHODS)
    assert len(set(SCENARIOS)) == 6
    plan = planned(settings)
    assert num_trials(plan.blocks) == len(METHODS) * 6 * 50
    assert [each.length for each in plan.courses] == [
        8000,
        8000,
        8000,
        8000,
        3000,
        4000,
    ]


def test_every_trial_stands_in_one_block() -> None:
    plan = planned(checked(SMALL))
    found = [(b.cell.number, who) for b in plan.blocks for who in b.participants]
    assert len(set(found)) == len(found) == num_trials(plan.blocks) == NUM_TRIALS
    # First drivers first: a comparison that is stopped can be compared.
    assert {b.participants[0] for b in plan.blocks[: len(plan.cells)]} == {1}


def left_out(**changed: Any) -> dict[tuple[str, str], str]:
    """Method and mistake of what is not driven, with the reason."""
    plan = planned(checked(SMALL._replace(**changed)))
    driven = {(c.entrant.name, c.mistake) for c in plan.cells}
    told = {(each.method, each.mistake): each.reason for each in plan.left_out}
    assert not driven & told.keys()
    return told


def test_manual_driving_makes_no_mistake_of_an_assistance() -> None:
    told = left_out(
        methods=("manual", "ibhs"),
        mistakes=("weak-motor", "late-trigger", "torque-bias", "friction=3"),
    )
    assert set(told) == {
        ("manual", "weak-motor"),
        ("manual", "late-trigger"),
        ("manual", "torque-bias"),
    }
    assert "gives no torque" in told["manual", "weak-motor"]


def test_who_hears_no_trigger_cannot_hear_a_false_one() -> None:
    told = left_out(
        methods=("ibhs", "lane-keeping", "indicator"),
        mistakes=("false-trigger", "latency"),
    )
    assert set(told) == {("lane-keeping", "false-trigger")}
    assert "hears no trigger" in told["lane-keeping", "false-trigger"]


def test_the_wrong_side_needs_a_lane_there_and_a_lost_head_a_network() -> None:
    wrong = {"methods": ("ibhs",), "mistakes": ("wrong-side", "head-lost")}
    assert len(left_out(scenarios=("expressway",), **wrong)) == 2
    assert left_out(scenarios=("three-lanes",), intention="network", **wrong) == {}


def test_without_mistakes_come_first() -> None:
    mistakes = ("late-trigger=0.5", "none", "latency")
    wanted = ("none", "late-trigger=0.5", "latency")
    assert checked(SMALL._replace(mistakes=mistakes)).mistakes == wanted


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"methods": ("ibsh",)}, "method 'ibsh' is not known .*did you mean ibhs"),
        ({"methods": ("ibhs", "ibhs")}, "method ibhs is given twice"),
        (
            {"scenarios": ("cutin",)},
            "scenario 'cutin' is not known .did you mean cut-in",
        ),
        ({"scenarios": ("cut-in", "cut-in")}, "scenario cut-in is given twice"),
        ({"scenarios": ()}, "scenarios is empty"),
        (
            {"mistakes": ("false-triger",)},
            "there is no mistake 'false-triger' .did you mean false-",
        ),
        ({"mistakes": ("latency", "latency")}, "mistake latency is given twice"),
        ({"mistakes": ("latency=9",)}, "latency has size 9; give a number from"),
        ({"participants": 0}, "participants is 0; give a whole number 1 to 100000"),
        ({"condition": "manual"}, "condition manual has no guidance"),
        ({"condition": "strong"}, "unknown condition 'strong'"),
        ({"intention": "mind"}, "intention 'mind' is not known; choose one of"),
        ({"length": 10.0}, "length is 10.0; give a number from 100"),
        ({"seed": 900_001}, "seed 900001 is that of the pilot drivers"),
    ],
)
def test_bad_input_is_named(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        planned(checked(SMALL._replace(**changed)))
