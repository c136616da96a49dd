"""The figure of a population: its parameters and what goes together."""

from __future__ import annotations

import math
import re
from functools import cache

import pytest

from costeer.drivers.population import SECOND
from costeer.drivers.traits import FACTORS
from costeer.validation.drawn import drawn_drivers
from costeer.validation.drawn_figure import (
    Drawn,
    parameters_description,
    population_parameters_svg,
)

pytestmark = pytest.mark.slow


def population(num_drivers: int) -> Drawn:
    return Drawn(5, drawn_drivers(5, num_drivers, 20.0))


@cache
def svg(num_drivers: int) -> str:
    return population_parameters_svg(population(num_drivers))


@pytest.mark.slow
def test_the_same_population_gives_the_same_figure() -> None:
    assert population_parameters_svg(population(6)) == svg(6)


def test_the_figure_is_as_wide_as_two_columns_of_a_page() -> None:
    width = re.search(r'width="([\d.]+)pt"', svg(6))
    assert width is not None
    assert math.isclose(float(width[1]) / 72.0 * 25.4, 180.0, abs_tol=0.1)


def test_a_single_driver_can_be_drawn() -> None:
    assert svg(1).startswith("<?xml")


def test_a_population_without_a_band_is_drawn_without_it() -> None:
    before = Drawn(5, drawn_drivers(5, 2, 20.0, SECOND), SECOND)
    shown = population_parameters_svg(before)
    assert "Population 2 (virtual-2), seed 5" in shown
    assert ">tolerance: band<" not in shown
    assert ">tolerance: band<" in svg(6)
    assert "Population 3 (virtual), seed 5" in svg(6)


@pytest.mark.parametrize("factor", FACTORS, ids=lambda factor: factor.name)
def test_the_words_tell_what_goes_together(factor: object) -> None:
    told = parameters_description(population(2))
    assert f"{factor.name}: " in told  # type: ignore[attr-defined]  # a Factor
    assert "2 virtual drivers" in told
