"""A whole trial: the closed loop of a method run from start to the end of the road.

The same steps (loop/tick.py) run in three engines: compiled by Numba, the default, as
plain Python, and traced by JAX. Each method has machine code of its own.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numba.core import errors
from numpy.typing import NDArray

from costeer.base.entry import entry_for
from costeer.base.packing import layout_of, pack, packed, unpack
from costeer.drivers.interface import AnyDriver, DriverLaw, law_of
from costeer.drivers.population import VIRTUAL
from costeer.loop.jax_rollout import jax_rollout
from costeer.loop.parameters import Bare, LoopParameters, bare_of, without
from costeer.loop.rows import LoopRule, loop_rule, rules_of, writer_of
from costeer.loop.step import LoopState, Rules, initial_state
from costeer.loop.tick import Network, Script, run
from costeer.methods.interface import (
    Method,
    P,
    Rule,
    S,
    compiled_once,
    usual_parameters,
)
from costeer.plant.fleet import num_cars

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


def _compiled_trial(
    method: Method[P, S], driver: AnyDriver, hands: Any, bare: Bare
) -> Any:  # Any: parameters of the driver; a compiled function of Numba
    """The compiled trial of both; its machine code lies in a folder of their own."""
    ((begin, step), (sit, act)), fill = loop_rule(method, driver)
    usual = LoopParameters(usual_parameters(method), driver=hands)
    like = without(usual, bare)
    like_state = initial_state(rules_of(method, driver), usual)
    like_state = on_bare_road(like_state) if bare.fleet else like_state

    def run_packed(
        parameters: Rows,
        state: Rows,
        script: Script,
        network: Network,
        noise: Rows,
        rows: Rows,
    ) -> int:
        # A tuple of functions is made in compiled code: Numba cannot take one.
        loop = LoopRule(Rules(Rule(begin, step), DriverLaw(sit, act)), fill)
        given, start = unpack(like, parameters), unpack(like_state, state)
        end, count = run(loop, given, start, script, network, noise, rows)
        pack(state, end)
        return count

    return entry_for((begin, step, sit, act), run_packed)


def begun(
    method: Method[P, S],
    parameters: LoopParameters[P],
    network: Network,
    engine: str = "numba",
    start: LoopState[S] | None = None,
    driver: AnyDriver = VIRTUAL,
) -> Advance:
    """A trial at its start, and the function that runs it on.

    Args:
        method: That assists.
        parameters: Of the trial.
        network: Of the intention, changed in place.
        engine: "numba" or "python".
        start: State that it starts from, if not the usual one.
        driver: Who holds the wheel.

    Raises:
        ValueError: If the engine is not known; when it is called, also if the method
            cannot be compiled.
    """
    state = start or initial_state(rules_of(method, driver), parameters)
    if engine == "python":
        return _in_python(method, driver, parameters, state, network)
    if engine != "numba":
        raise ValueError(f"engine '{engine}' is not known; choose numba, python or jax")
    bare = bare_of(parameters)
    numbers = packed(without(parameters, bare))
    memory = packed(on_bare_road(state) if bare.fleet else state)
    seat = law_of(driver), layout_of(parameters.driver), bare
    make = partial(_compiled_trial, driver=driver, hands=parameters.driver, bare=bare)

    def advance(script: Script, noise: Rows, rows: Rows, keep: bool = True) -> int:
        now = memory if keep else memory.copy()
        try:
            trial = compiled_once(make, method, *seat)
            count: int = trial(numbers, now, script, network, noise, rows)
        except errors.NumbaError as error:
            raise ValueError(cannot_compile(_whose(method, driver), error)) from error
        except Exception as error:  # whatever somebody else's code raises
            raise ValueError(broke(_whose(method, driver), error)) from error
        return count

    return advance


def on_bare_road(state: LoopState[S]) -> LoopState[S]:
    """A state in which there is no other car, and no room for one."""
    nothing: Any = None  # Any: as in `without`
    events = state.control.events._replace(fleet=nothing)
    return state._replace(control=state.control._replace(events=events))


def _in_python(
    method: Method[P, S],
    driver: AnyDriver,
    parameters: LoopParameters[P],
    state: Any,
    network: Network,
) -> Advance:
    """The trial as plain Python."""
    loop = loop_rule(method, driver)

    def advance(script: Script, noise: Rows, rows: Rows, keep: bool = True) -> int:
        nonlocal state
        try:
            end, count = run(loop, parameters, state, script, network, noise, rows)
        except Exception as error:  # as above
            raise ValueError(broke(_whose(method, driver), error)) from error
        state = end if keep else state
        return count

    return advance


def row_width(method: Method[P, S], parameters: LoopParameters[P]) -> int:
    """Numbers in a row: the columns of the method's records, three for each car."""
    return len(writer_of(method).columns) + 3 * num_cars(parameters.fleet)


def rollout(
    method: Method[P, S],
    parameters: LoopParameters[P],
    script: Script,
    network: Network,
    noise: Rows,
    engine: str = "numba",
    driver: AnyDriver = VIRTUAL,
) -> Rows:
    """Run one trial.

    Args:
        method: That assists.
        parameters: Of the trial.
        script: Where the crossing probability comes from.
        network: Of the intention, changed in place.
        noise: Random numbers, shape `(time, draw)`.
        engine: "numba", "python" or "jax"; JAX runs no network.
        driver: Who holds the wheel.

    Returns:
        Rows of the record's columns, the method's own last, `(time, column)`.

    Raises:
        ValueError: If the engine is not known, JAX is asked for the network, or the
            method cannot be compiled.
        ModuleNotFoundError: If the engine is not installed.
    """
    if engine == "jax":
        return jax_rollout(method, parameters, script, noise, driver)
    rows = np.empty((len(noise), row_width(method, parameters)))
    run_on = begun(method, parameters, network, engine, driver=driver)
    count = run_on(script, noise, rows)
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


def _whose(method: Method[P, S], driver: AnyDriver) -> str:
    """Whose code runs in a loop."""
    own = "" if driver is VIRTUAL else f" with driver '{driver.name}'"
    return f"method '{method.name}'{own}"


def cannot_compile(whose: str, error: Exception) -> str:
    """Why a loop does not compile, in the lines that speak of its own code.

    Args:
        whose: Name of what does not compile.
        error: Of Numba.
    """
    told = [line.strip(" -\t") for line in str(error).splitlines()]
    reasons = [line for line in told if line.startswith(_REASONS)]
    places = [line for line in told if line.startswith("File") and OURS not in line]
    said = list(dict.fromkeys([*reasons[:3], *places[:1]])) or told[:1]
    return (
        f"{whose} cannot be compiled: {'; '.join(said)}. Each "
        "of its functions, and each function they call, is marked @compiled; "
        "costeer.testing.check_method says more"
    )


def broke(whose: str, error: Exception) -> str:
    """What is said when code of somebody else raises in the middle of a trial."""
    return f"a step of {whose} broke: {type(error).__name__}: {error}"
