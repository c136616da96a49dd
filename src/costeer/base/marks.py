"""How a pure function is marked as one that compiled code may call."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba.extending import register_jitable

Function = TypeVar("Function", bound=Callable[..., Any])

_INNER = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Functions that only compiled code calls need no entry from outside: a fifth of the
time that the compiler takes."""


def compiled(function: Function) -> Function:
    """Mark a pure function as one that compiled code may call.

    The function itself stays plain Python, so the Python and JAX engines run it as
    it is written; Numba compiles it into whatever calls it.

    Example:
        >>> import costeer
        >>> @costeer.compiled
        ... def spring(stiffness, angle):
        ...     return -stiffness * angle
        >>> spring(2.0, 0.5)
        -1.0
    """
    return register_jitable(**_INNER)(function)


def inlined(function: Function) -> Function:
    """Like `compiled`, for a function that hands large records on: no call is left.

    What LLVM does not inline by itself copies every tuple through memory.
    """
    return register_jitable(forceinline=True, **_INNER)(function)
