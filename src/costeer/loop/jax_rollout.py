"""A whole trial in JAX: the same tick under `jax.lax.scan`, in float64.

For gradients with respect to parameters and for many drivers at once; real time and
studies use Numba (docs/decisions/0002-engine.md). The intention network has a kernel
of its own that JAX does not call: here the intention is scripted or off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.base.extras import install_command
from costeer.drivers.interface import AnyDriver, DriverNoise
from costeer.drivers.population import VIRTUAL
from costeer.loop.endings import stopped_rows
from costeer.loop.parameters import LoopParameters
from costeer.loop.rows import rules_of, writer_of
from costeer.loop.step import LoopState, Rules, initial_state
from costeer.loop.tick import INTENTION_NETWORK, Script, tick
from costeer.methods.interface import Method, P, S
from costeer.plant.fleet import car_numbers, num_cars
from costeer.plant.place import BARRIER
from costeer.records.row import ROW_COLUMNS


class Fixed(NamedTuple):
    """What the compiler must know of a trial: a new value is a new compilation."""

    rules: Rules[Any, Any]  # Any: of any method and driver
    values: Callable[[Any], tuple[Any, ...]]  # Any: of a sample
    plant_steps: int
    intention: int
    num_cars: int


def _jax() -> Any:  # Any: the module, which a plain install lacks
    """Return JAX.

    Raises:
        ModuleNotFoundError: Saying what to install.
    """
    try:
        import jax
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"jax is not installed; install it with: {install_command('jax')}, or "
            "choose the engine numba or python",
            name="jax",
        ) from error
    return jax


def float64() -> Any:  # Any: a context manager of JAX's own
    """A context in which JAX computes with 64 bits and not, as usual, with 32."""
    jax = _jax()
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(True)
    return import_module("jax.experimental").enable_x64()  # older ones


def trace(
    parameters: LoopParameters[Any],
    horizon: Real,
    trigger_times: Any,  # Any: a traced array
    noise: Any,  # Any: a traced array
    fixed: Fixed,
) -> tuple[Any, Any]:
    """The trial as a function that JAX can compile, map and differentiate.

    Args:
        parameters: Of the trial; all but `plant_steps` may be traced.
        horizon: Of the scripted intention [s].
        trigger_times: Requested lane changes, shape `(request,)` [s].
        noise: Random numbers, shape `(time, draw)`.
        fixed: What the compiler must know.

    Returns:
        Position along the road after each step, shape `(time,)` [m], and the rows,
        shape `(time, column)`.
    """
    jax = _jax()
    parameters = parameters._replace(plant_steps=fixed.plant_steps)
    script = Script(fixed.intention, horizon, trigger_times)
    no_network: Any = None

    def advance(state: LoopState[Any], draws: Any) -> tuple[LoopState[Any], Any]:
        drawn = DriverNoise(*draws)
        moved, sample = tick(fixed.rules, parameters, state, script, no_network, drawn)
        numbers = [jax.numpy.asarray(n, float) for n in fixed.values(sample)]
        numbers += car_numbers(sample.events.fleet, fixed.num_cars)
        new_state = jax.tree_util.tree_map(_as_before, state, moved)
        position = new_state.world.vehicle.longitudinal_position
        return new_state, (position, jax.numpy.stack(numbers))

    start = jax.tree_util.tree_map(_of_one_type, initial_state(fixed.rules, parameters))
    _, (positions, rows) = jax.lax.scan(advance, start, noise)
    return positions, rows


def _of_one_type(leaf: Any) -> Any:  # Any: a number of Python, NumPy or JAX
    """The number as an array whose type does not depend on what it meets."""
    jnp = _jax().numpy
    return jnp.asarray(leaf, jnp.result_type(leaf))


def _as_before(old: Any, new: Any) -> Any:  # Any: as above
    """`new` in the type of `old`: what a loop carries keeps its type."""
    return _jax().numpy.asarray(new, old.dtype)


@cache
def _one_trial() -> Any:  # Any: a compiled function of JAX
    return _jax().jit(trace, static_argnames="fixed")


@cache
def _many_trials() -> Any:  # Any: as above
    jax = _jax()

    def together(
        parameters: Any, horizon: Any, trigger_times: Any, noise: Any, fixed: Fixed
    ) -> Any:
        mapped = jax.vmap(trace, in_axes=(0, None, None, 0, None))
        return mapped(parameters, horizon, trigger_times, noise, fixed)

    return jax.jit(together, static_argnames="fixed")


def _fixed(
    method: Method[P, S],
    parameters: LoopParameters[P],
    script: Script,
    driver: AnyDriver,
) -> Fixed:
    """What the compiler must know.

    Raises:
        ValueError: If the intention network is asked for.
    """
    if script.intention == INTENTION_NETWORK:
        raise ValueError(
            "engine 'jax' does not run the intention network; give the intention as "
            "scripted or off, or choose the engine numba or python"
        )
    return Fixed(
        rules_of(method, driver),
        writer_of(method).values,
        parameters.plant_steps,
        script.intention,
        num_cars(parameters.fleet),
    )


_CONTACT = ROW_COLUMNS.index("contact")


def _until_the_end(
    positions: NDArray[np.float64], rows: NDArray[np.float64], length: Real
) -> NDArray[np.float64]:
    """The rows until road, a collision or a car that stands for good end the trial."""
    ends = (positions >= length) | (rows[:, _CONTACT] >= BARRIER) | stopped_rows(rows)
    last = np.flatnonzero(ends)
    return rows[: last[0] + 1] if last.size else rows


def jax_rollout(
    method: Method[P, S],
    parameters: LoopParameters[P],
    script: Script,
    noise: NDArray[np.float64],
    driver: AnyDriver = VIRTUAL,
) -> NDArray[np.float64]:
    """Run one trial.

    Args:
        method: That assists.
        parameters: Of the trial.
        script: Where the crossing probability comes from; not the network.
        noise: Random numbers, shape `(time, draw)`.
        driver: Who holds the wheel.

    Returns:
        Rows in the order of `ROW_COLUMNS`, shape `(time, column)`.

    Raises:
        ValueError: If the intention network is asked for.
        ModuleNotFoundError: If JAX is not installed.
    """
    fixed = _fixed(method, parameters, script, driver)
    with float64():
        positions, rows = _one_trial()(
            parameters, script.horizon, script.trigger_times, noise, fixed=fixed
        )
        done = np.asarray(positions), np.array(rows)
    return _until_the_end(*done, parameters.road.length)


def jax_rollouts(
    method: Method[P, S],
    parameters: Sequence[LoopParameters[P]],
    script: Script,
    noise: NDArray[np.float64],
) -> list[NDArray[np.float64]]:
    """Run many trials together, one per driver; they share plant steps and script.

    Args:
        method: That assists in all of them.
        parameters: Of each trial.
        script: Where the crossing probability comes from; not the network.
        noise: Random numbers, shape `(trial, time, draw)`.

    Returns:
        For each trial its rows, as `jax_rollout` gives them.

    Raises:
        ValueError: If the trials differ in plant steps, or the network is asked for.
        ModuleNotFoundError: If JAX is not installed.
    """
    fixed = _fixed(method, parameters[0], script, VIRTUAL)
    steps = {one.plant_steps for one in parameters}
    if len(steps) > 1:
        raise ValueError(
            f"trials that run together have {sorted(steps)} plant steps in a control "
            "step; give them one number"
        )
    jax = _jax()
    stacked = jax.tree_util.tree_map(lambda *leaves: np.stack(leaves), *parameters)
    with float64():
        positions, rows = _many_trials()(
            stacked, script.horizon, script.trigger_times, noise, fixed=fixed
        )
        done = np.asarray(positions), np.array(rows)
    return [
        _until_the_end(place, row, one.road.length)
        for place, row, one in zip(*done, parameters, strict=True)
    ]
