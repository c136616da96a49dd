"""A line of points as stations with curvature, and how far these are from it."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.plant.alignment import MOST_STATIONS
from costeer.scenarios.definition import Bent
from costeer.scenarios.world import curvatures

Numbers = NDArray[np.float64]

SMOOTHED = 4.0
"""Length over which a step in curvature or heading becomes even [m]: the line moves by
7 mm at most where a straight meets a curve of 100 m."""

STRETCH = 100.0
"""Within which errors are told [m]."""

CLOSE = 0.01
"""Distance from the line within `STRETCH` that is sought [m]."""

_TOLERANCES = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
"""Of the curvature between stations [1/m]; the first that is close enough is taken."""

_STEP = 0.25


class Line(NamedTuple):
    """A line by its headings.

    Attributes:
        places: Middle of each chord along the line [m].
        headings: Of each chord [rad].
        chords: Their lengths [m].
    """

    places: Numbers
    headings: Numbers
    chords: Numbers

    @property
    def length(self) -> float:
        """Of the line [m]."""
        return float(self.chords.sum())


class Errors(NamedTuple):
    """How far the stations are from the points.

    Attributes:
        stretch: Largest distance within `STRETCH`, laid over each other [m].
        whole: Largest distance, begun together at the start [m].
    """

    stretch: float
    whole: float


def line_through(parts: Sequence[tuple[Numbers, Numbers]]) -> Line:
    """A line through points; from one part to the next there is no distance.

    Args:
        parts: East and north of points [m].
    """
    steps = [np.diff(np.stack(part)) for part in parts]
    east, north = np.concatenate(steps, axis=1)
    chords = np.hypot(east, north)
    there = chords > 1e-9
    chords, headings = chords[there], np.unwrap(np.arctan2(north, east)[there])
    ends = np.cumsum(chords)
    return Line(ends - chords / 2.0, headings, chords)


def _heading(line: Line, at: Numbers) -> Numbers:
    """Heading at places, evenly on beyond both ends [rad]."""
    reach = int(min(max(SMOOTHED / float(line.chords.mean()), 1), len(line.places) - 1))
    found = np.interp(at, line.places, line.headings)
    for end, other in ((0, reach), (-1, -1 - reach)):
        place, heading = line.places[end], line.headings[end]
        slope = (line.headings[other] - heading) / (line.places[other] - place)
        beyond = at < place if end == 0 else at > place
        found = np.where(beyond, heading + slope * (at - place), found)
    return found


class Fit(NamedTuple):
    """A line as stations.

    Attributes:
        stations: Between them the curvature is linear.
        length: Of the line, in full millimetres [m].
        errors: Against the line.
    """

    stations: tuple[Bent, ...]
    length: float
    errors: Errors


def fitted(line: Line) -> Fit:
    """A line as few stations that are close to it; as many as there may be, if need be.

    They are at full millimetres, none beyond the end of the line.
    """
    places = np.linspace(0.0, line.length, max(int(line.length), 2) + 1)
    half = SMOOTHED / 2.0
    turned = _heading(line, places + half) - _heading(line, places - half)
    bends = turned / SMOOTHED
    end, found = math.floor(line.length * 1000.0 + 0.01) / 1000.0, []
    for tolerance in _TOLERANCES:
        kept = _knots(places, bends, tolerance)
        stations = [_station(min(float(places[k]), end), float(bends[k])) for k in kept]
        found.append(Fit(tuple(stations), end, errors_of(line, stations)))
        if found[-1].errors.stretch < CLOSE:
            return found[-1]
    return min(found, key=lambda each: each.errors.stretch)


def _station(place: float, bend: float) -> Bent:
    if abs(bend) < _TOLERANCES[-1] / 2.0:
        return Bent(round(place, 3))
    return Bent(round(place, 3), float(f"{1.0 / bend:.7g}"))


def _knots(places: Numbers, values: Numbers, tolerance: float) -> list[int]:
    """Samples that are enough to draw all others between them, at most as many as fit.

    The sample that is farthest off is taken until none is far off.
    """
    kept = [0, len(places) - 1]
    waiting = [_farthest(places, values, 0, len(places) - 1)]
    while waiting and len(kept) < MOST_STATIONS - 1:
        error, first, here, last = heapq.heappop(waiting)
        if -error <= tolerance:
            break
        kept.append(here)
        heapq.heappush(waiting, _farthest(places, values, first, here))
        heapq.heappush(waiting, _farthest(places, values, here, last))
    return sorted(kept) if np.abs(values).max() > _TOLERANCES[-1] / 2.0 else []


def _farthest(
    places: Numbers, values: Numbers, first: int, last: int
) -> tuple[float, int, int, int]:
    """Largest distance from the line between two samples, negative, and where."""
    if last - first < 2:
        return 0.0, first, first, last
    inner = slice(first + 1, last)
    ends = [first, last]
    drawn = np.interp(places[inner], places[ends], values[ends])
    errors = np.abs(values[inner] - drawn)
    here = int(np.argmax(errors))
    return -float(errors[here]), first, first + 1 + here, last


def errors_of(line: Line, stations: Sequence[Bent]) -> Errors:
    """How far stations are from the line that they stand for."""
    count = max(int(line.length / _STEP), 4)
    places = np.linspace(0.0, line.length, count + 1)
    step = line.length / count
    true = _heading(line, places)
    bends = curvatures(stations, places)
    turned = np.cumsum((bends[1:] + bends[:-1]) / 2.0 * step)
    few = max(int(SMOOTHED / step), 1)
    headings = np.concatenate([[0.0], turned])
    headings += true[:few].mean() - headings[:few].mean()
    one, other = (_points(each, step) for each in (true, headings))
    ends = np.append(np.arange(0, count, max(int(STRETCH / step), 1)), count)
    apart = [_apart(one[a : b + 1], other[a : b + 1]) for a, b in pairwise(ends)]
    return Errors(max(apart), float(np.abs(one - other).max()))


def _points(headings: Numbers, step: float) -> NDArray[np.complex128]:
    """Points of a line by its headings at even places, as complex numbers [m]."""
    steps = np.exp(1j * headings)
    return np.concatenate([[0.0], np.cumsum((steps[1:] + steps[:-1]) / 2.0 * step)])


def _apart(one: NDArray[np.complex128], other: NDArray[np.complex128]) -> float:
    """Largest distance of two lines that are laid over each other [m]."""
    one, other = one - one.mean(), other - other.mean()
    turn = np.exp(1j * np.angle(np.vdot(other, one)))
    return float(np.abs(one - other * turn).max())
