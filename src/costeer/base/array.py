"""The array engine: one source for Python floats, NumPy, Numba and JAX.

Every equation of costeer is a pure function of `Real`s on named tuples. This file
binds that source to an engine. A function here looks at what it is given: a Python
float goes to `math`, a NumPy array to NumPy, a traced JAX value to `jax.numpy`; in
code compiled by Numba the overloads at the end stand in. See
docs/decisions/0002-engine.md.
"""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np
from numba import types
from numba.extending import overload

import costeer.base.replace
import costeer.base.whole  # noqa: F401  what compiled code does with named tuples
from costeer.base import elementary, lanes
from costeer.base.marks import compiled as compiled
from costeer.base.marks import inlined as inlined

Real: TypeAlias = float
"""A float, an array of them or a traced value: annotations show the scalar."""

Flag: TypeAlias = bool
"""A bool, an array of them or a traced value."""

State = TypeVar("State")
Value = TypeVar("Value")
Arguments = TypeVar("Arguments")


def _numpy_like(value: Any) -> Any:  # Any: this is where engines meet
    """Return the module that computes with `value`: NumPy or jax.numpy."""
    if isinstance(value, (np.ndarray, np.generic)):
        return np
    if "jax.numpy" not in sys.modules:
        raise TypeError(f"{value!r} is no number or array; give a float")
    return sys.modules["jax.numpy"]


def tanh(x: Real) -> Real:
    """Hyperbolic tangent."""
    if isinstance(x, (float, int)):
        return math.tanh(x)
    return cast("Real", _numpy_like(x).tanh(x))


def sin(x: Real) -> Real:
    """Sine of an angle in radians; NaN if it is not finite, in every engine."""
    if isinstance(x, (float, int)):
        return math.sin(x) if math.isfinite(x) else math.nan
    return cast("Real", _numpy_like(x).sin(x))


def cos(x: Real) -> Real:
    """Cosine of an angle in radians; NaN if it is not finite, in every engine."""
    if isinstance(x, (float, int)):
        return math.cos(x) if math.isfinite(x) else math.nan
    return cast("Real", _numpy_like(x).cos(x))


def tan(x: Real) -> Real:
    """Tangent of an angle in radians; NaN if it is not finite, in every engine."""
    if isinstance(x, (float, int)):
        return math.tan(x) if math.isfinite(x) else math.nan
    return cast("Real", _numpy_like(x).tan(x))


def atan(x: Real) -> Real:
    """Angle in radians whose tangent is `x`."""
    if isinstance(x, (float, int)):
        return math.atan(x)
    return cast("Real", _numpy_like(x).arctan(x))


def sqrt(x: Real) -> Real:
    """Square root."""
    if isinstance(x, (float, int)):
        return math.sqrt(x)
    return cast("Real", _numpy_like(x).sqrt(x))


def exp(x: Real) -> Real:
    """Exponential function."""
    if isinstance(x, (float, int)):
        return math.exp(x)
    return cast("Real", _numpy_like(x).exp(x))


def log(x: Real) -> Real:
    """Natural logarithm of a positive number."""
    if isinstance(x, (float, int)):
        return math.log(x)
    return cast("Real", _numpy_like(x).log(x))


def floor(x: Real) -> Real:
    """Largest whole number not above `x`, as a float."""
    if isinstance(x, (float, int)):
        return float(math.floor(x)) if math.isfinite(x) else float(x)
    return cast("Real", _numpy_like(x).floor(x))


def isfinite(x: Real) -> Flag:
    """Whether `x` is neither infinite nor NaN."""
    if isinstance(x, (float, int)):
        return math.isfinite(x)
    return cast("Flag", _numpy_like(x).isfinite(x))


def absolute(x: Real) -> Real:
    """`x` without its sign."""
    return select(x < 0.0, -x, x)


def minimum(a: Real, b: Real) -> Real:
    """Smaller of the two."""
    return select(a < b, a, b)


