"""All that a validation report stands on: simulated once, then only read."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import NamedTuple

from costeer.drivers.population import USUAL, Population, participant_driver
from costeer.loop.scenario import PILOT_SEED
from costeer.validation.arms import ArmTest, arm_tests
from costeer.validation.departures import (
    Departures,
    LaneHold,
    departures,
    lane_hold,
)
from costeer.validation.drawn import drawn_drivers
from costeer.validation.drawn_figure import Drawn
from costeer.validation.manual import (
    AGAIN,
    ManualDriving,
    Row,
    drive_population,
    gathered,
    manual_record,
    measured,
)
from costeer.validation.people.compare import (
    Spectra,
    compare_real,
    drift_spectra,
)
from costeer.validation.people.findings import RealComparison
from costeer.validation.people.observe import Observations, observe
from costeer.validation.people.onset import OnsetTest, onset_test
from costeer.validation.resistance import CHANGE_DURATIONS, SYSTEMS, Resistance, resist
from costeer.validation.spread import TargetSpread, target_spreads
from costeer.validation.stability import Stability, driver_stability
from costeer.validation.threads import in_threads

Stage = Callable[[str, int], AbstractContextManager[Callable[[int], None]]]
"""Shows the progress of so many pieces of something."""

SPEED = 70.0 / 3.6
"""Suggested speed of manual driving and of the arms' drivers [m/s]."""

MOST_ONSETS = 40
"""Drivers whose answer to a heading error is tested: twice as many as people."""

STABLE_FOLD = 5
"""Drivers looked at for stability, per driver of manual driving: 1,000 of 200."""

MOST_PILOTS = 40
"""Pilot drivers who resist a wrong guidance."""

NUM_CELLS = len(CHANGE_DURATIONS) * len(SYSTEMS)
"""Kinds of wrong guidance."""


class Plan(NamedTuple):
    """What a report is asked for.

    Attributes:
        seed: Of the population.
        num_drivers: In manual driving.
        jobs: Threads.
        data: Folder with recordings of people; None for none.
        population: Who is drawn from.
    """

    seed: int
    num_drivers: int
    jobs: int
    data: Path | None
    population: Population = USUAL


class Evidence(NamedTuple):
    """All that was simulated and compared; None or empty is left out of the report.

    Attributes:
        drawn: The drivers, and of which population they are.
        driving: First manual trials.
        again: Second ones of the same drivers with other noise.
        spreads: Of all targets.
        departures: From the lane in the first trials.
        people: Quantities of people beside the drivers'.
        spectra: Of the drift in the lane.
        num_onsets: Drivers tested for their answer to a heading error.
        arms: Tests of the arms.
        resistance: Of pilot drivers against a wrong guidance.
        stability: Of more drivers.
    """

    drawn: Drawn
    driving: ManualDriving
    again: ManualDriving
    spreads: list[TargetSpread]
    departures: Departures | None
    people: list[RealComparison]
    spectra: Spectra | None
    num_onsets: int
    arms: list[ArmTest]
    resistance: list[Resistance]
    stability: Stability | None


def gather(plan: Plan, stage: Stage) -> Evidence:
    """Simulate and compare all that the report stands on.

    The recordings of people are read first, so that one that cannot be read is told
    at once.

    Args:
        plan: What is asked for.
        stage: Shows the progress of each part.

    Raises:
        ValueError: If recordings of people are there and cannot be read.
    """
    compare_real([], [], plan.data)
    trials = _first_trials(plan, stage)
    driving = gathered([(t.row, t.changes) for t in trials], plan.population)
    observations = [each.observations for each in trials]
    with stage("manual trials again", plan.num_drivers) as advance:
        again = drive_population(
            plan.seed, plan.num_drivers, plan.jobs, advance, AGAIN, plan.population
        )
    onsets = _onsets(plan, stage)
    drawn = drawn_drivers(plan.seed, plan.num_drivers, SPEED, plan.population)
    return Evidence(
        drawn=Drawn(plan.seed, drawn, plan.population),
        driving=driving,
        again=again,
        spreads=target_spreads(driving, again),
        departures=departures([each.hold for each in trials]),
        people=compare_real(observations, onsets, plan.data, plan.population.domain),
        spectra=drift_spectra(observations, plan.data),
        num_onsets=len(onsets),
        arms=_arms(plan, stage),
        resistance=_resistance(plan, stage),
        stability=_stability(plan, stage),
    )


class _Trial(NamedTuple):
    """What is kept of a manual trial.

    Attributes:
        row: Of the table of trials.
        changes: Rows of its lane changes.
        observations: What is compared with people.
        hold: How the driver held the lane.
    """

    row: Row
    changes: list[Row]
    observations: Observations
    hold: LaneHold


def _first_trials(plan: Plan, stage: Stage) -> list[_Trial]:
    """Manual driving of all drivers."""

    def driven(participant: int) -> _Trial:
        record = manual_record(plan.seed, participant, population=plan.population)
        row, changes = measured(record)
        return _Trial(row, changes, observe(record, changes), lane_hold(record))

    numbers = range(1, plan.num_drivers + 1)
    with stage("manual trials", plan.num_drivers) as advance:
        return in_threads(driven, numbers, plan.jobs, advance)


def _onsets(plan: Plan, stage: Stage) -> list[OnsetTest]:
    """Corrections of a heading error, in plain Python and therefore by a few."""
    amount = min(plan.num_drivers, MOST_ONSETS)
    with stage("corrections", amount) as advance:
        return in_threads(
            lambda number: onset_test(plan.seed, number, population=plan.population),
            range(1, amount + 1),
            plan.jobs,
            advance,
        )


def _arms(plan: Plan, stage: Stage) -> list[ArmTest]:
    """The arms of the drivers of manual driving."""
    drivers = [
        participant_driver(plan.seed, number, SPEED, plan.population)
        for number in range(1, plan.num_drivers + 1)
    ]
    with stage("arms", 1) as advance:
        tests = arm_tests(drivers)
        advance(1)
    return tests


def _resistance(plan: Plan, stage: Stage) -> list[Resistance]:
    """Pilot drivers against a wrong guidance: no driver of a study is looked at."""
    amount = min(plan.num_drivers, MOST_PILOTS)
    with stage("wrong guidance", NUM_CELLS * amount) as advance:
        return resist(PILOT_SEED, amount, plan.jobs, advance, plan.population)


def _stability(plan: Plan, stage: Stage) -> Stability:
    amount = STABLE_FOLD * plan.num_drivers
    with stage("stability", amount) as advance:
        return driver_stability(
            plan.seed, amount, plan.jobs, advance, population=plan.population
        )
