"""Methods behind one interface, by name."""

from __future__ import annotations

import math

import pytest

from costeer.controller.step import ControllerParameters
from costeer.methods.registry import METHODS, method_named
from costeer.plant.parameters import RoadParameters
from tests.controller.samples import DT, LEFT_LANE, sample


@pytest.mark.parametrize("name", sorted(METHODS))
def test_a_method_is_found_by_its_own_name(name: str) -> None:
    method = method_named(name)
    assert method.name == name
    assert method.source


def test_an_unknown_method_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"'stalk' is not known; .* ibhs, manual"):
        method_named("stalk")


def test_only_manual_driving_goes_without_assistance() -> None:
    assert [m.name for m in METHODS.values() if not m.assists] == ["manual"]


@pytest.mark.parametrize("name", sorted(METHODS))
def test_every_method_steps_from_its_own_initial_state(name: str) -> None:
    method = METHODS[name]
    state = method.initial_state(RoadParameters(), LEFT_LANE)
    shifted = sample(lateral_position=0.5)
    _, signals = method.step(
        ControllerParameters(), state, shifted, math.nan, False, DT
    )
    assert signals.applied_torque < 0.0  # back to the centre, to the right
