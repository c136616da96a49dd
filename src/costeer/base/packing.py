"""Named tuples to flat arrays and back: the boundary of compiled code.

Inside, the equations work on nested named tuples; at the boundary one packed float64
array is handed over, because unboxing a deep tuple costs Numba microseconds a call.
Booleans and whole numbers become floats; a vector inside a tuple lies in its place.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import extending
from numba import types as numba_types
from numba.core import errors
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import lanes

Tuple = TypeVar("Tuple")

# Any: Numba types neither its types nor its decorators.
types: Any = numba_types
intrinsic = cast("Callable[[Any], Any]", extending.intrinsic)


def packed_size(value: Any) -> int:
    """Return how many float64 the nested named tuple `value` takes."""
    if isinstance(value, tuple):
        return sum(packed_size(part) for part in value)
    return 0 if value is None else int(np.size(value))


def leaf_names(value: Any, prefix: str = "") -> list[str]:
    """Return the dotted name of each packed number, e.g. `car.mass`."""
    if not isinstance(value, tuple):
        size = int(np.size(value))
        return [prefix] if np.ndim(value) == 0 else [prefix] * size
    names: list[str] = []
    for name in cast("Any", value)._fields:
        dotted = f"{prefix}.{name}" if prefix else name
        names += leaf_names(getattr(value, name), dotted)
    return names


def layout_of(value: Any) -> tuple[tuple[str, str], ...]:
    """Return name and kind of all that a nested named tuple holds, in its order."""
    if isinstance(value, tuple):
        return tuple(
            (f"{name}.{inner}", kind)
            for name, part in zip(cast("Any", value)._fields, value, strict=True)
            for inner, kind in layout_of(part)
        )
    return (("", f"{type(value).__name__}{np.shape(value)}"),)


def packed(value: Any) -> NDArray[np.float64]:
    """Return the nested named tuple as one new float64 array."""
    return np.array(_numbers(value, []), dtype=np.float64)


def pack(array: NDArray[np.float64], value: Any) -> None:
    """Write the nested named tuple into `array` from its start."""
    numbers = _numbers(value, [])
    array[: len(numbers)] = numbers


def _numbers(value: Any, found: list[float]) -> list[float]:
    """Add all that a nested tuple holds, in its order."""
    if isinstance(value, tuple):
        for part in value:
            _numbers(part, found)
    elif isinstance(value, (float, int)):
        found.append(value)
    elif value is not None:
        found.extend(np.ravel(value).tolist())
    return found


def unpack(like: Tuple, array: NDArray[np.float64]) -> Tuple:
    """Return a tuple of the kind of `like`, filled from the start of `array`.

    Args:
        like: A tuple whose types (and array sizes) the result takes.
        array: Numbers in the order that `pack` writes them.
    """
    return cast("Tuple", _unpack(like, array, 0)[0])


def _unpack(like: Any, array: NDArray[np.float64], offset: int) -> tuple[Any, int]:
    if isinstance(like, tuple):
        parts = []
        for part in like:
            value, offset = _unpack(part, array, offset)
            parts.append(value)
        return cast("Any", type(like))(*parts), offset
    if like is None:
        return None, offset
    if isinstance(like, np.ndarray):
        end = offset + like.size
        return array[offset:end].reshape(like.shape).copy(), end
    return type(like)(array[offset]), offset + 1


# Compiled, both are one row of loads and stores, written as LLVM's own instructions: as
# Python source with a statement for each of 800 numbers they took Numba half a minute.


class _Place:
    """Where the next number lies; how long an array is, is known at run time."""

    def __init__(self, context: Any, builder: Any, array: Any, kind: Any) -> None:
        if kind.layout != "C" or kind.dtype != types.float64:
            raise errors.TypingError(f"{kind} is no row of float64 without gaps")
        made = context.make_array(kind)(context, builder, array)
        self._builder, self._data = builder, made.data
        self.offset = context.get_constant(types.intp, 0)
        self._one = context.get_constant(types.intp, 1)

    def next(self) -> Any:
        """Pointer to the next number."""
        found = self._builder.gep(self._data, [self.offset])
        self.skip(self._one)
        return found

    def skip(self, count: Any) -> None:
        """Go on by so many numbers."""
        self.offset = self._builder.add(self.offset, count)


def _write_out(array: NDArray[np.float64], start: int, values: Any) -> None:
    for k in range(values.size):
        array[start + k] = values[k]


def _read_out(array: NDArray[np.float64], start: int, like: Any) -> Any:
    values = np.empty_like(like)
    for k in range(values.size):
        values[k] = array[start + k]
    return values


@intrinsic
def _stored(typing: Any, array: Any, value: Any) -> Any:
    """Write all numbers of a tuple into an array."""

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = _Place(context, builder, arguments[0], array)

        def store(kind: Any, part: Any) -> None:
            if isinstance(kind, types.BaseTuple):
                for k, inner in enumerate(kind.types):
                    store(inner, builder.extract_value(part, k))
            elif isinstance(kind, types.Array):
                given = arguments[0], place.offset, part
                called = types.void(array, types.intp, kind)
                context.compile_internal(builder, _write_out, called, given)
                made = context.make_array(kind)(context, builder, part)
                place.skip(made.nitems)
            elif not isinstance(kind, types.NoneType):
                number = context.cast(builder, part, kind, types.float64)
                builder.store(number, place.next())

        store(value, arguments[1])
        return context.get_dummy_value()

    return types.void(array, value), write


@intrinsic
def _loaded(typing: Any, like: Any, array: Any) -> Any:
    """A tuple like another, of the numbers of an array."""

    def read(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = _Place(context, builder, arguments[1], array)

        def load(kind: Any, part: Any) -> Any:
            if isinstance(kind, types.BaseTuple):
                inner = [
                    load(each, builder.extract_value(part, k))
                    for k, each in enumerate(kind.types)
                ]
                return context.make_tuple(builder, kind, inner)
            if isinstance(kind, types.Array):
                given = arguments[1], place.offset, part
                called = kind(array, types.intp, kind)
                value = context.compile_internal(builder, _read_out, called, given)
                made = context.make_array(kind)(context, builder, part)
                place.skip(made.nitems)
                return value
            if isinstance(kind, types.NoneType):
                return part
            number = builder.load(place.next())
            return context.cast(builder, number, types.float64, kind)

        return load(like, arguments[0])

    return like(like, array), read


@overload(pack, strict=False)
def _pack_compiled(array: Any, value: Any) -> Any:
    return lambda array, value: _stored(array, value)


@overload(unpack, strict=False)
def _unpack_compiled(like: Any, array: Any) -> Any:
    return lambda like, array: _loaded(like, array)


def _read_rows(array: NDArray[np.float64], start: int, like: Any) -> Any:
    values = np.empty((like.size, array.shape[1]))
    values[:] = array[start : start + like.size]
    return values.T


_WINDOWS = types.Array(types.float64, 2, "F")


def _spread_kind(kind: Any) -> Any:
    if isinstance(kind, types.BaseTuple):
        inner = [_spread_kind(each) for each in kind.types]
        return types.BaseTuple.from_types(inner, kind.instance_class)
    return _WINDOWS if isinstance(kind, types.Array) else lanes.spread_type(kind)


@intrinsic
def unpack_lanes(typing: Any, like: Any, array: Any) -> Any:
    """A tuple like another with eight of each number, from an array `(number, lane)`.

    Arrays in it become arrays `(lane, element)`; whole numbers are those of the first
    lane.
    """

    def read(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        rows = arguments[1]
        one = context.get_constant(types.intp, 1)
        at = context.get_constant(types.intp, 0)

        def take(kind: Any, part: Any) -> Any:
            nonlocal at
            whole, start = _spread_kind(kind), at
            if isinstance(kind, types.BaseTuple):
                inner = [
                    take(each, builder.extract_value(part, k))
                    for k, each in enumerate(kind.types)
                ]
                return context.make_tuple(builder, whole, inner)
            if isinstance(kind, types.NoneType):
                return part
            if isinstance(kind, types.Array):
                made = context.make_array(kind)(context, builder, part)
                at = builder.add(at, made.nitems)
                called = whole(array, types.intp, kind)
                given = rows, start, part
                return context.compile_internal(builder, _read_rows, called, given)
            at = builder.add(at, one)
            return lanes.taken(context, builder, kind, array, rows, start)

        return take(like, arguments[0])

    return _spread_kind(like)(like, array), read
