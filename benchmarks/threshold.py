"""The inconsistency threshold with and without a driver's scatter of durations.

    python benchmarks/threshold.py

`costeer drivers --threshold` lets each pilot lane change scatter about the driver's
median planned duration, which is the path's. Here the same runs are made once as they
are and once without that scatter, so that path and plan have the same duration.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from costeer.loop.noise import driver_noise
from costeer.loop.rollout import Script, rollout
from costeer.loop.rows import ROW_COLUMNS
from costeer.loop.scenario import INTENTIONS, TrialSetup, loop_parameters
from costeer.loop.step import DT, LoopParameters
from costeer.loop.trial import SLOWEST_SHARE, idle_weights, network_memory
from costeer.validation.pilot import FACTOR, PERCENTILE, agreeing_setups

NUM_DRIVERS = 30


def without_scatter(parameters: LoopParameters) -> LoopParameters:
    """The trial with every planned duration at the driver's median."""
    driver = parameters.driver
    decision = driver.decision._replace(change_duration_spread=0.0)
    return parameters._replace(driver=driver._replace(decision=decision))


def gaps(setup: TrialSetup, scatter: bool) -> NDArray[np.float64]:
    """|W_hapi - W_dr| where the torques oppose, shape `(sample,)` [W]."""
    parameters = loop_parameters(setup)
    weights = idle_weights()
    steps = int(np.ceil(setup.length / (SLOWEST_SHARE * setup.speed) / DT))
    noise = driver_noise(setup.seed, setup.participant, setup.condition, steps)
    rows = rollout(
        parameters if scatter else without_scatter(parameters),
        Script(INTENTIONS[setup.intention], setup.prediction_horizon, np.zeros(0)),
        weights,
        network_memory(weights),
        noise,
        "numba",
    )
    guidance, driver, agreement = (
        rows[:, ROW_COLUMNS.index(name)]
        for name in ("guidance_pseudo_work", "driver_pseudo_work", "torque_agreement")
    )
    gap = np.abs(guidance - driver)
    return np.asarray(gap[(agreement < 0.0) & np.isfinite(gap)])


def main() -> None:
    """Print the threshold both ways."""
    setups = [s for n in range(1, NUM_DRIVERS + 1) for s in agreeing_setups(n)]
    for scatter in (True, False):
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(lambda s, on=scatter: gaps(s, on), setups))
        threshold = FACTOR * float(np.percentile(np.concatenate(found), PERCENTILE))
        print(f"{'with' if scatter else 'without'} scatter: {threshold:.4f} W")


if __name__ == "__main__":
    main()
