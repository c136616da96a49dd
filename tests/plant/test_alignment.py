"""How a road runs, against circles and Fresnel's integrals."""

from __future__ import annotations

import math

import pytest

from costeer.plant.alignment import (
    MOST_STATIONS,
    STRAIGHT,
    alignment,
    bend_at,
    line_curvature,
    road_heading,
    road_offset,
    road_turn,
)
from tests.plant.roads import point_on

RADIUS, LENGTH, STRAIGHT_PART = 500.0, 120.0, 200.0
STATIONS = (0.0, STRAIGHT_PART, STRAIGHT_PART + LENGTH, 900.0, 900.0 + LENGTH)
CURVATURES = (0.0, 0.0, 1.0 / RADIUS, 1.0 / RADIUS, 0.0)
ROAD = alignment(STATIONS, CURVATURES)
ON_ARC = STRAIGHT_PART + LENGTH
HALF_SPIRAL = LENGTH / (2.0 * RADIUS)
"""A clothoid turns by half of what its length on the arc would [rad]."""


@pytest.mark.parametrize("distance", [0.0, 1.0, 250.0, 579.0])
def test_an_arc_turns_by_its_length_over_its_radius(distance: float) -> None:
    turned = road_turn(ROAD, ON_ARC, distance)
    assert turned == pytest.approx(distance / RADIUS, abs=1e-15)
    assert road_heading(ROAD, ON_ARC + distance) == pytest.approx(HALF_SPIRAL + turned)


@pytest.mark.parametrize("distance", [10.0, 60.0, 119.0])
def test_a_clothoid_turns_with_the_square_of_its_length(distance: float) -> None:
    slope = 1.0 / RADIUS / LENGTH
    heading = road_heading(ROAD, STRAIGHT_PART + distance)
    assert heading == pytest.approx(slope * distance**2 / 2.0, rel=1e-12)
    bend = bend_at(ROAD, STRAIGHT_PART + distance)
    assert bend.curvature == pytest.approx(slope * distance)
    assert bend.slope == pytest.approx(slope)
    assert bend.station == STRAIGHT_PART + distance


def test_curvature_has_no_jump_and_heading_adds_up_to_the_end() -> None:
    for station, curvature in zip(STATIONS, CURVATURES, strict=True):
        for place in (station - 1e-9, station, station + 1e-9):
            assert bend_at(ROAD, place).curvature == pytest.approx(curvature, abs=1e-12)
    arc = (900.0 - ON_ARC) / RADIUS
    assert road_heading(ROAD, 2000.0) == pytest.approx(2.0 * HALF_SPIRAL + arc)


def test_nothing_changes_before_the_first_and_after_the_last_station() -> None:
    bent = alignment((100.0, 200.0), (0.001, 0.002))
    for before in (-50.0, 0.0, 99.0):
        assert bend_at(bent, before).curvature == 0.001
    for after in (200.0, 300.0, 1e5):
        assert bend_at(bent, after).curvature == 0.002
        assert bend_at(bent, after).slope == 0.0
    assert road_turn(bent, 300.0, 50.0) == pytest.approx(0.1)
    assert road_heading(STRAIGHT, 1e4) == bend_at(STRAIGHT, 1e4).curvature == 0.0


@pytest.mark.parametrize("radius", [300.0, -300.0, 500.0, 1500.0])
@pytest.mark.parametrize("distance", [5.0, 30.0, 60.0])
def test_the_offset_on_a_circle_is_exact_to_a_millimetre(
    radius: float, distance: float
) -> None:
    circle = alignment((0.0,), (1.0 / radius,))
    expected = radius * (1.0 - math.cos(distance / radius))
    assert road_offset(circle, 1000.0, distance) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("start", [150.0, 200.0, 230.0, 290.0, 880.0, 950.0])
@pytest.mark.parametrize("distance", [20.0, 60.0])
def test_the_offset_on_clothoids_follows_fresnel(start: float, distance: float) -> None:
    here, heading = point_on(STATIONS, CURVATURES, start)
    there, _ = point_on(STATIONS, CURVATURES, start + distance)
    turned = (there - here) * complex(math.cos(heading), -math.sin(heading))
    found = road_offset(ROAD, start, distance)
    # Simpson's rule is off by at most d³ / 384 times the step of the curvature's slope
    # where a station lies inside: 9 mm at 60 m, and far less at the near point.
    kink = distance**3 / 384.0 / (RADIUS * LENGTH)
    assert found == pytest.approx(turned.imag, abs=kink + 2e-3 * (distance / 60.0))


def test_a_mirrored_road_is_mirrored() -> None:
    other = alignment(STATIONS, [-each for each in CURVATURES])
    for place in (100.0, 250.0, 600.0, 950.0):
        assert road_heading(other, place) == -road_heading(ROAD, place)
        assert road_offset(other, place, 40.0) == -road_offset(ROAD, place, 40.0)


def test_a_line_beside_has_its_own_radius() -> None:
    # The centre of a left bend lies to the left: a line on that side is nearer.
    assert line_curvature(1.0 / RADIUS, 3.5) == pytest.approx(1.0 / (RADIUS - 3.5))
    assert line_curvature(-1.0 / RADIUS, 3.5) == pytest.approx(-1.0 / (RADIUS + 3.5))
    assert line_curvature(0.0, 3.5) == 0.0


@pytest.mark.parametrize("second", [100.0, 50.0])
def test_stations_that_do_not_rise_are_refused(second: float) -> None:
    with pytest.raises(ValueError, match=f"station {second:g} m comes after 100 m"):
        alignment((0.0, 100.0, second), (0.0, 0.0, 0.001))


def test_stations_fill_the_table_and_no_more() -> None:
    places = [10.0 * k for k in range(MOST_STATIONS)]
    full = alignment(places, [0.001] * MOST_STATIONS)
    assert bend_at(full, places[-1] + 5.0).curvature == 0.001
    with pytest.raises(ValueError, match=f"{MOST_STATIONS + 1} stations"):
        alignment([*places, 1e4], [0.001] * (MOST_STATIONS + 1))
