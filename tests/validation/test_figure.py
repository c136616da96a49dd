"""The figure of a population in manual driving."""

from __future__ import annotations

import math
import re
from functools import cache

import pytest

from costeer.validation.figure import population_svg
from costeer.validation.manual import ManualDriving, Row

TRIAL = {
    "sdlp": 0.2,
    "swrr": 6.0,
    "driver_torque_rms": 0.3,
    "false_glance_share": 0.15,
    "distance": 8000.0,
}
CHANGE = {
    "duration_by_speed": 5.5,
    "onset_to_crossing": 2.5,
    "peak_lateral_speed": 0.9,
    "peak_steering_angle": 0.1,
    "overshoot": 0.2,
    "glance": 1.0,
    "direction": -1,
}


def made_up(num_drivers: int) -> ManualDriving:
    """Drivers who differ a little; no simulation."""

    def varied(row: dict[str, float], k: int) -> Row:
        return {name: value * (1.0 + 0.01 * k) for name, value in row.items()}

    trials = [varied(TRIAL, k) for k in range(num_drivers)]
    return ManualDriving(trials, [varied(CHANGE, k) for k in range(num_drivers)], 0)


@cache
def svg() -> str:
    return population_svg(made_up(20))


@pytest.mark.slow
def test_the_same_driving_gives_the_same_figure() -> None:
    assert population_svg(made_up(20)) == svg()


def test_the_figure_is_as_wide_as_two_columns_of_a_page() -> None:
    width = re.search(r'width="([\d.]+)pt"', svg())
    assert width is not None
    assert math.isclose(float(width[1]) / 72.0 * 25.4, 180.0, abs_tol=0.1)


def test_the_figure_tells_in_words_what_it_shows() -> None:
    title = re.search(r"<dc:title>(.*?)</dc:title>", svg())
    assert title is not None
    assert title[1].startswith("Manual driving of 20 virtual drivers: distributions")
    assert "of twelve ranges are met" in title[1]


def test_a_population_without_values_is_drawn_as_empty_panels() -> None:
    assert population_svg(ManualDriving([], [], 0)).startswith("<?xml")
