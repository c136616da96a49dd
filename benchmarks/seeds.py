"""What a study says with other people: the same experiment with several seeds.

    python -m benchmarks.seeds FOLDER [--seeds 1 2 3 4 5] [--driver NAME]
        [--set NAME=VALUE ...] [--intention network|scripted]

Runs `costeer study` once per seed into FOLDER/seed-N (what is done is not run again)
and prints, for each measure and condition, the difference from manual driving in
percent of it: median over the seeds, smallest and largest, and in how many of them the
paired test (Benjamini-Hochberg) says p < 0.05. Then how many assisted lane changes were
disputed. A verdict that holds for one seed and not for another is chance.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from costeer.methods.conditions import CONDITION_NAMES, MANUAL
from costeer.study.configuration import StudySettings
from costeer.study.run import run_study

ALPHA = 0.05
ASSISTED = tuple(name for name in CONDITION_NAMES if name != MANUAL)

Row = dict[str, str]


def rows(path: Path) -> list[Row]:
    """The rows of a table of the study."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text: str) -> float:
    """A cell of a table; NaN if it is empty."""
    return float(text) if text else float("nan")


def effects(folder: Path) -> dict[tuple[str, str], tuple[float, bool]]:
    """Of each measure and condition: difference from manual [%], whether p < 0.05."""
    found = {}
    for row in rows(folder / "pairs.csv"):
        if row["analysis"] == "within" and row["second"] == MANUAL:
            share = 100.0 * number(row["mean_difference"]) / number(row["mean_second"])
            verdict = number(row["p_corrected"]) < ALPHA
            found[row["measure"], row["first"]] = (share, verdict)
    return found


def disputed(folder: Path) -> dict[str, float]:
    """Of each assisted condition: lane changes with an inconsistency [%]."""
    changes = rows(folder / "lane_changes.csv")
    return {
        name: 100.0
        * float(
            np.mean(
                [
                    number(row["num_inconsistencies"]) > 0.0
                    for row in changes
                    if row["condition"] == name
                ]
            )
        )
        for name in ASSISTED
    }


def shown(values: Iterable[float]) -> str:
    """Median, smallest and largest."""
    every = np.array(list(values))
    return f"{np.median(every):+6.1f} ({every.min():+.1f} to {every.max():+.1f})"


def print_effects(folders: list[Path]) -> None:
    """A row for each measure and condition."""
    found = [effects(folder) for folder in folders]
    print("difference from manual [%]: median over seeds (smallest to largest)")
    for key in found[0]:
        verdicts = sum(each[key][1] for each in found)
        mixed = "  mixed" if 0 < verdicts < len(found) else ""
        print(
            f"{key[0]:22s} {key[1]:15s} {shown(each[key][0] for each in found):28s}"
            f" p < {ALPHA} in {verdicts} of {len(found)}{mixed}"
        )
    several = [
        key for key in found[0] if 0 < sum(e[key][1] for e in found) < len(found)
    ]
    print(f"\n{len(several)} of {len(found[0])} verdicts depend on the seed")


def print_disputes(folders: list[Path]) -> None:
    """How many lane changes were disputed."""
    found = [disputed(folder) for folder in folders]
    print("\nlane changes with an inconsistency [%]")
    for name in ASSISTED:
        print(f"{name:15s} {shown(each[name] for each in found)}")


def settings(given: argparse.Namespace, seed: int) -> StudySettings:
    """The published study with another seed, and with what is asked for."""
    pairs = [text.split("=", 1) for text in given.set]
    return StudySettings(
        seed=seed,
        intention=given.intention,
        drivers=(given.driver,) if given.driver else (),
        parameters=tuple((name, float(value)) for name, value in pairs),
    )


def read_arguments(words: list[str] | None = None) -> argparse.Namespace:
    """What the command line says."""
    summary = (__doc__ or "").splitlines()[0]
    parser = argparse.ArgumentParser(prog="benchmarks.seeds", description=summary)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    parser.add_argument("--driver", default="")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--intention", default="network")
    return parser.parse_args(words)


def main(words: list[str] | None = None, **given: Any) -> None:  # Any: of run_study
    """Run what is missing, and print the tables."""
    asked = read_arguments(words)
    folders = [asked.folder / f"seed-{seed}" for seed in asked.seeds]
    for seed, folder in zip(asked.seeds, folders, strict=True):
        print(f"seed {seed}: {folder}", flush=True)
        run_study(folder, settings(asked, seed), **given)
    print_effects(folders)
    print_disputes(folders)


if __name__ == "__main__":
    main()
