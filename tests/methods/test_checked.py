"""A method that the loop cannot run is refused in its own words."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from costeer.controller.signals import Assistance
from costeer.methods.checked import checked_method, hears_triggers
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method, Tunable
from costeer.methods.registry import AnyMethod
from costeer.records.columns import Column
from tests.methods.rivals import Gain, Memory, damping, rival, torque

COLUMN = Column("integral", "-", "float64", "", "method.last")
TUNABLE = Tunable("k", "gian", "-", 0.0, 1.0, "")


def answering(answer: Any) -> AnyMethod:
    return rival(lambda *_: answer)


@pytest.mark.parametrize(
    ("method", "message"),
    [
        (rival(damping)._replace(step=None), "has no step function; it is None"),
        (rival(damping)._replace(name="My method"), "small letters"),
        (rival(damping, gain=3), "parameter gain .* whole number.*3.0 instead of 3"),
        (rival(damping, gain="x"), "parameters .* gain is 'x'"),
        (rival(damping, last=0), "last of the state a number, it was a whole number"),
        (rival(damping, last=[0.0]), r"states .* last is \[0.0\]"),
        (rival(lambda: None), "step of .* broke: TypeError.*measurement, request, dt"),
        (answering(torque(1.0)), "give the new state and assistance"),
        (answering((Memory(0.0), 2.0)), "gives 2.0 as its assistance"),
        (answering((0.0, torque(0.0))), "states of method 'rival' are 0.0"),
        (answering((Memory(0.0), torque("5"))), "applied_torque is '5'"),
        (
            answering((Memory(0.0), torque(np.zeros(2)))),
            r"gives applied_torque as an array of shape \(2,\); give a number",
        ),
        (
            rival(lambda *_: (Memory(np.zeros(3)), Assistance()), last=np.zeros(2)),
            r"an array of shape \(3,\), it was an array of shape \(2,\)",
        ),
        (rival(damping)._replace(parameters=lambda: Gain(1.0)), "parameters .* broke"),
        (rival(damping)._replace(columns=(COLUMN,)), "must begin with method_"),
        (rival(damping)._replace(columns=[COLUMN]), r"columns .* \[.*; give a tuple"),
        (rival(damping)._replace(tunables=None), "tunables .* are None; give a tuple"),
        (
            rival(damping)._replace(columns=("method_x",)),
            "hold 'method_x'; give ",
        ),
        (rival(damping)._replace(tunables=("gain",)), "hold 'gain'; give costeer"),
        (
            rival(damping)._replace(tunables=(TUNABLE._replace(leaf="gain", low=2.0),)),
            "'k' .* goes from 2.0 to 1.0; give the smaller",
        ),
        (
            rival(damping)._replace(tunables=(TUNABLE._replace(leaf="gain"),) * 2),
            "two tunables of one name",
        ),
        (rival(damping)._replace(version=3), "version .* is 3; give text"),
        (rival(damping)._replace(assists="no"), "assists .* 'no'; give True or False"),
        (rival(damping, gain=math.nan), "parameter gain .* is nan; give a number that"),
        (
            rival(lambda *_: (Memory(0.0), torque(2.0)))._replace(assists=False),
            "asks for 2 N·m although assists is False",
        ),
        (rival(damping)._replace(tunables=(TUNABLE,)), "'gian', which is none of gain"),
    ],
)
def test_what_is_wrong_is_named(method: Method[Any, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        checked_method(method)


def test_what_is_no_method_is_refused() -> None:
    with pytest.raises(ValueError, match="5 is no method"):
        checked_method(5)


def test_a_torque_of_nan_or_over_the_limit_is_for_the_loop_to_contain() -> None:
    for value in (math.nan, 900.0):
        assert checked_method(answering((Memory(0.0), torque(value)))).name == "rival"


def test_whether_a_method_hears_triggers_is_found_by_asking_it() -> None:
    assert hears_triggers(IBHS)
    assert not hears_triggers(rival(damping))
