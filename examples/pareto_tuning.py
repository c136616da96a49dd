"""Values of the guidance that no others beat in two aims at once, with Optuna.

    python examples/pareto_tuning.py [TRIALS [TABLE.csv]]

Pilot drivers, who are in no study, drive 4 km with each proposal. No default changes.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Any

from costeer.sensitivity.factors import FACTORS
from costeer.sensitivity.run import Settings, driven

TUNED = ("δ", "γ", "λ", "preview time")
AIMS = ("driver_torque_rms", "overshoot")
SETTINGS = Settings(drivers=4, length=4000.0)
SEED = 1


def point_of(chosen: dict[str, float]) -> tuple[float, ...]:
    """All factors, those that are not tuned as published."""
    return tuple(chosen.get(each.name, each.usual) for each in FACTORS)


def proposed(trial: Any) -> tuple[float, ...]:  # Any: Optuna need not be installed
    """Drive what Optuna proposes; return the aims, less is better."""
    chosen = {
        each.name: trial.suggest_float(each.name, each.low, each.high)
        for each in FACTORS
        if each.name in TUNED
    }
    outcome = driven(SETTINGS, point_of(chosen))
    return tuple(outcome[aim] for aim in AIMS)


def tuned(number: int) -> list[dict[str, float]]:
    """The front after so many proposals, and the published values first."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    sampler = optuna.samplers.NSGAIISampler(seed=SEED, population_size=16)
    study = optuna.create_study(directions=["minimize"] * len(AIMS), sampler=sampler)
    study.optimize(proposed, n_trials=number)
    usual = {each.name: each.usual for each in FACTORS if each.name in TUNED}
    outcome = driven(SETTINGS, point_of({}))
    rows = [usual | {aim: outcome[aim] for aim in AIMS}]
    best = sorted(study.best_trials, key=lambda each: each.values[0])
    rows += [{**t.params, **dict(zip(AIMS, t.values, strict=True))} for t in best]
    return rows


def main(words: list[str]) -> int:
    """Print the front; write it if a table is named."""
    rows = tuned(int(words[0]) if words else 40)
    print("  ".join((*TUNED, *AIMS)))
    for number, row in enumerate(rows):
        cells = (f"{row[name]:.4g}" for name in (*TUNED, *AIMS))
        print("  ".join(cells), "" if number else "(published)")
    if len(words) > 1:
        with Path(words[1]).open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, [*TUNED, *AIMS])
            writer.writeheader()
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
