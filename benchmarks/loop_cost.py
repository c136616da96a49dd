"""Where the time of a driver-second goes: operations of the loop, and all around it.

    python -m benchmarks.loop_cost [--seconds 20] [--rounds 7]

The loop runs as plain Python on numbers that count what is done with them, so that the
mix of operations is that of the equations as they are written. What one of each kind
costs at best is measured by itself, in compiled code without vectors. The sum is what
the equations would take, one driver at a time, if nothing were copied and nothing left
out; a compiler leaves out what it need not do twice. Beside it stands what the compiled
loop takes, and noise, columns and description of a trial around it. Times are those of
this thread alone, so that waiting for others does not count.
"""

from __future__ import annotations

import argparse
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

import numba
import numpy as np

from benchmarks.speed.machine import load, processor_name
from costeer.base import array
from costeer.base.packing import packed_size, unpack
from costeer.loop import step, tick, trial
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.rows import loop_rule
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_method
from costeer.loop.tick import INTENTION_SCRIPTED, PREDICTION_HORIZON, Network, Script

SETUP = TrialSetup(condition="strong-normal", intention="scripted", length=8000.0)
ELSEWHERE = "rest"
FUNCTIONS = ("sin", "cos", "tan", "atan", "tanh", "exp", "log", "sqrt")
KINDS = ("+ -", "x", "/", "compare", "select", *FUNCTIONS)

counts: Counter[tuple[str, str]] = Counter()
_stages = [ELSEWHERE]


def _note(kind: str, times: int = 1) -> None:
    counts[_stages[-1], kind] += times


def _counting(kind: str, operation: Callable[..., Any]) -> Callable[..., Any]:
    """An operation of floats that is counted and gives a number that counts."""

    def counted(*numbers: Any) -> Any:
        _note(kind)
        value = operation(*numbers)
        return Number(value) if isinstance(value, float) else value

    return counted


class Number(float):
    """A float that counts what is done with it."""


_OPERATIONS = {
    "+ -": ("add", "radd", "sub", "rsub"),
    "x": ("mul", "rmul"),
    "/": ("truediv", "rtruediv"),
    "compare": ("lt", "le", "gt", "ge"),
}
for _kind, _names in _OPERATIONS.items():
    for _name in _names:
        _dunder = f"__{_name}__"
        setattr(Number, _dunder, _counting(_kind, getattr(float, _dunder)))
# A change of sign is part of the operation that follows.
Number.__neg__ = lambda self: Number(-float(self))  # type: ignore[method-assign]


