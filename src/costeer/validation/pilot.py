"""Pilot drivers: the inconsistency threshold δ from runs in which nobody disagrees.

Pilot drivers have seeds of their own and are no participants of any study. Only the
gap of the two pseudo-works is looked at here, no measure of the study.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller.actuation import STRONG, WEAK
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.scale.jobs import JobsStoppedError, run_jobs

UNDISPUTED = (("consistency.inconsistency_threshold", 100.0),)
"""A threshold that no run reaches, so that the gain stays full [W]."""

PERCENTILE = 99.9
FACTOR = 2.0
"""δ is this many times that percentile of the gap in agreeing runs."""


class PilotResult(NamedTuple):
    """What the pilot runs gave.

    Attributes:
        num_drivers: Pilot drivers.
        num_samples: Samples with opposed torques, S_c < 0.
        percentile: 99.9th percentile of the gap among them [W].
        threshold: δ, twice that [W].
    """

    num_drivers: int
    num_samples: int
    percentile: Real
    threshold: Real


def agreeing_setups(participant: int) -> list[TrialSetup]:
    """Trials of one pilot driver in which driver and system want the same.

    Lane keeping without leaders, and lane changes whose path begins when the driver
    does and has the duration that the driver plans for this one, strong and weak.
    """
    setups = []
    for strength in (STRONG, WEAK):
        keeping = TrialSetup(
            participant=participant,
            seed=PILOT_SEED,
            condition=f"pilot-keeping-{strength}",
            strength_factor=strength,
            intention="off",
            events=False,
            parameters=UNDISPUTED,
        )
        changing = keeping._replace(
            condition=f"pilot-changing-{strength}",
            intention="scripted",
            follows_plan=True,
            events=True,
        )
        setups += [keeping, changing]
    return setups


def opposed_gaps(setup: TrialSetup) -> NDArray[np.float64]:
    """|W_hapi - W_dr| of a run where the torques oppose, shape `(sample,)` [W]."""
    columns = simulate_trial(setup).columns
    gap = np.abs(columns["guidance_pseudo_work"] - columns["driver_pseudo_work"])
    opposed = (columns["torque_agreement"] < 0.0) & np.isfinite(gap)
    return np.asarray(gap[opposed])


def pilot_setups(num_drivers: int) -> list[TrialSetup]:
    """Trials of all pilot drivers, in order."""
    return [s for n in range(1, num_drivers + 1) for s in agreeing_setups(n)]


def pilot_threshold(
    num_drivers: int,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
) -> PilotResult:
    """Run the pilot drivers and compute δ.

    Args:
        num_drivers: How many pilot drivers.
        jobs: Threads.
        progress: Called with the number of trials just done.
    """
    try:
        gaps = run_jobs(
            opposed_gaps,
            pilot_setups(num_drivers),
            jobs,
            lambda _: progress(1) if progress is not None else None,
        )
    except JobsStoppedError as stopped:
        raise (stopped.__cause__ or stopped) from None
    every = np.concatenate(gaps)
    percentile = float(np.percentile(every, PERCENTILE))
    return PilotResult(num_drivers, len(every), percentile, FACTOR * percentile)
