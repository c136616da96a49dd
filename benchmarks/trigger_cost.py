"""What false and missed triggers cost, provoked over a population of drivers.

    python -m benchmarks.trigger_cost [--drivers 48] [--seed 3001] [--jobs 2]

Prints two tables in Markdown. False triggers: the system starts a lane change while the
driver keeps the lane, four trials each; beside the same seconds without it. Missed
crossings: the system never notices a lane change; beside the same drivers with every
change announced 3 s ahead by their own plan. Definitions: docs/measures.md. Nothing is
tuned on these results.

A good network gives a study too few of them to measure, so no network runs here. A
trial has one false trigger, because a system that was not followed may keep wanting
another lane.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.conditions import CONDITION_NAMES, MANUAL, condition
from costeer.pages.numerals import NOTHING, number
from costeer.study.definitions import DEFAULTS
from costeer.study.detection import FALSE
from costeer.study.trial_measures import Trial, prepare
from costeer.study.trigger_costs import COST_COLUMNS, costs, trigger_costs
from costeer.study.trigger_episodes import MISSED, Episode, episodes
from costeer.validation.resistance import TRIGGER_TIMES
from costeer.validation.threads import in_threads

Row = dict[str, object]
Columns = dict[str, NDArray[Any]]  # Any: as a record's

SEED = 3001
"""Of the drivers: of no study, no pilot run and no training."""

NUM_DRIVERS = 48

FALSE_TRIGGER = "false trigger"
NO_TRIGGER = "no trigger"
MISSED_CROSSING = "missed crossing"
ANNOUNCED_CROSSING = "announced crossing"
EVENTS = (FALSE_TRIGGER, NO_TRIGGER, MISSED_CROSSING, ANNOUNCED_CROSSING)
"""Each provoked event before what it is compared with."""

AFTERWARDS = 15.0
"""How long a trial goes on after the episode of its false trigger, to settle [s]."""

COURSE = 8000.0
"""Of the trials with lane changes, as long as the study's [m]."""

SHARES = ("wheel_over_line", "left_lane", "inconsistent", "replanned")
"""Costs that are true or false."""


class Provoked(NamedTuple):
    """The events of one kind in one condition, all drivers together.

    Attributes:
        condition: Name of the condition.
        event: One of `EVENTS`.
        num_events: How many.
        costs: By the names of `trigger_costs.COST_COLUMNS`, shape `(event,)`; NaN
            where a cost is not defined.
    """

    condition: str
    event: str
    num_events: int
    costs: dict[str, NDArray[np.float64]]


class Spread(NamedTuple):
    """One cost over the events that have it.

    Attributes:
        low: 10th percentile; NaN if no event has it, as the others.
        median: Half are below.
        high: 90th percentile.
        mean: The share of the events, if it is true or false.
        num_known: How many events have it.
    """

    low: Real
    median: Real
    high: Real
    mean: Real
    num_known: int


def trial_of(name: str, seed: int, participant: int) -> TrialSetup:
    """A trial in a condition whose system hears no intention.

    All conditions meet the same driver with the same noise.
    """
    chosen = condition(name)
    return TrialSetup(
        participant=participant,
        seed=seed,
        condition="provoked",
        strength_factor=chosen.strength_factor,
        change_duration=chosen.change_duration,
        method=MANUAL if name == MANUAL else TrialSetup().method,
        length=COURSE,
        intention="off",
    )


def falsely_triggered(name: str, seed: int, participant: int, trial: int) -> TrialSetup:
    """A trial on an empty road with one trigger that the driver does not want."""
    setup = trial_of(name, seed, participant)
    trigger = TRIGGER_TIMES[trial]
    # A driver may be a tenth slower or faster than the speed that is suggested.
    longest = 1.3 * (trigger + DEFAULTS.episode_duration + AFTERWARDS)
    return setup._replace(
        condition=f"provoked-{trial}",
        events=False,
        trigger_times=(trigger,),
        length=setup.speed * longest,
    )


def false_and_none(setup: TrialSetup) -> dict[str, list[Row]]:
    """Costs of the trial's false triggers, and of the same time without them."""
    triggered = _driven(setup)
    quiet = _driven(setup._replace(trigger_times=()))
    false = [each for each in _known(triggered) if each.kind == FALSE]
    return {
        FALSE_TRIGGER: [costs(triggered, each) for each in false],
        NO_TRIGGER: [costs(quiet, each) for each in false],
    }


def missed_and_announced(setup: TrialSetup) -> dict[str, list[Row]]:
    """Costs of the trial's lane changes, all missed and all announced."""
    told = trigger_costs(_driven(setup._replace(intention="scripted")))
    # One that was announced twice counts once, by its first trigger.
    first = {row["crossing_time"]: row for row in reversed(told)}
    known = [row for row in told if row["kind"] not in (FALSE, MISSED)]
    return {
        MISSED_CROSSING: trigger_costs(_driven(setup)),
        ANNOUNCED_CROSSING: [r for r in known if first[r["crossing_time"]] is r],
    }


