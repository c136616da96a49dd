"""A whole trial: the closed loop of a method run from start to the end of the road.

The same steps (loop/tick.py) run in three engines: compiled by Numba, the default, as
plain Python, and traced by JAX. Each method has machine code of its own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numba.core import errors
from numpy.typing import NDArray

from costeer.base.entry import entry_for
from costeer.base.packing import pack, packed, unpack
from costeer.loop.jax_rollout import jax_rollout
from costeer.loop.parameters import LoopParameters
from costeer.loop.rows import LoopRule, loop_rule, writer_of
from costeer.loop.step import LoopState, initial_state
from costeer.loop.tick import Network, Script, run
from costeer.methods.interface import (
    Method,
    P,
    Rule,
    S,
    compiled_once,
    rule_of,
    usual_parameters,
)

Rows = NDArray[np.float64]

OURS = str(Path(__file__).parents[1])
"""Folder of this package's own sources."""


class Advance(Protocol):
    """A trial that has begun."""

    def __call__(
        self, script: Script, noise: Rows, rows: Rows, keep: bool = True
    ) -> int:
        """Run on with a script and noise; return how many rows were filled.

        What is not kept is forgotten: the next call begins where this one did.
        """


def _compiled_trial(method: Method[P, S]) -> Any:  # Any: a compiled function of Numba
    """The compiled trial of a method; its machine code lies in the method's folder."""
    (begin, step), fill = loop_rule(method)
    like = LoopParameters(controller=usual_parameters(method))
    like_state = initial_state(rule_of(method), like)

    def run_packed(
        parameters: Rows,
        state: Rows,
        script: Script,
        network: Network,
        noise: Rows,
        rows: Rows,
    ) -> int:
        # A tuple of functions is made in compiled code: Numba cannot take one.
        loop = LoopRule(Rule(begin, step), fill)
        given, start = unpack(like, parameters), unpack(like_state, state)
        end, count = run(loop, given, start, script, network, noise, rows)
        pack(state, end)
        return count

    return entry_for((begin, step), run_packed)


def begun(
    method: Method[P, S],
    parameters: LoopParameters[P],
    network: Network,
    engine: str = "numba",
    start: LoopState[S] | None = None,
) -> Advance:
    """A trial at its start, and the function that runs it on.

    Args:
        method: That assists.
        parameters: Of the trial.
        network: Of the intention, changed in place.
        engine: "numba" or "python".
        start: State that it starts from, if not the usual one.

    Raises:
        ValueError: If the engine is not known; when it is called, also if the method
            cannot be compiled.
    """
    state = start or initial_state(rule_of(method), parameters)
    if engine == "python":
        return _in_python(method, parameters, state, network)
    if engine != "numba":
        raise ValueError(f"engine '{engine}' is not known; choose numba, python or jax")
    numbers, memory = packed(parameters), packed(state)

    def advance(script: Script, noise: Rows, rows: Rows, keep: bool = True) -> int:
        now = memory if keep else memory.copy()
        try:
            trial = compiled_once(_compiled_trial, method)
            count: int = trial(numbers, now, script, network, noise, rows)
        except errors.NumbaError as error:
            raise ValueError(cannot_compile(method, error)) from error
        except Exception as error:  # whatever somebody else's code raises
            raise ValueError(broke(method, error)) from error
        return count

    return advance


def _in_python(
    method: Method[P, S], parameters: LoopParameters[P], state: Any, network: Network
) -> Advance:
    """The trial as plain Python."""
    loop = loop_rule(method)

    def advance(script: Script, noise: Rows, rows: Rows, keep: bool = True) -> int:
        nonlocal state
        try:
            end, count = run(loop, parameters, state, script, network, noise, rows)
        except Exception as error:  # as above
            raise ValueError(broke(method, error)) from error
        state = end if keep else state
        return count

    return advance


def rollout(
    method: Method[P, S],
    parameters: LoopParameters[P],
    script: Script,
    network: Network,
    noise: Rows,
    engine: str = "numba",
) -> Rows:
    """Run one trial.

    Args:
        method: That assists.
        parameters: Of the trial.
        script: Where the crossing probability comes from.
        network: Of the intention, changed in place.
        noise: Random numbers, shape `(time, draw)`.
        engine: "numba", "python" or "jax"; JAX runs no network.

    Returns:
        Rows of the record's columns, the method's own last, `(time, column)`.

    Raises:
        ValueError: If the engine is not known, JAX is asked for the network, or the
            method cannot be compiled.
        ModuleNotFoundError: If the engine is not installed.
    """
    if engine == "jax":
        return jax_rollout(method, parameters, script, noise)
    rows = np.empty((len(noise), len(writer_of(method).columns)))
    count = begun(method, parameters, network, engine)(script, noise, rows)
    return rows[:count]


_REASONS = (
    "Untyped",
    "Cannot",
    "Unknown attribute",
    "No implementation",
    "Failed in",
    "Use of unsupported",
    "Invalid use",
    "Unsupported",
    "Type of variable",
)
"""How the lines begin in which Numba says what is wrong."""


def cannot_compile(method: Method[P, S], error: Exception) -> str:
    """Why a method does not compile, in the lines that speak of its own code."""
    told = [line.strip(" -\t") for line in str(error).splitlines()]
    reasons = [line for line in told if line.startswith(_REASONS)]
    places = [line for line in told if line.startswith("File") and OURS not in line]
    said = list(dict.fromkeys([*reasons[:3], *places[:1]])) or told[:1]
    return (
        f"method '{method.name}' cannot be compiled: {'; '.join(said)}. Each "
        "of its functions, and each function they call, is marked @compiled; "
        "costeer.testing.check_method says more"
    )


def broke(method: Method[P, S], error: Exception) -> str:
    """What is said when a method's code raises in the middle of a trial."""
    return f"step of method '{method.name}' broke: {type(error).__name__}: {error}"
