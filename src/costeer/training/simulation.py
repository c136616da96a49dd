"""Manual trials of virtual drivers, to learn from and to judge with.

Drives to learn intention from hold more than a study: other speeds, lane changes that
are given up, drivers who drift towards the line. The drivers themselves are those of
the frozen population, with numbers that no study has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.scale.jobs import JobsStoppedError, Pool, run_jobs
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import chosen
from costeer.training.recordings import Recording, recordings_of

FIRST_PARTICIPANT = 100_001
"""Number of the first simulated driver; those of studies count from 1."""

SPEEDS_KMH = (70.0, 60.0, 80.0, 70.0, 90.0, 50.0, 70.0, 100.0)
"""Suggested speeds that simulated drivers take in turn [km/h]; studies drive 70."""

WANDER_FACTORS = (1.0, 1.0, 1.5, 1.0, 2.0)
"""Wander in the lane over that of the population, in turn [-]: two in five drivers
drift towards the line without a thought of changing. Source: assumed."""

ABANDONED_SHARE = 0.05
"""Share of lane changes that drivers give up [-]. Source: assumed, as in traffic that
hides a car now and then."""

FIRST_UNSEEN = 300_001
"""Number of the first simulated driver to judge with."""


def manual_setup(participant: int, seed: int, place: int, trial: int = 0) -> TrialSetup:
    """A manual trial as those that the network is trained on.

    Args:
        participant: Number of the driver.
        seed: Of the population and of all noise.
        place: Of the driver, which picks speed and wander.
        trial: Of this driver, counted from 1; other numbers are other drives. 0 if
            there is one only.
    """
    return TrialSetup(
        participant=participant,
        seed=seed,
        condition=f"manual-{trial}" if trial else "manual",
        strength_factor=0.0,
        speed=SPEEDS_KMH[(place + max(trial - 1, 0)) % len(SPEEDS_KMH)] / 3.6,
        intention="off",
        abandoned_share=ABANDONED_SHARE,
        wander_factor=WANDER_FACTORS[place % len(WANDER_FACTORS)],
    )


def simulate_setups(
    setups: Sequence[TrialSetup],
    jobs: Pool = 1,
    progress: Callable[[int], None] | None = None,
) -> list[Recording]:
    """Recordings of manual trials, in their order.

    Args:
        setups: Of the trials.
        jobs: Threads, or the workers of a cluster.
        progress: Told after each trial.

    Raises:
        BaseException: What stopped a trial, as the trial raised it.
    """

    def told(_: list[Recording]) -> None:
        if progress:
            progress(1)

    try:
        found = run_jobs(recorded, setups, jobs, told)
    except JobsStoppedError as stopped:
        raise (stopped.__cause__ or stopped) from None
    return [recording for each in found for recording in each]


def recorded(setup: TrialSetup) -> list[Recording]:
    """One trial, as recordings to learn from or to judge with."""
    name = f"simulated driver {setup.participant} {setup.condition}"
    return recordings_of(simulate_trial(setup), name)


def simulate_recordings(
    num_drivers: int,
    seed: int,
    jobs: Pool = 1,
    progress: Callable[[int], None] | None = None,
    first: int = FIRST_PARTICIPANT,
    scenario: str | Scenario | None = None,
) -> list[Recording]:
    """Manual trials, one each, of other drivers than any study.

    Args:
        num_drivers: How many.
        seed: Of the population and of all noise.
        jobs: Threads, or the workers of a cluster.
        progress: Told after each trial.
        first: Number of the first driver: those from `FIRST_PARTICIPANT` on are to
            learn from, those from `FIRST_UNSEEN` on are in no training.
        scenario: Driven in, at its own length and speed; None for the published road
            at `SPEEDS_KMH`.

    Raises:
        ValueError: If there is no such scenario.
        OSError: If its file cannot be read.
    """
    setups = [manual_setup(first + i, seed, i) for i in range(num_drivers)]
    if scenario is not None:
        there = chosen(scenario, None, None)
        setups = [
            each._replace(
                scenario=there.scenario, length=there.length, speed=there.speed
            )
            for each in setups
        ]
    return simulate_setups(setups, jobs, progress)
