"""Strong guidance alone keeps the bounds of the specification, and its reference."""

from __future__ import annotations

import csv
import math
from functools import cache

import numpy as np
import pytest

from benchmarks.hands_off import (
    SPEEDS,
    Bounds,
    HandsOffFigures,
    change_figures,
    hands_off_figures,
    hands_off_setup,
    missed_bounds,
)
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS
from tests.closed_loop.make_hands_off_reference import FILE, SIGNALS, reference_rows

CASES = [(car, speed) for car in sorted(CARS) for speed in SPEEDS]


@cache
def figures(car: str, speed: float) -> HandsOffFigures:
    return hands_off_figures(car, speed)


def reference() -> list[list[str | float]]:
    """The rows of the file."""
    with FILE.open(encoding="utf-8", newline="") as lines:
        header, *rows = csv.reader(lines)
    assert header == ["run", *SIGNALS]
    return [[name, *map(float, values)] for name, *values in rows]


def deviation(rows: list[list[str | float]]) -> float:
    """Largest difference from the reference in any signal."""
    expected = reference()
    assert [row[:2] for row in rows] == [
        [name, pytest.approx(time)] for name, time, *_ in expected
    ]
    given = np.array([row[1:] for row in rows], float)
    return float(np.abs(given - np.array([row[1:] for row in expected], float)).max())


@pytest.mark.parametrize(("car", "speed"), CASES)
def test_hands_off_figures_keep_the_bounds(car: str, speed: float) -> None:
    assert missed_bounds(figures(car, speed), Bounds()) == []


@pytest.mark.parametrize(("car", "speed"), CASES)
def test_the_rate_limit_holds_the_ends_of_a_path_and_nothing_between(
    car: str, speed: float
) -> None:
    # The quintic's steering rate jumps where the path begins and ends; at 30 N·m/s a
    # jump of 2 N·m takes four control steps.
    for change in figures(car, speed).changes:
        assert change.num_limited <= 8
        assert change.num_limited_inside == 0


def test_a_missed_bound_is_told_with_its_place_and_value() -> None:
    strict = Bounds(path_error=0.01)
    (text,) = missed_bounds(figures("default", SPEEDS[1]), strict)
    assert text.startswith("default at 70 km/h: path_error 0.1")
    lost = figures("default", SPEEDS[1])._replace(hunting=math.nan)
    assert len(missed_bounds(lost, Bounds())) == 1


def test_a_longer_change_needs_less_wheel_and_less_torque() -> None:
    rapid, normal, gentle = figures("default", SPEEDS[1]).changes
    for name in ("peak_steering_angle", "peak_torque"):
        values = [getattr(change, name) for change in (rapid, normal, gentle)]
        assert values == sorted(values, reverse=True)


def test_a_mirrored_offset_is_corrected_in_the_mirror() -> None:
    setup = hands_off_setup("default", SPEEDS[1], 15.0)
    left, right = (
        simulate_trial(setup._replace(initial_offset=offset)).columns
        for offset in (0.5, -0.5)
    )
    for name in ("lateral_position", "steering_wheel_angle", "applied_torque"):
        np.testing.assert_array_equal(left[name], -right[name])


def test_a_finer_plant_gives_the_same_lane_change() -> None:
    coarse = hands_off_setup("default", SPEEDS[1], 20.0)._replace(trigger_times=(5.0,))
    fine = coarse._replace(plant_steps=16)
    paths = [simulate_trial(s).columns["lateral_position"] for s in (coarse, fine)]
    # First order in the column: a centimetre in a change of 3.5 m.
    np.testing.assert_allclose(*paths, rtol=0.0, atol=0.01)


def test_the_closed_loop_answers_as_its_reference() -> None:
    # The file has twelve digits; another machine's tanh and exp, off in the last
    # place, change nothing above 1e-12 in these runs.
    assert deviation(reference_rows()) < 1e-9


def test_a_wrong_reference_is_seen() -> None:
    rows = reference_rows()
    for signal in range(2, len(SIGNALS) + 1):
        wrong = [list(row) for row in rows]
        wrong[25][signal] = float(wrong[25][signal]) + 1e-6
        assert deviation(wrong) > 1e-7


def test_an_unknown_car_is_refused() -> None:
    with pytest.raises(ValueError, match="car 'tractor' is not known"):
        change_figures("tractor", SPEEDS[1], 6.0)
