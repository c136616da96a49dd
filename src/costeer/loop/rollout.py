"""A whole trial: the closed loop of a method run from start to the end of the road.

The same steps (loop/tick.py) run in three engines: compiled by Numba, the default, as
plain Python, and traced by JAX. Each method has machine code of its own.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.core import errors
from numpy.typing import NDArray

from costeer.base.entry import entry_for
from costeer.base.packing import packed, unpack
from costeer.intention.wavefront import WavefrontState, WavefrontWeights
from costeer.loop.jax_rollout import jax_rollout
from costeer.loop.parameters import LoopParameters
from costeer.loop.rows import ROW_COLUMNS
from costeer.loop.tick import Script, run
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


def _compiled_trial(method: Method[P, S]) -> Any:  # Any: a compiled function of Numba
    """The compiled trial of a method; its machine code lies in the method's folder."""
    initial_state, step = rule_of(method)
    like = LoopParameters(controller=usual_parameters(method))

    def run_packed(
        parameters: Rows,
        script: Script,
        weights: WavefrontWeights,
        memory: WavefrontState,
        noise: Rows,
        rows: Rows,
    ) -> int:
        # A tuple of functions is made in compiled code: Numba cannot take one.
        rule = Rule(initial_state, step)
        given = unpack(like, parameters)
        return run(rule, given, script, weights, memory, noise, rows)

    return entry_for((initial_state, step), run_packed)


def rollout(
    method: Method[P, S],
    parameters: LoopParameters[P],
    script: Script,
    weights: WavefrontWeights,
    memory: WavefrontState,
    noise: Rows,
    engine: str,
) -> Rows:
    """Run one trial.

    Args:
        method: That assists.
        parameters: Of the trial.
        script: Where the crossing probability comes from.
        weights: Of the network.
        memory: Of the network, changed in place.
        noise: Random numbers, shape `(time, draw)`.
        engine: "numba", "python" or "jax"; JAX runs no network.

    Returns:
        Rows in the order of `ROW_COLUMNS`, shape `(time, column)`.

    Raises:
        ValueError: If the engine is not known, JAX is asked for the network, or the
            method cannot be compiled.
        ModuleNotFoundError: If the engine is not installed.
    """
    if engine == "jax":
        return jax_rollout(method, parameters, script, noise)
    rows = np.empty((len(noise), len(ROW_COLUMNS)))
    if engine == "numba":
        count = _run_compiled(
            method, packed(parameters), script, weights, memory, noise, rows
        )
    elif engine == "python":
        rule = rule_of(method)
        count = run(rule, parameters, script, weights, memory, noise, rows)
    else:
        raise ValueError(f"engine '{engine}' is not known; choose numba, python or jax")
    return rows[:count]


def _run_compiled(method: Method[P, S], *arguments: Any) -> int:
    """Run the compiled trial.

    Raises:
        ValueError: If Numba cannot compile the method.
    """
    try:
        count: int = compiled_once(_compiled_trial, method)(*arguments)
    except errors.NumbaError as error:
        raise ValueError(cannot_compile(method, error)) from error
    return count


def cannot_compile(method: Method[P, S], error: Exception) -> str:
    """Why a method does not compile, in the lines that speak of its own code."""
    told = [line.strip() for line in str(error).splitlines() if line.strip()]
    reasons = [line for line in told if not line.startswith(("-", "File", "During"))]
    return (
        f"method '{method.name}' cannot be compiled: {'; '.join(reasons[-4:])}. Each "
        "of its functions, and each function they call, is marked @costeer.compiled; "
        "costeer.testing.check_method says more"
    )
