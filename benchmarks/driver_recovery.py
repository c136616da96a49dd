"""Known drivers fitted: how often the 95 % interval holds the truth, and why not more.

    python -m benchmarks.driver_recovery [--drivers 100] [--seed 77] [--jobs 2]

The first table counts, per parameter of the identifiable set, the fits whose interval
holds the true value. The second adds to that set one parameter that a fit holds at its
usual value, and prints what the information of the recording says of it.
"""

from __future__ import annotations

import argparse
import math
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import SECOND
from costeer.identification.estimate import information
from costeer.identification.fit import USUAL, DriverFit, fit_driver
from costeer.identification.likelihood import Evidence
from costeer.identification.model import wheel_motion
from costeer.identification.parameters import STEERING, Parameter, value_of
from costeer.identification.recording import drive_of
from costeer.identification.stretches import changes, lane_keeping
from costeer.loop.scenario import TrialSetup, trial_driver
from costeer.loop.trial import simulate_trial
from costeer.records.columns import TrialRecord

HELD = (
    "vision.near_gain",
    "vision.far_gain",
    "vision.lag_time",
    "vision.delay",
    "vision.near_time",
    "vision.noise_time",
    "vision.motor_noise",
    "arm.holding_gain",
    "arm.intrinsic_share",
    "arm.lag",
    "tracking.wander_frequency",
    "tracking.wander_damping",
)
NUM_INFORMED = 10
"""Drivers behind the second table."""


class Recovered(NamedTuple):
    """A known driver, the fit and how long it took [s]."""

    truth: DriverParameters
    fit: DriverFit
    seconds: float


def manual(seed: int, participant: int) -> TrialSetup:
    """A manual trial of 8 km."""
    return TrialSetup(
        seed=seed,
        participant=participant,
        driver=SECOND.name,
        condition="manual",
        method="manual",
        intention="off",
        change_duration=math.nan,
    )


def recovered(setup: TrialSetup) -> Recovered:
    """Simulate a trial and fit its driver."""
    record = simulate_trial(setup)
    begin = time.perf_counter()
    fit = fit_driver(record)
    return Recovered(trial_driver(setup), fit, time.perf_counter() - begin)


def print_recovery(results: list[Recovered]) -> None:
    """Print how many intervals hold the truth."""
    print(f"{'parameter':30s} {'inside':>8s} {'below':>6s} {'above':>6s} {'width':>8s}")
    for name in dict.fromkeys(e.name for each in results for e in each.fit.estimates):
        pairs = [
            (value_of(each.truth, name), e)
            for each in results
            for e in each.fit.estimates
            if e.name == name
        ]
        below = sum(truth < e.low for truth, e in pairs)
        above = sum(truth > e.high for truth, e in pairs)
        width = float(np.median([e.high - e.low for _, e in pairs]))
        inside = f"{len(pairs) - below - above}/{len(pairs)}"
        print(f"{name:30s} {inside:>8s} {below:6d} {above:6d} {width:8.3g}")


def evidence_of(record: TrialRecord) -> Evidence:
    """What the likelihood looks at."""
    drive = drive_of(record)
    rows = lane_keeping(drive, changes(drive))
    return Evidence(drive, wheel_motion(drive, USUAL.arm), rows)


def told(setup: TrialSetup, added: str) -> tuple[float, float, str, float]:
    """Standard error, strongest correlation, with what, and condition number."""
    truth, evidence = trial_driver(setup), evidence_of(simulate_trial(setup))
    own = [p._replace(tied=() if added in p.tied else p.tied) for p in STEERING]
    parameters = [*own, Parameter(added, "", True, 0.0, math.inf)] if added else own
    matrix = information(truth, parameters, evidence)
    size = np.sqrt(np.diag(matrix))
    covariance = np.linalg.inv(matrix)
    deviation = np.sqrt(np.diag(covariance))
    correlation = covariance[-1] / (deviation[-1] * deviation)
    correlation[-1] = 0.0
    worst = int(np.abs(correlation).argmax())
    condition = float(np.linalg.cond(matrix / np.outer(size, size)))
    return deviation[-1], correlation[worst], parameters[worst].name, condition


def print_information(seed: int) -> None:
    """Print what the information says of each parameter that is held."""
    setups = [manual(seed, n) for n in range(1, NUM_INFORMED + 1)]
    alone = np.median([told(s, "")[3] for s in setups])
    print(f"\nidentifiable set: condition number {alone:.3g}; with one more:")
    print(f"{'':30s} {'error':>7s} {'correlation':>12s}  {'condition':>9s}")
    for name in HELD:
        found = [told(setup, name) for setup in setups]
        error, condition = (np.median([f[k] for f in found]) for k in (0, 3))
        values = [abs(f[1]) for f in found]
        middle = found[int(np.argsort(values)[len(values) // 2])]
        words = f"{middle[1]:12.2f}  {condition:9.3g}  with {middle[2]}"
        print(f"{name:30s} {100.0 * error:6.0f}% {words}")


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drivers", type=int, default=100)
    parser.add_argument("--seed", type=int, default=77)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    setups = [manual(options.seed, n) for n in range(1, options.drivers + 1)]
    begin = time.perf_counter()
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(recovered, setups))
    took = time.perf_counter() - begin
    seconds = np.median([each.seconds for each in results])
    print(
        f"{len(results)} drivers of seed {options.seed}, 8 km of manual driving each: "
        f"{took:.0f} s with {options.jobs} threads, {seconds:.1f} s a fit"
    )
    print_recovery(results)
    print_information(options.seed)


if __name__ == "__main__":
    main()