def numbers_in(value: Any) -> Any:  # Any: a tree of named tuples
    """The same tree with numbers that count."""
    if isinstance(value, tuple):
        parts = [numbers_in(part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return Number(value) if type(value) is float else value


@contextmanager
def _counted_functions() -> Iterator[None]:
    """The functions of the array engine count too."""

    def select(condition: Any, one: Any, other: Any) -> Any:
        _note("select", packed_size(one))
        return one if condition else other

    def counted(name: str) -> Callable[[Any], Any]:
        plain = getattr(array, name)
        return _counting(name, lambda x: plain(float(x)))

    replaced = {name: counted(name) for name in FUNCTIONS} | {"select": select}
    with patch.multiple(array, **replaced):
        yield


def _staged(stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function whose operations belong to a stage."""

    def run(*arguments: Any) -> Any:
        _stages.append(stage)
        try:
            return function(*arguments)
        finally:
            _stages.pop()

    return run


def counted_loop(setup: TrialSetup, seconds: float) -> Any:
    """Drive in plain Python on numbers that count; return the state at the end.

    Args:
        setup: Of the trial, without the network.
        seconds: How long [s].
    """
    counts.clear()
    parameters, method = loop_parameters(setup), trial_method(setup)
    loop = loop_rule(method, trial.trial_driver_model(setup))
    state = numbers_in(step.initial_state(loop.rules, parameters))
    parameters = numbers_in(parameters)
    ruled = loop.rules.method._replace(step=_staged("method", loop.rules.method.step))
    rules = loop.rules._replace(method=ruled)
    script = Script(INTENTION_SCRIPTED, PREDICTION_HORIZON, np.empty(0))
    network: Network = trial.idle_network()
    steps = round(seconds / DT)
    noise = driver_noise(setup.seed, setup.participant, setup.condition, steps)
    stages = {"driver": "drive", "car, column and arms": "move"}
    staged = {name: _staged(key, getattr(step, name)) for key, name in stages.items()}
    sense = _staged("sensors", tick.sense)
    with (
        _counted_functions(),
        patch.multiple(step, **staged),
        patch.object(tick, "sense", sense),
    ):
        for draws in noise:
            drawn = unpack(tick._NOISE, draws)
            state, _ = tick.tick(rules, parameters, state, script, network, drawn)
    return state


def unit_costs(rounds: int) -> dict[str, float]:
    """Least time of one operation of each kind in compiled code [ns]."""
    sources = {
        "+ -": "{a} + c",
        "x": "{a} * c",
        "/": "{a} / c",
        "compare": "{a} if {a} < c else {a} + c",
        "select": "{a} if {a} < c else c",
        **{name: f"math.{name}({{a}})" for name in FUNCTIONS},
    }
    return {kind: _unit_cost(source, rounds) for kind, source in sources.items()}


def _unit_cost(source: str, rounds: int) -> float:
    """Least time of one operation, eight of which do not wait for each other [ns]."""
    chains, repeats = [f"a{n}" for n in range(8)], 100_000
    # Each is given what it gave, so that none can be left out.
    lines = [
        "def f(x, c, times):",
        *(f"    {a} = x + {n}e-3" for n, a in enumerate(chains)),
        "    for _ in range(times):",
        *(f"        {a} = {source.format(a=a)}" for a in chains),
        f"    return {' + '.join(chains)}",
    ]
    scope: dict[str, Any] = {"math": math}
    exec("\n".join(lines), scope)  # a loop of its own for each operation
    run = numba.njit(error_model="numpy")(scope["f"])
    run(1.5, 1.0000001, 1)
    least = min(_timed(lambda: run(1.5, 1.0000001, repeats)) for _ in range(rounds))
    return 1e9 * least / (repeats * len(chains))


def _timed(run: Callable[[], Any]) -> float:
    begin = time.thread_time()
    run()
    return time.thread_time() - begin


class Around(NamedTuple):
    """Least time of the parts of a trial, per driver-second [us]."""

    loop: float
    noise: float
    columns: float
    description: float


def measured(rounds: int) -> Around:
    """What loop and surroundings take, the lowest of some rounds."""
    setup = SETUP
    parameters, method = loop_parameters(setup), trial_method(setup)
    steps = round(setup.length / (trial.LIKELY_SHARE * setup.speed) / DT)
    script = Script(INTENTION_SCRIPTED, PREDICTION_HORIZON, np.empty(0))
    seeds = setup.seed, setup.participant, setup.condition
    noise = driver_noise(*seeds, steps)
    network = trial.idle_network()

    def run() -> Any:
        return rollout(method, parameters, script, network, noise, "numba")

    rows = run()
    columns = trial.with_method_columns(method.columns)
    parts = (
        run,
        lambda: driver_noise(*seeds, steps),
        lambda: trial.record_columns(rows, True, columns),
        lambda: trial.trial_metadata(setup, parameters, None),
    )
    times = [[_timed(part) for _ in range(rounds)] for part in parts]
    seconds = len(rows) * DT
    return Around(*(1e6 * min(each) / seconds for each in times))


def print_table(seconds: float, costs: dict[str, float]) -> float:
    """Print operations by stage and their least time; return its sum [us]."""
    stages = sorted({stage for stage, _ in counts})
    shown = [k for k in KINDS if any(counts[stage, k] for stage in stages)]
    print(f"| operations per driver-second | {' | '.join(shown)} | at least [us] |")
    print("|---|" + "---|" * (len(shown) + 1))
    total = 0.0
    for stage in stages:
        each = [counts[stage, kind] / seconds for kind in shown]
        least = sum(n * costs[k] for n, k in zip(each, shown, strict=True)) / 1e3
        total += least
        print(f"| {stage} | {' | '.join(f'{n:,.0f}' for n in each)} | {least:.1f} |")
    print(f"| one of them [ns] | {' | '.join(f'{costs[k]:.2f}' for k in shown)} | |")
    return total


def main() -> None:
    """Print the operations, their least time, and what is measured."""
    parser = argparse.ArgumentParser(prog="benchmarks.loop_cost")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=7)
    asked = parser.parse_args()
    print(f"{processor_name()}, load {load()}; {SETUP.condition}, scripted intention\n")
    counted_loop(SETUP, asked.seconds)
    least = print_table(asked.seconds, unit_costs(asked.rounds))
    around = measured(asked.rounds)
    print(f"\noperations as written {least:.0f} us per driver-second")
    print(f"compiled loop {around.loop:.0f} us")
    print(
        f"around it: noise {around.noise:.1f}, columns {around.columns:.1f}, "
        f"description {around.description:.1f} us"
    )


if __name__ == "__main__":
    main()
