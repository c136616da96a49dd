"""Whole trials: one, a batch on threads, and the same under each engine."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from benchmarks.speed.timing import Effort, Outcome, Skipped, figure, seconds_of
from costeer.base.lanes import WIDTH
from costeer.loop.jax_rollout import jax_rollouts
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_SCRIPTED, Script
from costeer.loop.together import simulate_together
from costeer.loop.trial import (
    idle_network,
    likely_steps,
    shipped_network,
    simulate_trial,
    trial_duration,
)
from costeer.methods.conditions import CONDITION_NAMES
from costeer.methods.ibhs import IBHS
from costeer.records.columns import TrialRecord
from costeer.scale.jobs import default_jobs

STRONG = TrialSetup(condition="strong-normal", intention="scripted")
UNIT = "driver-s/s"
_ENGINE_SECONDS = 20.0
_TOGETHER = 64


def measure_trials(effort: Effort) -> Outcome:
    """One trial with scripted intention and with the network, then a batch."""
    scripted = STRONG._replace(length=effort.length)
    outcome: Outcome = _one_and_batch("scripted", scripted, effort)
    try:
        shipped_network()
    except (OSError, ValueError) as error:
        return [*outcome, Skipped("trial", "with the network", str(error))]
    network = scripted._replace(intention="network")
    return [*outcome, *_one_and_batch("network", network, effort)]


def _one_and_batch(name: str, setup: TrialSetup, effort: Effort) -> Outcome:
    """Simulate one trial, then many, with records made in memory."""
    simulated = trial_duration(simulate_trial(setup))
    alone = seconds_of(lambda: simulate_trial(setup), effort.rounds)
    length = f"{setup.length / 1000.0:g} km, {simulated:.0f} s of driving"
    return [
        figure("trial", f"one trial, {name}", "s", alone, length),
        figure("trial", f"one trial, {name}", UNIT, simulated / alone),
        *_batches(name, _trials_of_a_study(setup, effort.batch), effort.rounds),
    ]


def _trials_of_a_study(setup: TrialSetup, count: int) -> list[TrialSetup]:
    """Drivers in all conditions, those together that last as long, as study/batches."""
    conditions = len(CONDITION_NAMES)
    trials = [
        setup._replace(
            participant=1 + number // conditions,
            condition=CONDITION_NAMES[number % conditions],
        )
        for number in range(count)
    ]
    return sorted(trials, key=lambda each: likely_steps(each, loop_parameters(each)))


def _batches(name: str, trials: list[TrialSetup], rounds: int) -> Outcome:
    """Many trials one by one and eight at a time, in turn, on one thread and on all.

    What else the machine does so meets all of them.
    """
    threads = default_jobs()
    ways = {
        f"one by one, {threads} threads": (_one_by_one, threads),
        f"eight at a time, {threads} threads": (_together, threads),
        "eight at a time, 1 thread": (_together, 1),
    }
    found: dict[str, list[float]] = {way: [] for way in ways}
    with ThreadPoolExecutor(threads) as all_of_them, ThreadPoolExecutor(1) as only:
        for number in range(rounds + 1):
            for way, (drive, on) in ways.items():
                speed = _speed(drive, trials, only if on == 1 else all_of_them)
                if number > 0:  # compiled by then
                    found[way].append(speed)
    speeds = {way: np.array(each) for way, each in found.items()}
    apart, eight, single = speeds.values()
    what = f"batch, {name}"
    return [
        *(figure("trial", f"{what}, {way}", UNIT, speeds[way]) for way in ways),
        figure("trial", f"{what}, eight over one", "x", eight / apart, "in turn"),
        figure("trial", f"{what}, threads used", "", eight / single / threads),
    ]


def _speed(
    drive: Callable[[Sequence[TrialSetup]], float],
    trials: Sequence[TrialSetup],
    pool: ThreadPoolExecutor,
) -> float:
    """Driver-seconds per second of trials that are driven in batches of eight."""
    batches = [trials[k : k + WIDTH] for k in range(0, len(trials), WIDTH)]
    begun = time.perf_counter()
    driven = sum(pool.map(drive, batches))
    return driven / (time.perf_counter() - begun)


def _one_by_one(trials: Sequence[TrialSetup]) -> float:
    return sum(trial_duration(simulate_trial(each)) for each in trials)


def _together(trials: Sequence[TrialSetup]) -> float:
    made = simulate_together(trials)
    return sum(trial_duration(each) for each in made if isinstance(each, TrialRecord))


def measure_engines(effort: Effort) -> Outcome:
    """The same seconds of driving under each engine, arithmetic only, no record."""
    outcome: Outcome = []
    for engine in ("python", "numba", "jax"):
        outcome += _engine(engine, effort)
    return [*outcome, *_many_in_jax(effort)]


def _engine(engine: str, effort: Effort) -> Outcome:
    """Steady speed, and what the first call costs more."""
    steps = round(_ENGINE_SECONDS / DT)
    noise = driver_noise(1, 1, STRONG.condition, steps)
    script = Script(INTENTION_SCRIPTED, 3.0, np.array([]))
    parameters = loop_parameters(STRONG)
    run = partial(
        rollout,
        IBHS,
        parameters,
        script,
        idle_network(),
        noise,
        engine,
    )
    try:
        (first,) = seconds_of(run, 1)
    except ModuleNotFoundError as error:
        return [Skipped("engine", engine, str(error))]
    times = seconds_of(run, effort.rounds)
    remark = f"first call {first:.1f} s" if engine == "jax" else ""
    return [
        figure("engine", f"{engine}, 1 driver", UNIT, _ENGINE_SECONDS / times, remark)
    ]


def _many_in_jax(effort: Effort) -> Outcome:
    """Many drivers in one call of JAX."""
    if sys.modules.get("jax") is None:
        return []
    steps = round(_ENGINE_SECONDS / DT)
    numbers = range(1, _TOGETHER + 1)
    noise = np.stack([driver_noise(1, n, STRONG.condition, steps) for n in numbers])
    parameters = [loop_parameters(STRONG._replace(participant=n)) for n in numbers]
    run = partial(
        jax_rollouts,
        IBHS,
        parameters,
        Script(INTENTION_SCRIPTED, 3.0, np.array([])),
        noise,
    )
    (first,) = seconds_of(run, 1)
    times = seconds_of(run, effort.rounds)
    return [
        figure(
            "engine",
            f"jax, {_TOGETHER} drivers",
            UNIT,
            _TOGETHER * _ENGINE_SECONDS / times,
            f"first call {first:.1f} s",
        )
    ]
