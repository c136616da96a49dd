"""What files hold in SI is shown as people read it."""

from __future__ import annotations

import math

import pytest

from costeer.pages.units import shown


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (math.pi, "rad", "180 deg"),
        (math.pi / 2.0, "rad/s", "90 deg/s"),
        (math.pi, "rad/s²", "180 deg/s²"),
        (10.0, "m/s", "36 km/h"),
        (2.0, "N·m/rad", "2 N·m/rad"),
        (0.5, "m", "0.5 m"),
    ],
)
def test_a_quantity_is_shown_in_the_unit_of_people(
    value: float, unit: str, words: str
) -> None:
    other, factor = shown(unit)
    assert f"{value * factor:g} {other}" == words
