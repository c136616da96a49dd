"""What may be tuned exists, holds its default, and stays in its range."""

from __future__ import annotations

import math

import pytest

from costeer.base.packing import leaf_names, packed
from costeer.loop.parameters import LoopParameters
from costeer.methods.ibhs import IBHS, TUNABLES
from costeer.methods.interface import Tunable, usual_parameters
from costeer.runtime.tunables import (
    checked_value,
    place_of,
    tunable_named,
)


@pytest.mark.parametrize("tunable", TUNABLES, ids=lambda tunable: tunable.name)
def test_default_lies_in_the_range(tunable: Tunable) -> None:
    usual = LoopParameters(controller=usual_parameters(IBHS))
    default = packed(usual)[leaf_names(usual).index(place_of(tunable))]
    assert checked_value(tunable, default) == default
    assert tunable_named(IBHS, tunable.name) is tunable


@pytest.mark.parametrize("value", [math.nan, math.inf, -0.1, 1.1])
def test_value_out_of_range_is_refused_with_the_range(value: float) -> None:
    with pytest.raises(ValueError, match=r"strength_factor is .*from 0 to 1"):
        checked_value(tunable_named(IBHS, "strength_factor"), value)


def test_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"'mass' cannot be tuned.*strength_factor"):
        tunable_named(IBHS, "mass")
