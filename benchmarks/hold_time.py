"""What a hold time on the verdict of Table III would change, on pilot drivers.

    python benchmarks/hold_time.py

Literal Table III may flip when a torque crosses zero, and each flip restarts the fade
of Eqs. (10) and (11). Pilot drivers drive the six assisted conditions with hold times
of 0 and 0.2 s; only inconsistencies are looked at, no measure of section 5 of the
study. They are no participants of any study.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from costeer.controller.actuation import STRONG, WEAK
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies
from costeer.validation.pilot import PILOT_SEED

NUM_DRIVERS = 12
HOLD_TIMES = (0.0, 0.2)
DURATIONS = (4.0, 6.0, 8.0)


def setups(hold_time: float) -> list[TrialSetup]:
    """Trials of all pilot drivers with one hold time."""
    return [
        TrialSetup(
            participant=participant,
            seed=PILOT_SEED,
            condition=f"pilot-hold-{strength}-{duration}",
            strength_factor=strength,
            change_duration=duration,
            intention="scripted",
            hold_time=hold_time,
        )
        for participant in range(1, NUM_DRIVERS + 1)
        for strength in (STRONG, WEAK)
        for duration in DURATIONS
    ]


def inconsistencies(setup: TrialSetup) -> tuple[Inconsistency, ...]:
    """Those of one trial."""
    found = find_inconsistencies(simulate_trial(setup).columns)
    if isinstance(found, str):
        raise ValueError(found)
    return found


def main() -> None:
    """Print one row per hold time."""
    print(f"{NUM_DRIVERS} pilot drivers, six assisted conditions, scripted intention")
    print("hold [s]  number  flips each  frozen [s]  median recovery [s]  least gain")
    for hold_time in HOLD_TIMES:
        with ThreadPoolExecutor(2) as pool:
            trials = pool.map(inconsistencies, setups(hold_time))
        found = [each for trial in trials for each in trial]
        flips = np.mean([each.num_flips for each in found])
        frozen = np.mean([each.frozen_time for each in found])
        recovery = np.nanmedian([each.recovery_time for each in found])
        gain = min(each.gain_minimum for each in found)
        print(
            f"{hold_time:8.1f}  {len(found):6d}  {flips:10.2f}  {frozen:10.2f}"
            f"  {recovery:19.2f}  {gain:10.3f}"
        )


if __name__ == "__main__":
    main()
