"""What false and missed triggers cost, provoked over a population of drivers.

    python benchmarks/trigger_cost.py [--drivers 48] [--seed 3001] [--jobs 2]

Prints two tables in Markdown. False triggers: the system starts a lane change while the
driver keeps the lane, four trials each; beside the same seconds without it. Missed
crossings: the system never notices a lane change; beside the same drivers with every
change announced 3 s ahead by their own plan. Definitions: docs/measures.md. Nothing is
tuned on these results.
"""

from __future__ import annotations

import argparse

from costeer.study.reporting.numerals import NOTHING, number
from costeer.validation.trigger_cost import (
    ANNOUNCED_CROSSING,
    FALSE_TRIGGER,
    MISSED_CROSSING,
    NO_TRIGGER,
    NUM_DRIVERS,
    SEED,
    SHARES,
    Provoked,
    provoke,
    spread,
)

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
