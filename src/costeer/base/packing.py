"""Named tuples to flat arrays and back: the boundary of compiled code.

Inside, the equations work on nested named tuples; at the boundary one packed float64
array is handed over, because unboxing a deep tuple costs Numba microseconds a call.
Booleans and whole numbers become floats; a vector inside a tuple lies in its place.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

Tuple = TypeVar("Tuple")


def packed_size(value: Any) -> int:
    """Return how many float64 the nested named tuple `value` takes."""
    if isinstance(value, tuple):
        return sum(packed_size(part) for part in value)
    return int(np.size(value))


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
    array = np.empty(packed_size(value))
    pack(array, value)
    return array


def pack(array: NDArray[np.float64], value: Any) -> None:
    """Write the nested named tuple into `array` from its start."""
    _pack(array, 0, value)


def _pack(array: NDArray[np.float64], offset: int, value: Any) -> int:
    if isinstance(value, tuple):
        for part in value:
            offset = _pack(array, offset, part)
        return offset
    size = int(np.size(value))
    array[offset : offset + size] = np.ravel(value)
    return offset + size


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
    if isinstance(like, np.ndarray):
        end = offset + like.size
        return array[offset:end].reshape(like.shape).copy(), end
    return type(like)(array[offset]), offset + 1


class _Leaf(NamedTuple):
    """A number or an array in a Numba tuple type.

    Attributes:
        expression: How the source reaches it, e.g. `value.car.mass`.
        kind: Its Numba type.
        place: Where it lies in the packed array, as source.
    """

    expression: str
    kind: Any  # Any: Numba does not type its types
    place: str


def _is_tuple(kind: Any) -> bool:
    """Whether a Numba type is that of a named tuple."""
    return isinstance(kind, types.BaseNamedTuple)


def _leaves(kind: Any, expression: str) -> list[tuple[str, Any]]:
    """Expression and type of all leaves of a Numba tuple type, in order."""
    if not _is_tuple(kind):
        return [(expression, kind)]
    parts = zip(kind.fields, kind.types, strict=True)
    return [
        leaf for name, part in parts for leaf in _leaves(part, f"{expression}.{name}")
    ]


def _placed(kind: Any, expression: str) -> list[_Leaf]:
    """All leaves with their places; how long an array is, is asked at run time."""
    count, sizes, leaves = 0, "", []
    for leaf, part in _leaves(kind, expression):
        first = f"{count}{sizes}"
        if isinstance(part, types.Array):
            sizes += f" + {leaf}.size"
            leaves.append(_Leaf(leaf, part, f"{first}:{count}{sizes}"))
        else:
            count += 1
            leaves.append(_Leaf(leaf, part, first))
    return leaves


@overload(pack, strict=False)
def _pack_compiled(array: Any, value: Any) -> Any:
    lines = [
        f"    array[{leaf.place}] = {leaf.expression}\n"
        for leaf in _placed(value, "value")
    ]
    return _written("def implementation(array, value):\n" + "".join(lines), {})


@overload(unpack, strict=False)
def _unpack_compiled(like: Any, array: Any) -> Any:
    names: dict[str, Any] = {}
    leaves = iter(_placed(like, "like"))
    expression = _constructor(like, names, leaves)
    source = f"def implementation(like, array):\n    return {expression}\n"
    return _written(source, names)


def _constructor(kind: Any, names: dict[str, Any], leaves: Iterator[_Leaf]) -> str:
    """Return the expression that rebuilds `kind` from the leaves' places."""
    if _is_tuple(kind):
        name = f"Tuple{len(names)}"
        names[name] = kind.instance_class
        parts = [_constructor(part, names, leaves) for part in kind.types]
        return f"{name}({', '.join(parts)})"
    stored = f"array[{next(leaves).place}]"
    if isinstance(kind, types.Boolean):
        return f"({stored} != 0.0)"
    if isinstance(kind, types.Integer):
        return f"int({stored})"
    return f"{stored}.copy()" if isinstance(kind, types.Array) else stored


def _written(source: str, names: dict[str, Any]) -> Any:
    """Return the function `implementation` that `source` defines."""
    exec(source, names)  # no other way to write out the fields of a tuple
    return names["implementation"]
