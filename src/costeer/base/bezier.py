"""Quintic Bezier curve with evenly spaced control points: Eq. (3) in closed form.

With control points at x0 + i L / 5 the curve's parameter is s = (x - x0) / L, so the
path is a function y(x) and its slope, curvature and curvature rate need no inversion.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled


class Quintic(NamedTuple):
    """A lateral path over the distance along the road.

    Attributes:
        start: x0, where it begins along the road [m].
        length: L, how far it reaches along the road [m].
        y0: Lateral position of the first control point [m].
        y1: Second control point [m].
        y2: Third control point [m].
        y3: Fourth control point [m].
        y4: Fifth control point [m].
        y5: Last control point [m].
    """

    start: Real
    length: Real
    y0: Real
    y1: Real
    y2: Real
    y3: Real
    y4: Real
    y5: Real


class PathPoint(NamedTuple):
    """Geometry of a path at one place.

    Attributes:
        lateral_position: y [m].
        slope: dy/dx [-].
        curvature: Of the path, positive to the left [1/m].
        curvature_slope: Its derivative along x [1/m²].
    """

    lateral_position: Real
    slope: Real
    curvature: Real
    curvature_slope: Real


@compiled
def quintic(
    start: Real,
    length: Real,
    lateral_position: Real,
    slope: Real,
    curvature: Real,
    final_position: Real,
) -> Quintic:
    """Return the path from a pose to a straight line along the road.

    Args:
        start: Where it begins along the road [m].
        length: Its reach along the road [m].
        lateral_position: At the start [m].
        slope: At the start, tan(heading) [-].
        curvature: At the start, positive to the left [1/m].
        final_position: Lateral position of the line it ends on [m].
    """
    second_derivative = curvature * (1.0 + slope * slope) ** 1.5
    y1 = lateral_position + slope * length / 5.0
    y2 = 2.0 * y1 - lateral_position + second_derivative * length * length / 20.0
    return Quintic(
        start=start,
        length=length,
        y0=lateral_position,
        y1=y1,
        y2=y2,
        y3=final_position,
        y4=final_position,
        y5=final_position,
    )


@compiled
def path_point(path: Quintic, position: Real) -> PathPoint:
    """Return the geometry at `position` [m] along the road, held at both ends."""
    s = xp.clip((position - path.start) / path.length, 0.0, 1.0)
    slope = _first(path, s) / path.length
    bend = _second(path, s) / (path.length * path.length)
    jerk = _third(path, s) / (path.length * path.length * path.length)
    stretch = 1.0 + slope * slope
    root = xp.sqrt(stretch)
    return PathPoint(
        lateral_position=_value(path, s),
        slope=slope,
        curvature=bend / (stretch * root),
        curvature_slope=(jerk - 3.0 * slope * bend * bend / stretch) / (stretch * root),
    )


@compiled
def _value(path: Quintic, s: Real) -> Real:
    """Bernstein form of degree five."""
    r = 1.0 - s
    low = r * r * r * (r * r * path.y0 + 5.0 * r * s * path.y1 + 10.0 * s * s * path.y2)
    high = (
        s * s * s * (10.0 * r * r * path.y3 + 5.0 * r * s * path.y4 + s * s * path.y5)
    )
    return low + high


@compiled
def _first(path: Quintic, s: Real) -> Real:
    """Derivative over s: Bernstein form of degree four on first differences."""
    r = 1.0 - s
    d0, d1, d2 = path.y1 - path.y0, path.y2 - path.y1, path.y3 - path.y2
    d3, d4 = path.y4 - path.y3, path.y5 - path.y4
    low = r * r * (r * r * d0 + 4.0 * r * s * d1 + 6.0 * s * s * d2)
    return 5.0 * (low + s * s * s * (4.0 * r * d3 + s * d4))


@compiled
def _second(path: Quintic, s: Real) -> Real:
    """Second derivative over s: degree three on second differences."""
    r = 1.0 - s
    d0 = path.y2 - 2.0 * path.y1 + path.y0
    d1 = path.y3 - 2.0 * path.y2 + path.y1
    d2 = path.y4 - 2.0 * path.y3 + path.y2
    d3 = path.y5 - 2.0 * path.y4 + path.y3
    low = r * r * (r * d0 + 3.0 * s * d1)
    return 20.0 * (low + s * s * (3.0 * r * d2 + s * d3))


@compiled
def _third(path: Quintic, s: Real) -> Real:
    """Third derivative over s: degree two on third differences."""
    r = 1.0 - s
    d0 = path.y3 - 3.0 * path.y2 + 3.0 * path.y1 - path.y0
    d1 = path.y4 - 3.0 * path.y3 + 3.0 * path.y2 - path.y1
    d2 = path.y5 - 3.0 * path.y4 + 3.0 * path.y3 - path.y2
    return 60.0 * (r * r * d0 + 2.0 * r * s * d1 + s * s * d2)
