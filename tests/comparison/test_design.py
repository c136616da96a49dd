"""What is compared, what is left out, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

from costeer.comparison import mistakes as room
from costeer.comparison.design import (
    SCENARIOS,
    ComparisonSettings,
    Entrant,
    checked,
    num_trials,
    planned,
)
from costeer.comparison.mistakes import (
    MOTOR,
    TRIGGER,
    WORLD,
    concern_of,
    contradiction,
)
from costeer.methods.registry import METHODS
from tests.comparison.fakes import NUM_TRIALS, SMALL

PRESETS = {
    "saturated-motor": 0,
    "false-trigger": 0,
    "short-sight": 0,
    "late-trigger": 0,
}


@pytest.fixture
def presets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "_presets", lambda: PRESETS)
    monkeypatch.setattr(
        "costeer.comparison.design.with_mistake", lambda setup, _: setup
    )


def never(_: Entrant) -> bool:
    return False


def always(_: Entrant) -> bool:
    return True


def test_usual_settings_are_all_methods_on_six_roads() -> None:
    settings = checked(ComparisonSettings())
    assert settings.methods == tuple(METHODS)
    assert len(set(SCENARIOS)) == 6
    plan = planned(settings, always)
    assert num_trials(plan) == len(METHODS) * 6 * 50
    assert [each.length for each in plan.courses] == [
        8000,
        8000,
        8000,
        8000,
        3000,
        4000,
    ]


def test_every_trial_stands_in_one_block() -> None:
    plan = planned(checked(SMALL), always)
    found = [(b.cell.number, who) for b in plan.blocks for who in b.participants]
    assert len(set(found)) == len(found) == num_trials(plan) == NUM_TRIALS
    # First drivers first: a comparison that is stopped can be compared.
    assert {b.participants[0] for b in plan.blocks[: len(plan.cells)]} == {1}


@pytest.mark.parametrize(
    ("name", "concern"),
    [
        ("saturated-motor", MOTOR),
        ("false-trigger", TRIGGER),
        ("missed", TRIGGER),
        ("short-sight", WORLD),
    ],
)
def test_a_mistake_concerns_what_its_name_says(name: str, concern: str) -> None:
    assert concern_of(name) == concern


def test_a_mistake_concerns_what_its_preset_says(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Preset:
        concerns = "world"

    monkeypatch.setattr(room, "_presets", lambda: {"saturated-motor": Preset()})
    assert concern_of("saturated-motor") == WORLD


@pytest.mark.parametrize(
    ("mistake", "assists", "starts", "left_out"),
    [
        ("none", False, False, False),
        ("saturated-motor", True, False, False),
        ("saturated-motor", False, False, True),
        ("false-trigger", True, True, False),
        ("false-trigger", True, False, True),
        ("false-trigger", False, False, True),
        ("short-sight", False, False, False),
    ],
)
def test_contradictions(
    mistake: str, assists: bool, starts: bool, left_out: bool
) -> None:
    assert bool(contradiction(mistake, assists, starts)) == left_out


@pytest.mark.usefixtures("presets")
def test_what_contradicts_itself_is_left_out_and_said() -> None:
    settings = checked(SMALL._replace(mistakes=("saturated-motor", "late-trigger")))
    assert settings.mistakes == ("none", "saturated-motor", "late-trigger")
    plan = planned(settings, never)
    driven = [
        (c.entrant.name, c.mistake) for c in plan.cells if c.course.name == "cut-in"
    ]
    assert driven == [("manual", "none"), ("ibhs", "none"), ("ibhs", "saturated-motor")]
    assert [(each.method, each.mistake) for each in plan.left_out] == [
        ("manual", "saturated-motor"),
        ("manual", "late-trigger"),
        ("ibhs", "late-trigger"),
    ]
    assert "starts no lane change" in plan.left_out[-1].reason


def test_nobody_is_asked_for_a_trigger_without_a_mistake_of_one() -> None:
    def asked(_: Entrant) -> bool:
        raise AssertionError

    planned(checked(SMALL), asked)


@pytest.mark.usefixtures("presets")
@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"methods": ("ibsh",)}, "method 'ibsh' is not known .*did you mean ibhs"),
        ({"methods": ("ibhs", "ibhs")}, "method ibhs is given twice"),
        (
            {"scenarios": ("cutin",)},
            "scenario 'cutin' is not known; did you mean cut-in",
        ),
        ({"scenarios": ("cut-in", "cut-in")}, "scenario cut-in is given twice"),
        ({"scenarios": ()}, "scenarios is empty"),
        (
            {"mistakes": ("false-triger",)},
            "'false-triger' is not known; did you mean fals",
        ),
        ({"mistakes": ("none", "none")}, "mistake none is given twice"),
        ({"participants": 0}, "participants is 0; give a whole number 1 to 9999"),
        ({"condition": "manual"}, "condition manual has no guidance"),
        ({"condition": "strong"}, "unknown condition 'strong'"),
        ({"intention": "mind"}, "intention 'mind' is not known; choose one of"),
        ({"length": 10.0}, "length is 10.0; give a number from 100"),
        ({"seed": 900_001}, "seed 900001 is that of the pilot drivers"),
    ],
)
def test_bad_input_is_named(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        planned(checked(SMALL._replace(**changed)), always)