def maximum(a: Real, b: Real) -> Real:
    """Larger of the two."""
    return select(a > b, a, b)


def clip(x: Real, low: Real, high: Real) -> Real:
    """`x` held between `low` and `high`; NaN stays NaN."""
    return select(x < low, low, select(x > high, high, x))


def logical_not(flag: Flag) -> Flag:
    """Whether `flag` is false; `not` would refuse arrays, `~True` is -2."""
    return flag == False  # noqa: E712  because `not` cannot be traced


def select(condition: Flag, if_true: Value, if_false: Value) -> Value:
    """Return one of two values by a flag: `if` that arrays and compilers accept.

    Named tuples are chosen field by field.
    """
    if isinstance(condition, (bool, np.bool_)):
        return if_true if condition else if_false
    if isinstance(if_true, tuple):
        fields = zip(if_true, cast("Any", if_false), strict=True)
        chosen = tuple(select(condition, one, other) for one, other in fields)
        kind = cast("Any", type(if_true))
        return cast("Value", kind(*chosen) if hasattr(kind, "_fields") else chosen)
    return cast("Value", _numpy_like(condition).where(condition, if_true, if_false))


def when(
    condition: Flag | None,
    function: Callable[..., Value],
    arguments: tuple[Any, ...],
    otherwise: Value,
) -> Value:
    """`function(*arguments)` by a flag, or else a value of the same kind.

    Where the flag is false compiled code does not call the function; JAX does, and
    takes the other value. With None instead of a flag there is nothing to call the
    function for, and it is not even compiled.
    """
    if condition is None:
        return otherwise
    if isinstance(condition, (bool, np.bool_)):
        return function(*arguments) if condition else otherwise
    return select(condition, function(*arguments), otherwise)


def repeat(
    function: Callable[[State, Arguments], State],
    times: int,
    state: State,
    arguments: Arguments,
) -> State:
    """Apply `state = function(state, arguments)` a whole number of times."""
    if _is_traced(state):
        return cast("State", _repeat_traced(function, times, state, arguments))
    for _ in range(times):
        state = function(state, arguments)
    return state


def _is_traced(state: Any) -> bool:  # Any: a tree of whatever the engine uses
    """Whether any leaf of the tree belongs to JAX."""
    jax = sys.modules.get("jax")
    if jax is None:
        return False
    return any(isinstance(leaf, jax.Array) for leaf in jax.tree_util.tree_leaves(state))


def _repeat_traced(function: Any, times: int, state: Any, arguments: Any) -> Any:
    """`repeat` as one loop of the XLA compiler, instead of `times` copies."""
    import jax

    state = jax.tree_util.tree_map(jax.numpy.asarray, state)
    return jax.lax.fori_loop(0, times, lambda _, s: function(s, arguments), state)


def add_scaled(state: State, rate: State, step: Real) -> State:
    """Return `state + step * rate`, field by field, for named tuples of `Real`s."""
    fields = zip(cast("Any", state), cast("Any", rate), strict=True)
    kind = cast("Any", type(state))  # Any: a type variable has no constructor
    return cast("State", kind(*(value + step * slope for value, slope in fields)))


def _bind(function: Callable[..., Any], target: Callable[..., Any]) -> None:
    """Let Numba use `target` where the source says `function`."""

    @overload(function, strict=False)
    def _(x: Any) -> Any:
        return lambda x: target(x)


for _function in (tanh, sin, cos, tan, atan, exp, log):
    _bind(_function, getattr(elementary, _function.__name__))


_TOGETHER: dict[Callable[..., Any], tuple[Callable[..., Any], Any]] = {
    sqrt: (math.sqrt, lanes.sqrt),
    floor: (np.floor, lanes.floor),
    absolute: (abs, lanes.absolute),
    isfinite: (math.isfinite, lanes.isfinite),
    logical_not: (operator.not_, lanes.logical_not),
}


