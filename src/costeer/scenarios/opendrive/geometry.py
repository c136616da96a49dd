"""The reference line of an OpenDRIVE road as points.

Lines, arcs, spirals (curvature linear in the length) and cubic polynomials, as of
ASAM OpenDRIVE 1.8, section 7. Each element begins where the file puts it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.scenarios.opendrive.tree import Element

Numbers = NDArray[np.float64]

STEP = 0.25
"""Between points [m]: a chord of a curve of 50 m is 0.2 mm from its arc."""

LONGEST = 200_000.0
"""Road that is read [m]."""

_TIGHTEST = 0.2
"""Largest curvature that is read [1/m]; no car turns in less than 5 m."""

_SHAPES = ("line", "arc", "spiral", "poly3", "paramPoly3")

_RANGES = "give normalized or arcLength"

_FINER, _MOST_POINTS = 8, 1_000_000
"""Points of a polynomial for each point that is kept, where its length is measured."""


class Piece(NamedTuple):
    """An element of the reference line.

    Attributes:
        begin: Along the road [m].
        length: [m].
        x: Of its first point, east [m].
        y: As above, north [m].
        heading: There [rad].
        shape: Line, arc, spiral or polynomial.
    """

    begin: float
    length: float
    x: float
    y: float
    heading: float
    shape: Element


class Course(NamedTuple):
    """Points of a line.

    Attributes:
        x: East [m].
        y: North [m].
        heading: Direction of the reference line there [rad].
    """

    x: Numbers
    y: Numbers
    heading: Numbers


def pieces_of(road: Element) -> list[Piece]:
    """Elements of a road's reference line.

    Raises:
        ValueError: If one cannot be read, naming its line.
    """
    listed = [_piece(each) for each in road.below("planView", "geometry")]
    if not listed:
        raise ValueError(
            f"{road.where}: the road has no planView; give it one with geometry"
        )
    check_rising([(each.begin, each.shape) for each in listed])
    total = listed[-1].begin + listed[-1].length
    if not total <= LONGEST:
        told = f"the road is {total / 1000:.5g} km long; give at most"
        raise ValueError(f"{road.where}: {told} {LONGEST / 1000:g} km")
    return listed


def check_rising(begun: Sequence[tuple[float, Element]]) -> None:
    """Refuse what a road cannot have one after the other.

    Args:
        begun: Where each begins along the road [m], and what.

    Raises:
        ValueError: If one begins before the road or no later than that before it.
    """
    before = -1e-6
    for begin, element in begun:
        if not begin > before:
            told = f"this begins at s = {begin:g} m; give 0 or more, in rising order"
            raise ValueError(f"{element.where}: {told}")
        before = begin


def _piece(geometry: Element) -> Piece:
    known = [each for each in geometry.children if each.name in _SHAPES]
    if len(known) != 1:
        found = ", ".join(each.name for each in geometry.children) or "nothing"
        raise ValueError(
            f"{geometry.where}: geometry of {found[:60]} is not read; give one of "
            f"{', '.join(_SHAPES)}"
        )
    length = geometry.number("length")
    if not length > 0.0:
        raise ValueError(
            f"{geometry.where}: geometry of length {length:g} m; give more"
        )
    begin, x, y = (geometry.number(name) for name in ("s", "x", "y"))
    return Piece(begin, length, x, y, geometry.number("hdg"), known[0])


def course_of(piece: Piece, places: Numbers) -> Course:
    """Points of an element.

    Args:
        piece: The element.
        places: Along it from its beginning, rising [m].

    Raises:
        ValueError: If its numbers cannot be, naming the line.
    """
    draw = _polynomial if "oly3" in piece.shape.name else _clothoid
    u, v, turned = draw(piece, places)
    cosine, sine = math.cos(piece.heading), math.sin(piece.heading)
    return Course(
        piece.x + cosine * u - sine * v,
        piece.y + sine * u + cosine * v,
        piece.heading + turned,
    )


def _clothoid(piece: Piece, places: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Line, arc or spiral: the curvature is linear in the length."""
    shape = piece.shape
    names = {"line": (), "arc": ("curvature",) * 2}.get(
        shape.name, ("curvStart", "curvEnd")
    )
    first, last = (shape.number(name) for name in names) if names else (0.0, 0.0)
    tightest = max(abs(first), abs(last))
    if tightest > _TIGHTEST:
        told = f"a curvature of {tightest:g} 1/m is a radius of {1 / tightest:.2g} m"
        raise ValueError(f"{shape.where}: {told}; give {1 / _TIGHTEST:g} m or more")
    slope = (last - first) / piece.length

    def turned(at: Numbers) -> Numbers:
        return (first + slope * at / 2.0) * at

    # Gauss and Legendre between places: five points are exact to rounding there.
    nodes, weights = np.polynomial.legendre.leggauss(5)
    steps = np.diff(places, prepend=0.0)
    inner = (places - steps / 2.0)[:, None] + steps[:, None] / 2.0 * nodes
    angles = turned(inner)
    u = np.cumsum(np.cos(angles) @ weights * steps / 2.0)
    v = np.cumsum(np.sin(angles) @ weights * steps / 2.0)
    return u, v, turned(places)


def _polynomial(piece: Piece, places: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """A cubic polynomial, by the length along it."""
    shape, length = piece.shape, piece.length
    across = _cubic(shape, "V") if shape.name == "paramPoly3" else _cubic(shape, "")
    along, reach = (0.0, 1.0, 0.0, 0.0), length
    if shape.name == "paramPoly3":
        along = _cubic(shape, "U")
        # Files without it mean 0 to 1, as the standard says.
        given = shape.given.get("pRange", "normalized")
        if given not in ("normalized", "arcLength"):
            raise ValueError(f"{shape.where}: pRange is {given[:40]!r}; {_RANGES}")
        reach = length if given == "arcLength" else 1.0
    count = min(max(int(length / STEP) * _FINER, 64), _MOST_POINTS)
    p = np.linspace(0.0, reach, count + 1)
    du, dv = (np.polyval(_slope(each), p) for each in (along, across))
    speed = np.hypot(du, dv)
    if not (np.isfinite(speed).all() and speed.min() > 0.0):
        told = f"the curve of <{shape.name}> stands still"
        raise ValueError(f"{shape.where}: {told}; give coefficients that lead on")
    middle = np.hypot(
        *(np.polyval(_slope(e), (p[1:] + p[:-1]) / 2.0) for e in (along, across))
    )
    steps = (speed[1:] + speed[:-1] + 4.0 * middle) / 6.0 * np.diff(p)
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    if shape.name == "poly3":  # u goes as far as the length lasts
        scale = 1.0
    else:
        scale = length / lengths[-1]
        if abs(scale - 1.0) > 0.02:
            raise ValueError(
                f"{shape.where}: the curve is {lengths[-1]:.2f} m long; its geometry "
                f"says {length:.2f} m: give the same length there"
            )
    at = np.interp(places, lengths * scale, p)
    u, v = (np.polyval(each[::-1], at) for each in (along, across))
    slopes = [np.polyval(_slope(each), at) for each in (along, across)]
    return u, v, np.unwrap(np.arctan2(slopes[1], slopes[0]))


def _cubic(shape: Element, axis: str) -> tuple[float, float, float, float]:
    a, b, c, d = (shape.number(f"{name}{axis}") for name in "abcd")
    return a, b, c, d


def _slope(cubic: Sequence[float]) -> list[float]:
    """Derivative of a cubic, highest power first."""
    return [3.0 * cubic[3], 2.0 * cubic[2], cubic[1]]