def _driven(setup: TrialSetup) -> Trial:
    """The trial; where no intention is heard, as one whose inference stays silent."""
    columns: Columns = simulate_trial(setup).columns
    if setup.intention == "off":
        silent = np.zeros(len(columns["time"]))
        columns = {**columns, "crossing_probability": silent}
    return prepare(columns)


def _known(trial: Trial) -> tuple[Episode, ...]:
    found = episodes(trial)
    if isinstance(found, str):
        raise ValueError(found)
    return found


def driver_costs(name: str, seed: int, participant: int) -> dict[str, list[Row]]:
    """Costs of all events of one driver in one condition, by `EVENTS`."""
    found: dict[str, list[Row]] = {event: [] for event in EVENTS}
    parts = [
        false_and_none(falsely_triggered(name, seed, participant, trial))
        for trial in range(len(TRIGGER_TIMES))
    ]
    parts.append(missed_and_announced(trial_of(name, seed, participant)))
    for part in parts:
        for event, rows in part.items():
            found[event] += rows
    return found


def provoke(
    seed: int = SEED,
    num_drivers: int = NUM_DRIVERS,
    conditions: Sequence[str] = CONDITION_NAMES,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
) -> list[Provoked]:
    """Let a population meet false triggers and a system that misses every change.

    Args:
        seed: Of the drivers: never that of a study, of training or of pilot runs.
        num_drivers: How many, the same in each condition.
        conditions: Names of the conditions.
        jobs: Threads.
        progress: Called with the number of drivers just done, once per condition.

    Returns:
        One per condition and event, in order.
    """
    tasks = [(name, n) for name in conditions for n in range(1, num_drivers + 1)]
    found = in_threads(
        lambda task: driver_costs(task[0], seed, task[1]), tasks, jobs, progress
    )
    return [
        _gathered(
            name,
            event,
            [
                row
                for (which, _), driver in zip(tasks, found, strict=True)
                if which == name
                for row in driver[event]
            ],
        )
        for name in conditions
        for event in EVENTS
    ]


def _gathered(name: str, event: str, rows: Sequence[Row]) -> Provoked:
    table = {
        cost: np.array([row[cost] for row in rows], dtype=np.float64)
        for cost in COST_COLUMNS
    }
    return Provoked(condition=name, event=event, num_events=len(rows), costs=table)


def spread(found: Provoked, cost: str) -> Spread:
    """How one cost is spread over the events.

    Raises:
        ValueError: If there is no such cost.
    """
    if cost not in found.costs:
        raise ValueError(
            f"cost '{cost}' is not known; choose one of {', '.join(COST_COLUMNS)}"
        )
    known = found.costs[cost][np.isfinite(found.costs[cost])]
    if known.size == 0:
        return Spread(math.nan, math.nan, math.nan, math.nan, 0)
    low, median, high = (float(each) for each in np.percentile(known, [10, 50, 90]))
    return Spread(low, median, high, float(known.mean()), int(known.size))


TORQUES = {
    "peak_driver_torque": "peak driver torque [N·m]",
    "driver_torque_rms": "driver torque RMS [N·m]",
    "peak_opposing_torque": "peak opposing torque [N·m]",
    "gain_minimum": "lowest gain [–]",
    "inconsistent": "inconsistent",
    "replanned": "re-planned",
    "time_to_recover": "gain back after [s]",
    "time_to_settle": "settled after [s]",
}
PLACES = {
    "largest_deviation": "largest deviation [m]",
    "wheel_over_line": "wheel over the line",
    "left_lane": "left the lane",
}
TABLES = (
    ((FALSE_TRIGGER, NO_TRIGGER), PLACES | TORQUES),
    ((MISSED_CROSSING, ANNOUNCED_CROSSING), {"overshoot": "overshoot [m]"} | TORQUES),
)


def cell(found: Provoked, cost: str) -> str:
    """Median and 10 to 90 % of a cost; the share of the events if it is a flag."""
    seen = spread(found, cost)
    if seen.num_known == 0:
        return NOTHING
    if cost in SHARES:
        return f"{number(100.0 * seen.mean, 0)} %"
    digits = 1 if cost.startswith("time_") else 2
    low, middle, high = (number(each, digits) for each in seen[:3])
    few = seen.num_known < found.num_events
    told = f", of {seen.num_known}" if few else ""
    return f"{middle} ({low} to {high}{told})"


def table(
    results: list[Provoked], events: tuple[str, ...], names: dict[str, str]
) -> str:
    """One table in Markdown."""
    head = ["condition", "event", "number", *names.values()]
    lines = [head, ["---"] * len(head)]
    lines += [
        [each.condition, each.event, str(each.num_events)]
        + [cell(each, cost) for cost in names]
        for each in results
        if each.event in events
    ]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drivers", type=int, default=NUM_DRIVERS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    results = provoke(options.seed, options.drivers, jobs=options.jobs)
    print(f"{options.drivers} drivers of seed {options.seed} in each condition")
    for events, names in TABLES:
        print(f"\n{table(results, events, names)}")


if __name__ == "__main__":
    main()
