"""A window over the last samples of a signal: the one memory that is an array.

Compiled code writes in place (a copy of 60 numbers a step would be most of the
controller's time); Python and JAX make a new window. Hand on the returned window and
forget the old one, and all engines agree (tests/base/test_window.py).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import lanes
from costeer.base.array import Flag, Real, compiled


class Window(NamedTuple):
    """The last samples of one signal, in a ring.

    Attributes:
        values: Samples, shape `(*batch, length)`; zeros until written. A batch
            appears when one is pushed; compiled code knows none.
        next_index: Where the next sample goes [-].
        num_samples: How many have been written, at most `length` [-].
    """

    values: NDArray[np.float64]
    next_index: int
    num_samples: int


@compiled
def empty_window(length: int) -> Window:
    """Return a window of `length` samples that has seen none."""
    return Window(values=np.zeros(length), next_index=0, num_samples=0)


def _with_value(values: Any, index: Any, value: Any) -> Any:
    """Return `values` with one sample replaced; a copy in Python, traced in JAX."""
    if isinstance(values, np.ndarray) and isinstance(index, (int, np.integer)):
        if isinstance(value, np.ndarray) and values.ndim <= value.ndim:
            values = np.broadcast_to(values, (*value.shape, values.shape[-1]))
        values = values.copy()
        values[..., index] = value
        return values
    import jax.numpy as jnp

    return jnp.asarray(values).at[index].set(value)


@overload(_with_value, strict=False)
def _with_value_in_place(values: Any, index: Any, value: Any) -> Any:
    if lanes.in_lanes(value):

        def together(values: Any, index: Any, value: Any) -> Any:
            lanes.store(values, index, value)
            return values

        return together

    def implementation(values: Any, index: Any, value: Any) -> Any:
        values[index] = value
        return values

    return implementation


def _total(values: Any) -> Any:
    """Sum over the samples."""
    return values.sum(axis=-1)


@overload(_total, strict=False)
def _total_compiled(values: Any) -> Any:
    if values.ndim == 2:

        def together(values: Any) -> Any:
            total = lanes.spread(0.0)
            for index in range(values.shape[1]):
                total = total + lanes.load(values, index)
            return total

        return together
    return lambda values: values.sum()


@compiled
def _length(window: Window) -> int:
    """How many samples the window holds when full."""
    length: int = window.values.shape[-1]
    return length


@compiled
def push(window: Window, value: Real) -> Window:
    """Return the window after one more sample; the oldest leaves when it is full."""
    length = _length(window)
    num_samples = window.num_samples + (window.num_samples < length)
    return Window(
        values=_with_value(window.values, window.next_index, value),
        next_index=(window.next_index + 1) % length,
        num_samples=num_samples,
    )


@compiled
def full(window: Window) -> Flag:
    """Whether the window has as many samples as it holds."""
    return window.num_samples >= _length(window)


@compiled
def mean(window: Window) -> Real:
    """Mean of a full window; summed anew each time, so that no rounding drifts."""
    total: Real = _total(window.values)
    return total / _length(window)