def _bind_together(function: Callable[..., Any], alone: Any, together: Any) -> None:
    """Let Numba use one target for a plain value, another one for eight."""

    @overload(function, strict=False)
    def _(x: Any) -> Any:
        return (lambda x: together(x)) if lanes.in_lanes(x) else (lambda x: alone(x))


for _function, (_alone, _eight) in _TOGETHER.items():
    _bind_together(_function, _alone, _eight)


@overload(minimum, strict=False)
def _minimum(a: Any, b: Any) -> Any:
    if lanes.in_lanes(a, b):
        return lambda a, b: lanes.select(a < b, a, b)
    return lambda a, b: a if a < b else b


@overload(maximum, strict=False)
def _maximum(a: Any, b: Any) -> Any:
    if lanes.in_lanes(a, b):
        return lambda a, b: lanes.select(a > b, a, b)
    return lambda a, b: a if a > b else b


@overload(clip, strict=False)
def _clip(x: Any, low: Any, high: Any) -> Any:
    if lanes.in_lanes(x, low, high):
        return lambda x, low, high: select(x < low, low, select(x > high, high, x))
    return lambda x, low, high: low if x < low else (high if x > high else x)


@overload(select, strict=False)
def _select(condition: Any, if_true: Any, if_false: Any) -> Any:
    if isinstance(condition, lanes.Mask):
        return lambda condition, if_true, if_false: lanes.select(
            condition, if_true, if_false
        )
    if lanes.in_lanes(if_true, if_false):

        def either(condition: Any, if_true: Any, if_false: Any) -> Any:
            one, other = lanes.spread(if_true), lanes.spread(if_false)
            return one if condition else other

        return either
    return lambda condition, if_true, if_false: if_true if condition else if_false


@overload(when, strict=False)
def _when(condition: Any, function: Any, arguments: Any, otherwise: Any) -> Any:
    if isinstance(condition, types.NoneType):
        return lambda condition, function, arguments, otherwise: otherwise
    if isinstance(condition, lanes.Mask):

        def where_any(
            condition: Any, function: Any, arguments: Any, otherwise: Any
        ) -> Any:
            found = lanes.spread(otherwise)
            if lanes.any_lane(condition):
                found = lanes.select(condition, function(*arguments), otherwise)
            return found

        return where_any
    if lanes.in_lanes(arguments, otherwise):

        def of_all(
            condition: Any, function: Any, arguments: Any, otherwise: Any
        ) -> Any:
            found = lanes.spread(otherwise)
            if condition:
                found = lanes.spread(function(*arguments))
            return found

        return of_all

    def implementation(
        condition: Any, function: Any, arguments: Any, otherwise: Any
    ) -> Any:
        return function(*arguments) if condition else otherwise

    return implementation


@overload(repeat, strict=False)
def _repeat(function: Any, times: Any, state: Any, arguments: Any) -> Any:
    if lanes.in_lanes(state):

        def together(function: Any, times: Any, state: Any, arguments: Any) -> Any:
            now = lanes.spread(state)
            for _ in range(times):
                now = lanes.spread(function(now, arguments))
            return now

        return together

    def implementation(function: Any, times: Any, state: Any, arguments: Any) -> Any:
        for _ in range(times):
            state = function(state, arguments)
        return state

    return implementation


@overload(add_scaled, strict=False)
def _add_scaled(state: Any, rate: Any, step: Any) -> Any:
    if not isinstance(state, types.BaseNamedTuple):
        return None
    kind = cast("Any", state)  # Any: Numba's tuple types declare no attributes
    terms = ", ".join(f"state.{f} + step * rate.{f}" for f in kind.fields)
    source = f"def implementation(state, rate, step):\n    return Tuple({terms})\n"
    names: dict[str, Any] = {"Tuple": kind.instance_class}
    exec(source, names)  # no other way to write out the fields of a tuple
    return names["implementation"]
