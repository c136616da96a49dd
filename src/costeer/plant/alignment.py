"""How a road runs: curvature along its reference line, linear between stations.

Piecewise linear curvature is what roads are built of: straights, circular arcs and
clothoids between them. The reference line is the centre of the left lane, y = 0; a line
beside it, at y, has the curvature kappa / (1 - kappa y). Positions are along and across
the road; curvature is positive to the left.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.lookup import interval, rows_of

MOST_STATIONS = 256
"""Stations that a road may have; compiled code knows the size of its tables."""


class Alignment(NamedTuple):
    """Stations of a road, and what follows from them.

    Attributes:
        num_stations: Stations in use [-].
        table: A `Station` in each row, flat; those beyond `num_stations` lie at
            infinity.
    """

    num_stations: Real
    table: NDArray[np.float64]


class Station(NamedTuple):
    """A place from which on the curvature changes by another slope.

    Attributes:
        position: Along the road [m].
        curvature: There [1/m].
        slope: Change of the curvature along the road after it [1/m²].
        heading: Direction of the road there, 0 at the first [rad].
    """

    position: Real
    curvature: Real
    slope: Real
    heading: Real


_ROWS = rows_of(Station(0.0, 0.0, 0.0, 0.0))
_read_station, _WIDTH = _ROWS.read, _ROWS.width


class Bend(NamedTuple):
    """Curvature near a place on the road, linear along it.

    Attributes:
        station: The place along the road [m].
        curvature: There [1/m].
        slope: Its change along the road [1/m²].
    """

    station: Real = 0.0
    curvature: Real = 0.0
    slope: Real = 0.0


NO_BEND = Bend()
"""A straight stretch of road."""


def alignment(stations: Sequence[float], curvatures: Sequence[float]) -> Alignment:
    """A road through stations; before the first and after the last nothing changes.

    Args:
        stations: Along the road, rising; none for a straight road [m].
        curvatures: At each of them [1/m].

    Raises:
        ValueError: If there are too many, or they do not rise.
    """
    count = max(len(stations), 1)
    if count > MOST_STATIONS:
        raise ValueError(f"a road has {count} stations; give at most {MOST_STATIONS}")
    table = np.zeros((MOST_STATIONS, _WIDTH))
    places, bends, slopes, headings = table.T
    places[1:] = np.inf
    if len(stations):
        places[:count], bends[:count] = stations, curvatures
    steps = np.diff(places[:count])
    if np.any(steps <= 0.0):
        wrong = int(np.argmax(steps <= 0.0)) + 1
        raise ValueError(
            f"station {places[wrong]:g} m comes after {places[wrong - 1]:g} m; give "
            "stations in rising order"
        )
    slopes[: count - 1] = np.diff(bends[:count]) / steps
    means = (bends[: count - 1] + bends[1:count]) / 2.0
    headings[1:count] = np.cumsum(means * steps)
    return Alignment(float(count), table.ravel())


STRAIGHT = alignment((), ())
"""A straight road."""


@compiled
def _station_before(road: Alignment, position: Real) -> tuple[Station, Real]:
    """The station that a position follows, and the distance from it [m].

    Before the first station the road is as there: the distance is none.
    """
    index = interval(road.table, _WIDTH, road.num_stations, position)
    station: Station = _read_station(road.table, index)
    return station, xp.maximum(position - station.position, 0.0)


@compiled
def bend_at(road: Alignment, position: Real) -> Bend:
    """Curvature of the reference line near a position along the road [m]."""
    before, beyond = _station_before(road, position)
    return Bend(
        station=position,
        curvature=before.curvature + before.slope * beyond,
        slope=before.slope,
    )


@compiled
def road_heading(road: Alignment, position: Real) -> Real:
    """Direction of the reference line at a position [rad], 0 at the first station."""
    before, beyond = _station_before(road, position)
    turned = (before.curvature + before.slope * beyond / 2.0) * beyond
    return before.heading + turned


@compiled
def road_turn(road: Alignment, position: Real, distance: Real) -> Real:
    """How far the road turns from a position over a distance [rad]."""
    return road_heading(road, position + distance) - road_heading(road, position)


@compiled
def _sine(angle: Real) -> Real:
    """Sine of a small angle [-]; a road turns by less than 1 rad where one looks."""
    square = angle * angle
    return angle * (1.0 - square / 6.0 * (1.0 - square / 20.0))


@compiled
def road_offset(road: Alignment, position: Real, distance: Real) -> Real:
    """How far the road leaves its own tangent over a distance, left positive [m].

    Simpson's rule on the sine of the road's turn: exact to a millimetre within 60 m on
    curves of 300 m.

    Args:
        road: Its stations.
        position: Where the tangent is [m].
        distance: Along the road [m].
    """
    here = road_heading(road, position)
    half = road_heading(road, position + distance / 2.0) - here
    whole = road_heading(road, position + distance) - here
    return distance / 6.0 * (4.0 * _sine(half) + _sine(whole))


@compiled
def line_curvature(curvature: Real, lateral_position: Real) -> Real:
    """Curvature of the line beside the reference line [1/m].

    Args:
        curvature: Of the reference line [1/m].
        lateral_position: Of the line, left positive [m].
    """
    return curvature / (1.0 - curvature * lateral_position)
