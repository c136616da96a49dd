"""How the shipped network does in scenarios that it was not trained on.

The network looks to one side at a time: with lanes on both sides to that of overtaking.
Crossings to the other side cannot be announced; they are counted apart.

    python -m benchmarks.intention_scenarios --drivers 20
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import NamedTuple

import numpy as np

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.records.columns import TrialRecord
from costeer.scenarios.reading import scenario_named, speed_of
from costeer.study.detection import FALSE, Detection, count, detect, lead_time
from costeer.study.lanes import adjacent_side
from costeer.study.measures import prepared

SCENARIOS = ("expressway", "dense-traffic", "three-lanes")
CONDITIONS = ("manual", "strong-normal")
SEED = 5
"""Of drivers that were neither trained on nor judged elsewhere."""

Trial = tuple[str, str, int]
"""Scenario, condition and number of the driver."""


class Found(NamedTuple):
    """What the triggers of trials were worth.

    Attributes:
        facing: Lead time of each intended crossing to the side that the network looks
            to [s]; 0 if missed.
        away: The same of those to the other side [s].
        num_false: False triggers.
        num_contacts: Trials that ended in a collision.
        kilometres: Driven [km].
    """

    facing: tuple[float, ...] = ()
    away: tuple[float, ...] = ()
    num_false: int = 0
    num_contacts: int = 0
    kilometres: float = 0.0


def driven(trial: Trial) -> TrialRecord:
    """The record of one trial of 8 km, at the scenario's own speed."""
    scenario, condition, participant = trial
    return simulate_trial(
        TrialSetup(
            participant=participant,
            seed=SEED,
            condition=condition,
            scenario=scenario,
            speed=speed_of(scenario_named(scenario).speed),
        )
    )


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
        before = crossing.lane - crossing.direction
        facing = adjacent_side(trial.parameters, before) == crossing.direction
        leads[facing].append(lead_time(found, crossing.time))
    position = record.columns["longitudinal_position"]
    return Found(
        facing=tuple(leads[True]),
        away=tuple(leads[False]),
        num_false=count(found, FALSE),
        num_contacts=int((record.columns["contact"] >= 2).any()),
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
        num_false=sum(each.num_false for each in parts),
        num_contacts=sum(each.num_contacts for each in parts),
        kilometres=sum(each.kilometres for each in parts),
    )


HEAD = (
    "| scenario | condition | crossings | missed | of them to the side looked to | "
    "lead, median | false per km | collisions |\n|---|---|---|---|---|---|---|---|"
)


def row(scenario: str, condition: str, found: Found) -> str:
    """A row of the table; the lead is of crossings to the side looked to."""
    facing, every = np.array(found.facing), np.array([*found.facing, *found.away])
    missed, seen = int((every == 0.0).sum()), facing[facing > 0.0]
    cells = (
        scenario,
        condition,
        f"{every.size}",
        f"{missed} ({missed / every.size:.0%})",
        f"{int((facing == 0.0).sum())} of {facing.size}",
        f"{np.median(seen):.2f} s" if seen.size else "–",
        f"{found.num_false / found.kilometres:.3f}",
        f"{found.num_contacts}",
    )
    return f"| {' | '.join(cells)} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Drive all trials and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drivers", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args(arguments)
    groups = list(product(SCENARIOS, CONDITIONS))
    people = range(1, given.drivers + 1)
    print(HEAD)
    with ProcessPoolExecutor(given.jobs) as pool:
        for scenario, condition in groups:
            trials = [(scenario, condition, number) for number in people]
            found = total(list(pool.map(judged_trial, trials)))
            print(row(scenario, condition, found), flush=True)


if __name__ == "__main__":
    main()
