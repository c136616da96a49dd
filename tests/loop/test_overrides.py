"""Parameters by name: each reaches the loop, and the stage that it is of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from costeer.base.array import Real
from costeer.base.described import described
from costeer.base.packing import leaf_names, packed
from costeer.controller import (
    actuation,
    consistency,
    guidance,
    hands,
    inference,
    preview,
    replanning,
    strength,
    trajectory,
)
from costeer.controller import step as controller
from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters
from costeer.loop.overrides import OPTIONS, is_option, parameter_list
from costeer.loop.parameters import LoopParameters
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.trial import simulate_trial
from tests.controller.samples import DT, LEFT_LANE, sample

SETUP = TrialSetup(condition="strong-normal", intention="off", length=100.0)
USUAL = loop_parameters(SETUP)
COPIED = ("car.", "column.", "road.")
"""What the controller knows of the world."""


def leaves(parameters: LoopParameters[Any]) -> dict[str, float]:
    """Every single number by name; the tables of a scenario are left out."""
    names = leaf_names(parameters)
    found = dict(zip(names, packed(parameters).tolist(), strict=True))
    times = Counter(names)
    return {name: value for name, value in found.items() if times[name] == 1}


def same(one: LoopParameters[Any], other: LoopParameters[Any]) -> None:
    """Assert that two trials have the same parameters, tables too."""
    np.testing.assert_array_equal(packed(one), packed(other))


def others() -> dict[str, float]:
    """For each name another value that it may have."""
    found = {"road.num_lanes": 3.0, "road.overtaking_side": 1.0}
    for each in described(USUAL):
        if each.name in found or is_option(each.name):
            continue
        low, high = each.allowed
        shares = (1.0, 0.0) if isinstance(each.value, bool) else (0.25, 0.5)
        values = [low + share * (high - low) for share in shares]
        found[each.name] = next(v for v in values if v != each.value)
    return found


OTHERS = others()


def test_every_number_of_a_trial_can_be_set_or_is_an_option() -> None:
    assert set(leaves(USUAL)) == OTHERS.keys() | set(filter(is_option, leaves(USUAL)))
    decided = {name.removeprefix("controller.") for name in leaves(USUAL)}
    assert OPTIONS.keys() <= decided


WRONG = {
    "mistakes.mass_ratio": ("controller.car.mass",),
    "mistakes.tyre_ratio": (
        "controller.car.front_cornering_stiffness",
        "controller.car.rear_cornering_stiffness",
    ),
    "mistakes.friction_ratio": ("column.friction",),
}
"""What a mistake changes besides: what is believed of the car, and the true column."""


def test_a_parameter_changes_in_the_loop_and_nothing_else_does() -> None:
    usual = leaves(USUAL)
    for name, value in OTHERS.items():
        found = leaves(loop_parameters(SETUP._replace(parameters=((name, value),))))
        changed = {leaf for leaf, was in usual.items() if found[leaf] != was}
        expected = {name}
        if name.startswith(COPIED):
            expected |= {f"controller.{name}"}
        given = {found[leaf] for leaf in expected}
        if name.startswith("mistakes."):
            expected |= {"mistakes.any", *WRONG.get(name, ())}
        if name == "car.aligning_stiffness":
            expected |= {"controller.guidance.slip_angle_gain"}  # a share of it
        assert (changed, given) == (expected, {value}), name


def test_a_method_may_be_wrong_about_its_car() -> None:
    ones = (("car.mass", 2000.0), ("controller.car.mass", 1000.0))
    parameters = loop_parameters(SETUP._replace(parameters=ones))
    assert parameters.car.mass == 2000.0
    assert parameters.controller.car.mass == 1000.0


def test_a_parameter_of_the_method_needs_no_prefix() -> None:
    short, full = (
        loop_parameters(SETUP._replace(parameters=((name, 3.0),)))
        for name in (
            "guidance.lateral_error_gain",
            "controller.guidance.lateral_error_gain",
        )
    )
    same(short, full)
    assert short.controller.guidance.lateral_error_gain == 3.0


def test_one_parameter_is_not_set_by_two_names() -> None:
    gain = "guidance.lateral_error_gain"
    twice = ((gain, 1.0), (f"controller.{gain}", 2.0))
    with pytest.raises(ValueError, match="lateral_error_gain is set twice"):
        loop_parameters(SETUP._replace(parameters=twice))


def test_each_parameter_is_listed_under_a_name_of_its_own_that_sets_it() -> None:
    heavy = loop_parameters(SETUP._replace(parameters=(("car.mass", 2000.0),)))
    listed = {each.name: each for each in parameter_list(heavy, USUAL)}
    assert len(listed) == len(parameter_list(heavy))
    assert {"car.mass", "controller.car.mass", "guidance.lateral_error_gain"} <= {
        *listed
    }
    assert "controller.road.length" not in listed
    assert listed["car.mass"].value == 2000.0
    assert listed["car.mass"].allowed.high == 150_000.0  # of the usual 1500 kg
    every = tuple((each.name, each.value) for each in listed.values())
    same(loop_parameters(SETUP._replace(parameters=every)), heavy)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("guidance.lateral_error_gian", 3.0, "mean guidance.lateral_error_gain"),
        ("lateral_error_gain", 3.0, r"mean guidance.lateral_error_gain\?"),
        ("hold_time", 0.2, r"mean consistency.hold_time\?"),
        ("tyres", 1.0, "there is no parameter 'tyres'"),
        ("consistency.hold_time", -1.0, "is -1; give a number from 0 to 100 s"),
        ("consistency.inconsistency_threshold", float("inf"), "is inf; .* to 100 W"),
        ("car.mass", 0.0, r"car\.mass is 0; give a number from 15 to 150000 kg"),
        ("car.mass", float("nan"), "car.mass is nan; give a number"),
        ("preview.look_ahead", 0.5, "is 0.5; give a number from 0 or 1"),
        ("actuation.strength_factor", 0.5, "is set by --condition .in Python cond"),
        ("road.length", 500.0, r"is set by --length \(in Python length\); give that"),
        ("assists", 0.0, "is set by --method"),
        ("road.overtaking_side", 0.5, "is 0.5; give 1 for left or -1 for right"),
        ("road.num_lanes", 1.0, "num_lanes is 1; give 2"),
        ("car.friction", 0.0, "car.friction is 0; give a number from"),
        ("car.mass", True, "car.mass is True; give a number"),
        ("car.mass", "x", "car.mass is 'x'; give a number"),
    ],
)
def test_a_wrong_name_or_value_is_refused_with_the_way_out(
    name: str, value: float, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        loop_parameters(SETUP._replace(parameters=((name, value),)))


Given = dict[str, tuple[Any, ...]]


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Given:
    """What each stage of the controller was called with last."""
    heard: Given = {}
    stages: dict[Any, str] = {
        inference: "step",
        trajectory: "step",
        preview: "preview",
        guidance: "guide",
        consistency: "step",
        hands: "step",
        strength: "step",
        replanning: "replan",
        actuation: "step",
    }

    def listening(name: str, stage: Callable[..., Any]) -> Callable[..., Any]:
        def listen(*arguments: Any) -> Any:
            heard[name] = arguments
            return stage(*arguments)

        return listen

    for module, name in stages.items():
        short = module.__name__.rpartition(".")[2]
        wrapped = listening(short, getattr(module, name))
        monkeypatch.setattr(module, name, wrapped)
    return heard


def test_every_parameter_of_the_method_reaches_its_stage(given: Given) -> None:
    own = {n: v for n, v in OTHERS.items() if n.startswith("controller.")}
    setup = SETUP._replace(parameters=tuple(own.items()), length=100.0)
    simulate_trial(setup, engine="python")
    arrived = dict(
        zip(
            ControllerParameters._fields,
            (
                given["preview"][1],
                given["guidance"][2],
                given["inference"][2],
                given["inference"][0],
                given["trajectory"][0],
                given["preview"][0],
                given["guidance"][0],
                given["consistency"][0],
                given["hands"][0],
                given["strength"][0],
                given["replanning"][0],
                given["actuation"][0],
            ),
            strict=True,
        )
    )
    assert given["trajectory"][2] == arrived["road"]
    assert given["guidance"][1] == arrived["car"]
    made = leaves(LoopParameters(ControllerParameters(**arrived)))
    assert {name: made[name] for name in own} == own


class LongerTrajectory(NamedTuple):
    """`TrajectoryParameters` of a later version, with one more."""

    change_duration: Real = 6.0
    smoothness: Real = 0.3


@pytest.mark.parametrize("asked", [float("nan"), 3.0])
def test_a_duration_that_is_asked_for_replaces_nothing_else(
    asked: float, given: Given
) -> None:
    later: Any = LongerTrajectory()
    parameters = ControllerParameters(trajectory=later)
    state = controller.initial_state(parameters, LEFT_LANE)
    request = Request(requested=True, change_duration=asked)
    controller.step(parameters, state, sample(), request, DT)
    expected = 3.0 if asked == 3.0 else 6.0
    assert given["trajectory"][0] == LongerTrajectory(change_duration=expected)
    assert isinstance(given["trajectory"][0], LongerTrajectory)
