r"""How the shipped network does in scenarios that it was not trained on.

On roads with more than two lanes the network is asked for both sides; crossings to the
one that is not the usual, that of overtaking, are counted apart too.

    python -m benchmarks.intention_scenarios --drivers 20
    python -m benchmarks.intention_scenarios --drivers 40 --seed 8 \
        --scenarios expressway,expressway-curves
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import speed_of
from costeer.scenarios.reading import scenario_named
from costeer.study.crossings import Crossing, within
from costeer.study.detection import FALSE, Detection, detect, lead_time
from costeer.study.lanes import adjacent_side
from costeer.study.measures import prepared
from costeer.study.segments import LaneChange
from costeer.study.trial_measures import Trial as MeasuredTrial
from costeer.training.bootstrap import resamplings

SCENARIOS = ("expressway", "dense-traffic", "three-lanes", "expressway-curves")
CONDITIONS = ("manual", "strong-normal")
SEED = 5
"""Of drivers that were neither trained on nor judged elsewhere."""


class Trial(NamedTuple):
    """A drive.

    Attributes:
        scenario: Its name.
        condition: Of the study.
        participant: Number of the driver.
        seed: Of the drivers.
    """

    scenario: str
    condition: str
    participant: int
    seed: int = SEED


class Found(NamedTuple):
    """What the triggers of trials were worth.

    Attributes:
        facing: Lead time of each intended crossing to the usual side [s]; 0 if missed.
        away: The same of those to the other side [s].
        facing_torque: Peak driver torque in each lane change to the usual side [N·m].
        away_torque: The same to the other side [N·m].
        num_false: False triggers.
        num_collisions: Trials that ended in one.
        kilometres: Driven [km].
    """

    facing: tuple[float, ...] = ()
    away: tuple[float, ...] = ()
    facing_torque: tuple[float, ...] = ()
    away_torque: tuple[float, ...] = ()
    num_false: int = 0
    num_collisions: int = 0
    kilometres: float = 0.0


def driven(trial: Trial) -> TrialRecord:
    """The record of one trial of 8 km, at the scenario's own speed."""
    return simulate_trial(
        TrialSetup(
            participant=trial.participant,
            seed=trial.seed,
            condition=trial.condition,
            scenario=trial.scenario,
            speed=speed_of(scenario_named(trial.scenario).speed),
        )
    )


def is_faced(trial: MeasuredTrial, crossed: Crossing | LaneChange) -> bool:
    """Whether a crossing leads to the usual side."""
    before = crossed.lane - crossed.direction
    return adjacent_side(trial.parameters, before) == crossed.direction


def peak_torques(trial: MeasuredTrial) -> dict[bool, list[float]]:
    """Peak driver torque of lane changes [N·m], by whether their side is the usual."""
    found: dict[bool, list[float]] = {True: [], False: []}
    time, torque = trial.columns["time"], np.abs(trial.columns["driver_torque"])
    changes = () if isinstance(trial.segments, str) else trial.segments.changes
    for change in changes:
        rows = within(time, change.start_time, change.end_time)
        found[is_faced(trial, change)].append(float(torque[rows].max()))
    return found


def judged(record: TrialRecord) -> Found:
    """What the triggers of a record were worth.

    Raises:
        ValueError: If they cannot be judged.
    """
    trial = prepared(record)
    found = detect(trial.columns, trial.parameters)
    if not isinstance(found, Detection):
        raise ValueError(found)
    leads: dict[bool, list[float]] = {True: [], False: []}
    for crossing in found.crossings:
        facing = is_faced(trial, crossing)
        leads[facing].append(lead_time(found, crossing.time))
    torques = peak_torques(trial)
    false = [each.time for each in found.triggers if each.verdict == FALSE]
    position = record.columns["longitudinal_position"]
    return Found(
        facing=tuple(leads[True]),
        away=tuple(leads[False]),
        facing_torque=tuple(torques[True]),
        away_torque=tuple(torques[False]),
        num_false=len(false),
        num_collisions=int((record.columns["contact"] >= 2).any()),
        kilometres=float(position[-1] - position[0]) / 1000.0,
    )


def judged_trial(trial: Trial) -> Found:
    """Drive a trial and judge its triggers."""
    return judged(driven(trial))


def total(parts: Sequence[Found]) -> Found:
    """The sum of several trials."""
    return Found(
        facing=tuple(lead for each in parts for lead in each.facing),
        away=tuple(lead for each in parts for lead in each.away),
        facing_torque=tuple(peak for each in parts for peak in each.facing_torque),
        away_torque=tuple(peak for each in parts for peak in each.away_torque),
        num_false=sum(each.num_false for each in parts),
        num_collisions=sum(each.num_collisions for each in parts),
        kilometres=sum(each.kilometres for each in parts),
    )


HEAD = (
    "| scenario | condition | crossings | missed | of those to the other side | lead | "
    "false per km | peak torque, usual side | other side | collisions |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


def interval(parts: Sequence[Found]) -> tuple[float, float]:
    """False triggers per km, 95 % of a bootstrap over the drivers [1/km]."""
    times = resamplings(len(parts), 1000, 1)
    false = times @ np.array([each.num_false for each in parts])
    driven = times @ np.array([each.kilometres for each in parts])
    low, high = np.percentile(false / driven, [2.5, 97.5])
    return float(low), float(high)


def _median(values: Sequence[float] | NDArray[np.float64], unit: str) -> str:
    return f"{np.median(values):.2f} {unit}" if len(values) else "–"


def row(scenario: str, condition: str, parts: Sequence[Found]) -> str:
    """A row of the table; leads are of announced crossings, values are medians.

    Args:
        scenario: Its name.
        condition: Of the study.
        parts: Of each driver.
    """
    found, (low, high) = total(parts), interval(parts)
    away, every = np.array(found.away), np.array([*found.facing, *found.away])
    missed = int((every == 0.0).sum())
    cells = (
        scenario,
        condition,
        f"{every.size}",
        f"{missed} ({missed / every.size:.0%})",
        f"{int((away == 0.0).sum())} of {away.size}",
        _median(every[every > 0.0], "s"),
        f"{found.num_false / found.kilometres:.3f} ({low:.3f} to {high:.3f})",
        _median(found.facing_torque, "N·m"),
        _median(found.away_torque, "N·m"),
        f"{found.num_collisions}",
    )
    return f"| {' | '.join(cells)} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Drive all trials and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drivers", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--scenarios", default=",".join(SCENARIOS))
    given = parser.parse_args(arguments)
    groups = list(product(given.scenarios.split(","), CONDITIONS))
    people = range(1, given.drivers + 1)
    print(HEAD)
    with ProcessPoolExecutor(given.jobs) as pool:
        for scenario, condition in groups:
            trials = [Trial(scenario, condition, n, given.seed) for n in people]
            found = list(pool.map(judged_trial, trials))
            print(row(scenario, condition, found), flush=True)


if __name__ == "__main__":
    main()
