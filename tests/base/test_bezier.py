"""The quintic path: its definition, its derivatives, its two ends."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.base.bezier import PathPoint, Quintic, path_point, quintic

LENGTHS = st.floats(20.0, 400.0)
OFFSETS = st.floats(-5.0, 5.0)
SLOPES = st.floats(-0.2, 0.2)
CURVATURES = st.floats(-0.02, 0.02)
SHARES = st.floats(0.0, 1.0)
PATHS = st.builds(
    quintic, st.floats(-1e3, 1e3), LENGTHS, OFFSETS, SLOPES, CURVATURES, OFFSETS
)


def de_casteljau(path: Quintic, share: float) -> float:
    """Lateral position of the curve by repeated halving of its control polygon."""
    points = [path.y0, path.y1, path.y2, path.y3, path.y4, path.y5]
    while len(points) > 1:
        pairs = itertools.pairwise(points)
        points = [(1.0 - share) * a + share * b for a, b in pairs]
    return points[0]


def at(path: Quintic, share: float) -> PathPoint:
    """The path at a share of its length."""
    return path_point(path, path.start + share * path.length)


@given(PATHS, SHARES)
def test_the_path_is_the_bezier_curve_of_its_control_points(
    path: Quintic, share: float
) -> None:
    place = (path.start + share * path.length - path.start) / path.length
    # Positions of metres carry rounding of 1e-15 through fifteen blends.
    assert at(path, share).lateral_position == pytest.approx(
        de_casteljau(path, min(max(place, 0.0), 1.0)), abs=1e-11
    )


@given(LENGTHS, OFFSETS, OFFSETS, SHARES)
def test_from_straight_ahead_the_path_is_the_minimum_jerk_polynomial(
    length: float, start: float, end: float, share: float
) -> None:
    s = share * length / length
    blend = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5
    path = quintic(0.0, length, start, 0.0, 0.0, end)
    # Rounding of metres.
    assert path_point(path, share * length).lateral_position == pytest.approx(
        start + (end - start) * blend, abs=1e-12
    )


@given(PATHS, st.floats(0.02, 0.98))
def test_slope_and_curvature_are_the_derivatives_of_the_position(
    path: Quintic, share: float
) -> None:
    step = path.length * 1e-3
    before, here, after = (
        path_point(path, path.start + share * path.length + k * step)
        for k in (-1.0, 0.0, 1.0)
    )
    rise = (after.lateral_position - before.lateral_position) / (2.0 * step)
    turn = (math.atan(after.slope) - math.atan(before.slope)) / (2.0 * step)
    bend = (after.curvature - before.curvature) / (2.0 * step)
    # Central differences err by step² / 6 times a third derivative; 2e-4 of the
    # largest value the polygon allows covers it.
    reach = 1.0 + max(abs(y) for y in path[2:])
    scale = 2e-4 * reach / path.length
    assert here.slope == pytest.approx(rise, abs=20.0 * scale)
    along = turn * math.cos(math.atan(here.slope))
    assert here.curvature == pytest.approx(along, abs=200.0 * scale / path.length)
    assert here.curvature_slope == pytest.approx(
        bend, abs=4000.0 * scale / path.length**2
    )


@given(LENGTHS, OFFSETS, SLOPES, CURVATURES, OFFSETS)
def test_the_path_starts_in_the_given_pose(
    length: float, position: float, slope: float, curvature: float, end: float
) -> None:
    here = path_point(quintic(7.0, length, position, slope, curvature, end), 7.0)
    # The second derivative is a difference of metres over length² of 400 or more.
    assert here.lateral_position == position
    assert here.slope == pytest.approx(slope, abs=1e-13)
    assert here.curvature == pytest.approx(curvature, abs=1e-13)


@given(PATHS, st.floats(0.0, 1e3))
def test_the_path_ends_straight_on_its_line_and_stays_there(
    path: Quintic, beyond: float
) -> None:
    there = path_point(path, path.start + path.length + 1e-9 + beyond)
    assert there.lateral_position == path.y5
    assert there.slope == 0.0
    assert there.curvature == 0.0


@given(LENGTHS, OFFSETS, SLOPES, CURVATURES, OFFSETS, SHARES)
def test_a_mirrored_pose_gives_the_mirrored_path(
    length: float,
    position: float,
    slope: float,
    curvature: float,
    end: float,
    share: float,
) -> None:
    left = at(quintic(0.0, length, position, slope, curvature, end), share)
    right = at(quintic(0.0, length, -position, -slope, -curvature, -end), share)
    assert tuple(right) == tuple(-value for value in left)  # signs round alike


def test_a_batch_of_places_gives_what_its_members_give() -> None:
    path = quintic(3.0, 90.0, 0.2, 0.01, -0.001, -3.5)
    places = np.linspace(-10.0, 120.0, 60)
    batch = np.transpose(path_point(path, places))
    members = [path_point(path, float(place)) for place in places]
    # The power of the slope may round differently in NumPy.
    np.testing.assert_allclose(batch, members, 1e-13, 1e-18)
