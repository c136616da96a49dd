"""Numbers in a table: which interval a position lies in, and one element of an array."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base.array import Real


def interval(starts: NDArray[np.float64], count: Real, position: Real) -> int:
    """Number of the interval that a position lies in [-]; the first one before all.

    Args:
        starts: Where each begins, rising; beyond `count` infinite.
        count: How many there are [-].
        position: In the unit of `starts`.
    """
    if isinstance(position, float | int):
        place = int(np.searchsorted(starts, position, side="right"))
        return max(min(place, int(count)) - 1, 0)
    numpy: Any = np if isinstance(position, np.ndarray) else sys.modules["jax.numpy"]
    places = numpy.searchsorted(starts, position, side="right")
    found: int = numpy.clip(numpy.minimum(places, count) - 1, 0).astype(int)
    return found


@overload(interval, strict=False)
def _interval(starts: Any, count: Any, position: Any) -> Any:
    def implementation(starts: Any, count: Any, position: Any) -> Any:
        low, high = 0, int(count)
        while high - low > 1:
            middle = (low + high) // 2
            if starts[middle] <= position:
                low = middle
            else:
                high = middle
        return low

    return implementation


def element(values: NDArray[np.float64], index: int) -> Real:
    """One number of an array; a plain float where the array is one of NumPy."""
    found = values[index]
    return float(found) if isinstance(found, np.floating) else found


@overload(element, strict=False)
def _element(values: Any, index: Any) -> Any:
    return lambda values, index: values[index]
