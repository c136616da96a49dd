"""How much slower the closed loop is with one population of drivers than with another.

    python -m benchmarks.population_speed [--rounds 20] [--length 8000]

Simulates one trial of manual driving and one with strong guidance and scripted
intention, with `virtual-2` and `virtual` in turn so that the load of the machine hits
both alike, and prints the computing time of a control step of the compiled loop
(median, lowest and highest of the rounds, without records) and its growth. Time is that
of this thread alone, so that waiting for others does not count. Exit code 1 if a median
grows by more than 25 %.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np

from benchmarks.speed.machine import load, processor_name
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_method
from costeer.loop.tick import INTENTION_SCRIPTED, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network

BEFORE, AFTER = "virtual-2", "virtual"
CONDITIONS = ("manual", "strong-normal")

MOST_GROWTH = 0.25
"""By which the loop may be slower than with population 2 [-]. Source: issue of
population 3."""


def loop_of(driver: str, condition: str, length: float) -> Callable[[], int]:
    """A trial's loop, ready to run; it returns the number of its control steps."""
    setup = TrialSetup(
        condition=condition, driver=driver, intention="scripted", length=length
    )
    parameters, method = loop_parameters(setup), trial_method(setup)
    script = Script(INTENTION_SCRIPTED, PREDICTION_HORIZON, np.empty(0))
    steps = round(2.0 * length / setup.speed / DT)
    noise = driver_noise(setup.seed, setup.participant, condition, steps)
    network = idle_network()

    def run() -> int:
        return len(rollout(method, parameters, script, network, noise, "numba"))

    return run


def step_time(run: Callable[[], int]) -> float:
    """Computing time of a control step in one run of the loop [us]."""
    begin = time.thread_time()
    steps = run()
    return 1e6 * (time.thread_time() - begin) / steps


def told(times: list[float]) -> str:
    """Median, lowest and highest [us]."""
    return f"{median(times):6.3f} ({min(times):.3f} to {max(times):.3f})"


def main() -> int:
    """Print a row for each condition; return 1 if the loop has grown too slow."""
    parser = argparse.ArgumentParser(prog="benchmarks.population_speed")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--length", type=float, default=8000.0)
    asked = parser.parse_args()
    print(f"{processor_name()}, load {load()}")
    print(f"control step of the loop, median (range) of {asked.rounds} [us]")
    growth = []
    for condition in CONDITIONS:
        runs = {who: loop_of(who, condition, asked.length) for who in (BEFORE, AFTER)}
        for run in runs.values():
            run()  # compiles
        times: dict[str, list[float]] = {who: [] for who in runs}
        for _ in range(asked.rounds):
            for who, run in runs.items():
                times[who].append(step_time(run))
        growth.append(median(times[AFTER]) / median(times[BEFORE]) - 1.0)
        print(
            f"{condition:14s} {BEFORE} {told(times[BEFORE])}  {AFTER} "
            f"{told(times[AFTER])}  {growth[-1]:+.1%}"
        )
    return int(max(growth) > MOST_GROWTH)


if __name__ == "__main__":
    sys.exit(main())
