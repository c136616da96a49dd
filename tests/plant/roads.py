"""Roads in the plane, by closed forms: lines, circles and Fresnel's integrals."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.special import fresnel


def _spiral(curvature: float, slope: float, length: float) -> complex:
    """Where a clothoid ends that begins at 0 towards 1, as x + iy [m]."""
    if slope < 0.0:
        return _spiral(-curvature, -slope, length).conjugate()
    # The direction is slope w² / 2 less a constant, with w = u + curvature / slope.
    first = curvature / slope
    sines, cosines = fresnel(np.array([first, first + length]) * (slope / np.pi) ** 0.5)
    whole = complex(np.diff(cosines)[0], np.diff(sines)[0])
    turned = np.exp(-0.5j * curvature * first)
    return complex(turned * (np.pi / slope) ** 0.5 * whole)


def _piece(curvature: float, slope: float, length: float) -> complex:
    if slope != 0.0:
        return _spiral(curvature, slope, length)
    if curvature == 0.0:
        return complex(length)
    return complex((np.exp(1j * curvature * length) - 1.0) / (1j * curvature))


def point_on(
    stations: Sequence[float], curvatures: Sequence[float], position: float
) -> tuple[complex, float]:
    """A point of the reference line as x + iy [m] and the direction there [rad].

    The road begins at 0 towards 1; after the last station its curvature is constant.
    """
    ends = [*stations[1:], float("inf")]
    bends = [*curvatures, curvatures[-1]]
    where, heading = 0.0 + 0.0j, 0.0
    for (start, end), (one, other) in zip(
        zip(stations, ends, strict=True), pairwise(bends), strict=True
    ):
        length = min(position, end) - start
        if length <= 0.0:
            break
        slope = (other - one) / (end - start)
        where += _piece(one, slope, length) * np.exp(1j * heading)
        heading += (one + slope * length / 2.0) * length
    return where, heading
