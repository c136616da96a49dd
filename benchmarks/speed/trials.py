"""Whole trials: one, a batch on threads, and the same under each engine."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from benchmarks.speed.timing import Effort, Outcome, Skipped, figure, seconds_of
from costeer.loop.jax_rollout import jax_rollouts
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_SCRIPTED, Script
from costeer.loop.trial import (
    idle_network,
    shipped_network,
    simulate_trial,
    trial_duration,
)
from costeer.methods.ibhs import IBHS
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
    """Simulate a trial, and several trials on threads, with records made in memory."""
    simulated = trial_duration(simulate_trial(setup))
    alone = seconds_of(lambda: simulate_trial(setup), effort.rounds)
    threads = default_jobs()
    setups = [
        setup._replace(participant=n) for n in range(1, threads * effort.batch + 1)
    ]
    with ThreadPoolExecutor(threads) as pool:
        records = list(pool.map(simulate_trial, setups))
        together = seconds_of(
            lambda: list(pool.map(simulate_trial, setups)), effort.rounds
        )
    driven = sum(trial_duration(record) for record in records)
    length = f"{setup.length / 1000.0:g} km, {simulated:.0f} s of driving"
    return [
        figure("trial", f"one trial, {name}", "s", alone, length),
        figure("trial", f"one trial, {name}", UNIT, simulated / alone),
        figure(
            "trial",
            f"batch, {name}",
            UNIT,
            driven / together,
            f"{len(setups)} trials on {threads} threads",
        ),
    ]


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
