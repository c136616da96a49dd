"""The inconsistency threshold when path and plan differ in duration.

    python -m benchmarks.threshold

`costeer drivers --threshold` gives the system's path the duration that the pilot
driver plans for this very lane change. Here the same drivers are driven once so, and
once with a path of the driver's median duration, about which single changes scatter.
"""

from __future__ import annotations

import numpy as np

from costeer.loop.scenario import TrialSetup, trial_driver
from costeer.study.jobs import default_jobs, run_jobs
from costeer.validation.pilot import FACTOR, PERCENTILE, opposed_gaps, pilot_setups

NUM_DRIVERS = 30


def with_median_duration(setup: TrialSetup) -> TrialSetup:
    """The trial with a path of the driver's median duration for every change."""
    if not setup.follows_plan:
        return setup
    duration = trial_driver(setup).decision.change_duration
    return setup._replace(
        follows_plan=False,
        change_duration=duration,
        prediction_horizon=duration / 2.0,
    )


def threshold(setups: list[TrialSetup]) -> float:
    """δ of these agreeing runs [W]."""
    gaps = run_jobs(opposed_gaps, setups, default_jobs(), lambda _: None)
    return FACTOR * float(np.percentile(np.concatenate(gaps), PERCENTILE))


def main() -> None:
    """Print the threshold both ways."""
    setups = pilot_setups(NUM_DRIVERS)
    print(f"path of this change's own duration: {threshold(setups):.4f} W")
    medians = [with_median_duration(setup) for setup in setups]
    print(f"path of the driver's median duration: {threshold(medians):.4f} W")


if __name__ == "__main__":
    main()
