"""Named tuples to flat arrays and back: the boundary of compiled code.

Inside, the equations work on nested named tuples; at the boundary one packed float64
array is handed over, because unboxing a deep tuple costs Numba microseconds a call.
Booleans and whole numbers become floats, arrays inside a tuple lie flat in place.
"""

from __future__ import annotations

from typing import Any, TypeVar, cast

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


def _leaves(kind: Any, expression: str, leaves: list[str]) -> None:
    """Collect the expressions of all numbers in a Numba tuple type."""
    if isinstance(kind, types.BaseNamedTuple):
        for name, part in zip(kind.fields, kind.types, strict=True):
            _leaves(part, f"{expression}.{name}", leaves)
        return
    leaves.append(expression)


@overload(pack, strict=False)
def _pack_compiled(array: Any, value: Any) -> Any:
    """Only tuples of numbers: compiled code keeps windows outside what it packs."""
    leaves: list[str] = []
    _leaves(value, "value", leaves)
    lines = [f"    array[{i}] = {leaf}\n" for i, leaf in enumerate(leaves)]
    return _written("def implementation(array, value):\n" + "".join(lines), {})


@overload(unpack, strict=False)
def _unpack_compiled(like: Any, array: Any) -> Any:
    names: dict[str, Any] = {}
    expression, _ = _constructor(like, names, 0)
    source = f"def implementation(like, array):\n    return {expression}\n"
    return _written(source, names)


def _constructor(kind: Any, names: dict[str, Any], i: int) -> tuple[str, int]:
    """Return the expression that rebuilds `kind` from `array[i:]`."""
    if isinstance(kind, types.BaseNamedTuple):
        name = f"Tuple{len(names)}"
        names[name] = kind.instance_class
        parts = []
        for part in kind.types:
            expression, i = _constructor(part, names, i)
            parts.append(expression)
        return f"{name}({', '.join(parts)})", i
    if isinstance(kind, types.Boolean):
        return f"(array[{i}] != 0.0)", i + 1
    if isinstance(kind, types.Integer):
        return f"int(array[{i}])", i + 1
    return f"array[{i}]", i + 1


def _written(source: str, names: dict[str, Any]) -> Any:
    """Return the function `implementation` that `source` defines."""
    exec(source, names)  # no other way to write out the fields of a tuple
    return names["implementation"]
