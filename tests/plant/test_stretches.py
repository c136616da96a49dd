"""Gusts, lost heads and lane changes on stretches of the road."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.plant.stretches import (
    MOST_STRETCHES,
    NOTHING_HAPPENS,
    Stretch,
    side_force,
    stretch_at,
    stretches,
)

GUST = Stretch(500.0, 560.0, side_force=900.0)
LOST = Stretch(100.0, 200.0, head_lost=1.0)
ASKED = Stretch(560.0, 700.0, wanted_side=-1.0)
ROAD = stretches([GUST, ASKED, LOST])


@pytest.mark.parametrize(
    ("position", "stretch", "lasts"),
    [
        (100.0, LOST, True),
        (199.9, LOST, True),
        (200.0, LOST, False),
        (500.0, GUST, True),
        (560.0, ASKED, True),
        (701.0, ASKED, False),
    ],
)
def test_a_stretch_lasts_from_its_start_to_its_end(
    position: float, stretch: Stretch, lasts: bool
) -> None:
    assert stretch_at(ROAD, position) == (stretch, lasts)


def test_before_the_first_stretch_and_without_one_nothing_lasts() -> None:
    assert not stretch_at(ROAD, 99.9)[1]
    for position in (-10.0, 0.0, 1e5):
        assert not stretch_at(NOTHING_HAPPENS, position)[1]


def force_at(gust: Stretch, position: float) -> float:
    found, lasts = stretch_at(stretches([gust]), position)
    return side_force(found, lasts, position)


@pytest.mark.parametrize("force", [900.0, -1400.0])
def test_a_gust_has_its_force_in_the_middle_and_rises_without_a_corner(
    force: float,
) -> None:
    gust = GUST._replace(side_force=force)
    assert force_at(gust, 530.0) == force
    for outside in (499.0, 500.0, 560.0, 600.0):
        assert force_at(gust, outside) == 0.0
    # (4 x (1 - x))²: 9/16 at a quarter, 8/15 on average, flat at both ends.
    assert force_at(gust, 515.0) == pytest.approx(force * 9.0 / 16.0)
    assert force_at(gust, 545.0) == pytest.approx(force * 9.0 / 16.0)
    places = np.linspace(500.0, 560.0, 1201)
    forces = np.array([force_at(gust, place) for place in places])
    assert forces.mean() == pytest.approx(force * 8.0 / 15.0, rel=1e-3)
    assert abs(forces[1]) < 1e-4 * abs(force)


def test_other_stretches_have_no_wind() -> None:
    assert force_at(LOST, 150.0) == force_at(ASKED, 600.0) == 0.0


def test_stretches_that_overlap_are_refused_and_those_that_touch_are_not() -> None:
    stretches([GUST, ASKED])
    with pytest.raises(ValueError, match="at 550 m begins before the one at 500 m"):
        stretches([ASKED._replace(start=550.0), GUST])


def test_there_are_at_most_as_many_as_the_table_holds() -> None:
    many = [Stretch(10.0 * k, 10.0 * k + 5.0) for k in range(MOST_STRETCHES + 1)]
    last, lasts = stretch_at(stretches(many[:-1]), 10.0 * MOST_STRETCHES - 9.0)
    assert lasts
    assert last.start == 10.0 * (MOST_STRETCHES - 1)
    with pytest.raises(ValueError, match=f"{MOST_STRETCHES + 1} events"):
        stretches(many)
