"""What a hold time and a hands-on threshold change in the verdict of Table III.

    python -m benchmarks.hold_time

Literal Table III may flip when a torque crosses zero, and each flip restarts the fade
of Eqs. (10) and (11). Pilot drivers drive the six assisted conditions with hold times
of 0 and 0.2 s, and hands-on thresholds of 0 (Table III as printed) and 0.1 N·m; the
share of samples whose instruction is over the motor's limit says what saturating it in
Eqs. (7) and (9) could change. Only inconsistencies are looked at, no measure of section
5 of the study. They are no participants of any study.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.controller.actuation import STRONG, WEAK, ActuationParameters
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies

NUM_DRIVERS = 12
VARIANTS = ((0.0, 0.0), (0.2, 0.0), (0.0, 0.1), (0.2, 0.1))
"""Hold time [s] and hands-on threshold [N·m]."""
DURATIONS = (4.0, 6.0, 8.0)
SHORT = 30
"""A stay in lane changing below this is no plan that anyone followed [samples]."""


def setups(hold_time: float, threshold: float) -> list[TrialSetup]:
    """Trials of all pilot drivers with one hold time and hands-on threshold."""
    return [
        TrialSetup(
            participant=participant,
            seed=PILOT_SEED,
            condition=f"pilot-hold-{strength}-{duration}",
            strength_factor=strength,
            change_duration=duration,
            intention="scripted",
            parameters=(
                ("consistency.hold_time", hold_time),
                ("consistency.hands_on_threshold", threshold),
            ),
        )
        for participant in range(1, NUM_DRIVERS + 1)
        for strength in (STRONG, WEAK)
        for duration in DURATIONS
    ]


class Seen(NamedTuple):
    """What one trial shows.

    Attributes:
        inconsistencies: Of the trial.
        stays: How long each stay in lane changing was [samples].
        top_gain: Largest haptic gain in the short ones, 0 without any [-].
        over_limit: Share of samples whose instruction is over the motor's limit [-].
    """

    inconsistencies: tuple[Inconsistency, ...]
    stays: NDArray[np.int64]
    top_gain: float
    over_limit: float


def seen(setup: TrialSetup) -> Seen:
    """Inconsistencies and stays in lane changing of one trial."""
    columns = simulate_trial(setup).columns
    found = find_inconsistencies(columns)
    if isinstance(found, str):
        raise ValueError(found)
    changing = np.concatenate([[False], columns["mode"] == "lane_changing", [False]])
    begins, ends = np.flatnonzero(np.diff(changing)).reshape(-1, 2).T
    gains = [
        float(columns["haptic_gain"][a:b].max())
        for a, b in zip(begins, ends, strict=True)
        if b - a < SHORT
    ]
    over = np.abs(columns["instructed_torque"]) > ActuationParameters().torque_limit
    return Seen(found, ends - begins, max(gains, default=0.0), float(over.mean()))


def main() -> None:
    """Print one row per variant."""
    print(f"{NUM_DRIVERS} pilot drivers, six assisted conditions, scripted intention")
    print(
        "hold [s]  hands on [N·m]  number  flips each  frozen [s]  "
        "median recovery [s]  least gain"
    )
    short = []
    for hold_time, threshold in VARIANTS:
        with ThreadPoolExecutor(2) as pool:
            trials = list(pool.map(seen, setups(hold_time, threshold)))
        found = [each for trial in trials for each in trial.inconsistencies]
        stays = np.concatenate([trial.stays for trial in trials])
        brief = stays[stays < SHORT]
        short.append(
            f"hold {hold_time:.1f} s, {threshold:.1f} N·m: {len(brief)} of "
            f"{len(stays)} stays in lane changing under {SHORT} samples, longest "
            f"{max(brief, default=0)}, gain there at most "
            f"{max(trial.top_gain for trial in trials):.3f}; instruction over the "
            f"limit in {np.mean([t.over_limit for t in trials]):.5%} of samples"
        )
        flips = np.mean([each.num_flips for each in found])
        frozen = np.mean([each.frozen_time for each in found])
        recovery = np.nanmedian([each.recovery_time for each in found])
        gain = min(each.gain_minimum for each in found)
        print(
            f"{hold_time:8.1f}  {threshold:14.1f}  {len(found):6d}  {flips:10.2f}"
            f"  {frozen:10.2f}  {recovery:19.2f}  {gain:10.3f}"
        )
    print("\n".join(short))


if __name__ == "__main__":
    main()
