"""Tables of numbers that compiled code reads: records in the rows of a flat array."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import lanes
from costeer.base.array import Real, compiled

Numbers = NDArray[np.float64]


def interval(table: Numbers, width: int, count: Real, position: Real) -> int:
    """Number of the row that begins at or before a position [-]; the first before all.

    Args:
        table: Rows of `width` numbers, of which the first says where each begins,
            rising; infinite beyond `count`.
        width: Numbers of a row [-].
        count: Rows in use [-].
        position: In the unit of the first numbers.
    """
    starts = table[::width]
    if isinstance(position, float | int):
        place = int(np.searchsorted(starts, position, side="right"))
        return max(min(place, int(count)) - 1, 0)
    numpy: Any = np if isinstance(position, np.ndarray) else sys.modules["jax.numpy"]
    places = numpy.searchsorted(numpy.asarray(starts), position, side="right")
    last = numpy.minimum(places, count) - 1
    found: int = numpy.maximum(last, 0).astype(int)
    return found


@overload(interval, strict=False)
def _interval(table: Any, width: Any, count: Any, position: Any) -> Any:
    if lanes.in_lanes(position):

        def of_each(table: Any, width: Any, count: Any, position: Any) -> Any:
            found = lanes.spread(0.0)
            for row in range(1, int(count)):
                begun = table[row * width] <= position
                found = lanes.select(begun, float(row), found)
            return found

        return of_each

    def implementation(table: Any, width: Any, count: Any, position: Any) -> Any:
        low, high = 0, int(count)
        while high - low > 1:
            middle = (low + high) // 2
            if table[middle * width] <= position:
                low = middle
            else:
                high = middle
        return low

    return implementation


def element(values: Numbers, index: int) -> Real:
    """One number of an array; a plain float where the array is one of NumPy."""
    ours = isinstance(index, int | np.integer | np.ndarray)
    if isinstance(values, np.ndarray) and not ours:
        values = sys.modules["jax.numpy"].asarray(values)  # the place is traced
    found = values[index]
    return float(found) if isinstance(found, np.floating) else cast("Real", found)


@overload(element, strict=False)
def _element(values: Any, index: Any) -> Any:
    if lanes.in_lanes(index):
        return lambda values, index: lanes.gathered(values, index)
    return lambda values, index: values[index]


class Rows(NamedTuple):
    """How records of one kind lie in a flat array.

    Attributes:
        width: Numbers of a record [-].
        read: `read(values, index)` gives the record of a row.
        write: `write(values, index, record)` puts it there, in place.
    """

    width: int
    read: Callable[[Numbers, int], Any]  # Any: the record
    write: Callable[[Numbers, int, Any], None]


def rows_of(like: Any) -> Rows:  # Any: a nested named tuple of numbers
    """Write out how records lie in rows, for all engines; JAX only reads.

    Args:
        like: A record; nested ones follow in their places.
    """
    names: dict[str, Any] = {"__name__": __name__, "element": element}
    places: list[str] = []

    def made(value: Any, path: str) -> str:
        if not hasattr(value, "_fields"):
            places.append(path)
            return f"element(values, start + {len(places) - 1})"
        kind = f"Tuple{len(names)}"
        names[kind] = type(value)
        parts = [made(getattr(value, f), f"{path}.{f}") for f in value._fields]
        return f"{kind}({', '.join(parts)})"

    record = made(like, "record")
    start = f"    start = index * {len(places)}\n"
    written = "".join(
        f"    values[start + {k}] = {path}\n" for k, path in enumerate(places)
    )
    source = (
        f"def read(values, index):\n{start}    return {record}\n\n"
        f"def write(values, index, record):\n{start}{written}"
    )
    exec(source, names)  # no other way to write out the fields of a tuple
    for name in ("read", "write"):
        unique = f"{name}_{type(like).__name__}"
        names[name].__name__ = names[name].__qualname__ = unique
    return Rows(len(places), compiled(names["read"]), compiled(names["write"]))
