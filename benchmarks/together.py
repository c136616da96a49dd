"""How fast trials are driven eight at a time, and alone.

Run: `python -m benchmarks.together [TRIALS]`

Whole trials of 8 km with their records, without tables, in two threads. The two ways
take turns, so that what else the machine does meets both; medians, least and most.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from costeer.base.lanes import WIDTH
from costeer.loop.scenario import TrialSetup
from costeer.loop.together import simulate_together
from costeer.loop.trial import simulate_trial, trial_duration
from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.columns import TrialRecord

ROUNDS = 5


def setups(count: int, intention: str) -> list[TrialSetup]:
    """The trials of a study, driver after driver, each in all conditions."""
    return [
        TrialSetup(
            participant=1 + number // len(CONDITION_NAMES),
            condition=CONDITION_NAMES[number % len(CONDITION_NAMES)],
            intention=intention,
        )
        for number in range(count)
    ]


def _alone(trials: Sequence[TrialSetup]) -> float:
    return sum(trial_duration(simulate_trial(each)) for each in trials)


def _together(trials: Sequence[TrialSetup]) -> float:
    made = simulate_together(trials)
    return sum(trial_duration(r) for r in made if isinstance(r, TrialRecord))


def speed(
    drive: Callable[[Any], float], trials: list[TrialSetup], threads: int
) -> float:
    """Driver-seconds per second [-]."""
    blocks = [trials[k : k + WIDTH] for k in range(0, len(trials), WIDTH)]
    begun = time.perf_counter()
    with ThreadPoolExecutor(threads) as pool:
        driven = sum(pool.map(drive, blocks))
    return driven / (time.perf_counter() - begun)


def main() -> None:
    """Print speeds and their ratio."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 48
    for intention in ("scripted", "network"):
        trials = setups(count, intention)
        for drive in (_alone, _together):
            drive(trials[:WIDTH])  # compiled by then
        found: dict[str, list[float]] = {"alone": [], "together": []}
        for _ in range(ROUNDS):
            found["alone"].append(speed(_alone, trials, 2))
            found["together"].append(speed(_together, trials, 2))
        for name, speeds in found.items():
            print(
                f"{intention}, {name}: {statistics.median(speeds):,.0f} driver-s/s "
                f"({min(speeds):,.0f} to {max(speeds):,.0f})"
            )
        pairs = zip(found["together"], found["alone"], strict=True)
        ratios = [one / other for one, other in pairs]
        print(
            f"{intention}, ratio in turn: {statistics.median(ratios):.2f}", flush=True
        )


if __name__ == "__main__":
    main()
