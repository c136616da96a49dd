"""The inconsistency threshold when path and plan differ in duration.

    python -m benchmarks.threshold

`costeer drivers --threshold` gives the system's path the duration that the pilot
driver plans for this very lane change. Here the same drivers are driven once so, and
once with a path of the driver's median duration, about which single changes scatter.
Then δ of those opposed samples alone in which the driver pushes, and the largest
instruction of these runs: whether the hands-on threshold or a saturated instruction
would change δ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.loop.parameters import DT
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_driver
from costeer.loop.trial import simulate_trial
from costeer.scale.jobs import default_jobs, run_jobs
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


def pushing(setup: TrialSetup) -> tuple[NDArray[np.float64], float]:
    """Gaps [W] where the driver pushes against the guidance; largest instruction [N·m].

    Args:
        setup: Of an agreeing run.
    """
    parameters = loop_parameters(setup).controller
    columns = simulate_trial(setup).columns
    angle, rate = columns["steering_wheel_angle"], columns["steering_wheel_rate"]
    arms, torque = parameters.hands, columns["driver_torque"]
    carried = arms.inertia * np.diff(rate) + arms.damping * np.diff(angle)
    own = torque + np.append(0.0, carried / DT)
    least = parameters.consistency.hands_on_threshold
    gap = np.abs(columns["guidance_pseudo_work"] - columns["driver_pseudo_work"])
    counted = (columns["torque_agreement"] < 0.0) & np.isfinite(gap)
    counted &= (np.abs(torque) >= least) & (np.abs(own) >= least)
    return gap[counted], float(np.abs(columns["instructed_torque"]).max())


def main() -> None:
    """Print the threshold both ways."""
    setups = pilot_setups(NUM_DRIVERS)
    print(f"path of this change's own duration: {threshold(setups):.4f} W")
    medians = [with_median_duration(setup) for setup in setups]
    print(f"path of the driver's median duration: {threshold(medians):.4f} W")
    found = run_jobs(pushing, setups, default_jobs(), lambda _: None)
    gaps = np.concatenate([gap for gap, _ in found])
    print(f"while the driver pushes: {FACTOR * np.percentile(gaps, PERCENTILE):.4f} W")
    print(f"largest instruction: {max(most for _, most in found):.2f} N·m")


if __name__ == "__main__":
    main()
