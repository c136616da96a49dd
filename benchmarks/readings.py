"""How much our readings of the paper matter: the study again with the other reading.

    python -m benchmarks.readings FOLDER [--seeds 1 2 3 4 5] [--only NAME ...]

Where the paper is silent or contradicts itself, costeer takes one reading
(docs/paper.md). For each of `READINGS` this runs twelve drivers through `CONDITIONS`
once per seed with one thing changed, and prints a table in Markdown for each condition:
the change of the mean against our reading with the same drivers and noise, in percent,
median over the seeds, smallest and largest. What is done is not run again.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.methods.conditions import MANUAL
from costeer.records.record import read_record
from costeer.study.configuration import StudySettings
from costeer.study.definitions import MeasureParameters
from costeer.study.measures import lane_change_rows, trial_row
from costeer.study.run import Scale, run_study

CONDITIONS = ("strong-rapid", "weak-gentle")
"""Both strengths, and the shortest and longest path; most disputes, and fewer."""

OURS = "ours"

TRIAL_MEASURES = ("sdlp", "swrr", "driver_torque_rms")
CHANGE_MEASURES = ("overshoot", "peak_steering_angle", "duration")
MEASURES = (*TRIAL_MEASURES, *CHANGE_MEASURES, "disputed")
"""Columns of the table; of the last the change is in percentage points."""

HEADINGS = ("SDLP", "reversals", "torque", "overshoot", "peak angle", "duration")

Means = dict[str, float]
"""A number for each of `MEASURES`."""


class Reading(NamedTuple):
    """What could be read otherwise, and how the other reading is set.

    Attributes:
        name: Short, of its folder.
        ours: Our reading, in words.
        other: The other one, in words.
        values: Parameters of the other reading, as `--set` takes them.
        settings: Fields of `StudySettings` of the other reading.
        measures: Fields of `MeasureParameters`; the records are then those of ours.
        changes_manual: Whether manual driving is another, too.
    """

    name: str
    ours: str
    other: str
    values: Mapping[str, float] = {}
    settings: Mapping[str, str] = {}
    measures: Mapping[str, float] = {}
    changes_manual: bool = False


def _set(name: str, ours: str, other: str, **values: float) -> Reading:
    """A reading that parameters set; `__` stands for the dot of their names."""
    dotted = {key.replace("__", "."): value for key, value in values.items()}
    manual = any(key.split(".")[0] in ("column", "sensors") for key in dotted)
    return Reading(name, ours, other, values=dotted, changes_manual=manual)


READINGS = (
    _set("table-3", "no verdict against hands that only rest", "Table III literally",
         consistency__hands_on_threshold=0.0),
    _set("look-ahead", "target at the car", "at the preview point",
         preview__look_ahead=1.0),
    _set("delta-double", "δ = 0.023 W", "twice",
         consistency__inconsistency_threshold=0.046),
    _set("delta-half", "δ = 0.023 W", "half",
         consistency__inconsistency_threshold=0.0115),
    _set("rate-gain", "K_yd = 4 N·m·s/rad", "1",
         guidance__heading_error_rate_gain=1.0),
    _set("hold", "verdict of each sample", "held for 0.2 s",
         consistency__hold_time=0.2),
    Reading("scripted", "trigger by the network", "a perfect predictor",
            settings={"intention": "scripted"}),
    _set("trigger", "3 positives in a row trigger", "each one does",
         inference__trigger_samples=1.0),
    _set("lock", "trigger locked until settled after a path", "never locked",
         inference__lock_duration=0.03),
    _set("friction", "dry friction compensated", "not compensated",
         controller__column__friction=0.0),
    _set("arms", "torque of carried arms taken off", "not taken off",
         hands__inertia=0.0009, hands__damping=0.0),
    _set("replan", "re-plan below K_h = 0.05", "below 0.01",
         replanning__replan_gain=0.01),
    _set("rate-limit", "at most 30 N·m/s", "no limit of the rate",
         actuation__torque_rate_limit=3000.0),
    Reading("compact", "mid-size car", "compact", settings={"car": "compact"},
            changes_manual=True),
    Reading("large", "mid-size car", "large", settings={"car": "large"},
            changes_manual=True),
    _set("head", "noisy head tracker", "exact", sensors__head_yaw_deviation=0.0,
         sensors__loss_rate=0.0, sensors__turned_loss_rate=0.0),
    Reading("unfiltered", "reversals below 0.6 Hz", "unfiltered",
            measures={"reversal_cutoff": 0.0}),
    Reading("margin", "3 s around lane changes left out", "5 s",
            measures={"lane_change_margin": 5.0}),
    Reading("yaw-quarter", "lane change by 0.5° of yaw", "0.25°",
            measures={"yaw_threshold": float(np.radians(0.25))}),
    Reading("yaw-one", "lane change by 0.5° of yaw", "1°",
            measures={"yaw_threshold": float(np.radians(1.0))}),
)  # fmt: skip


def settings_of(reading: Reading | None, seed: int) -> StudySettings:
    """The study of a reading; of ours if None."""
    if reading is None:
        return StudySettings(seed=seed, conditions=(MANUAL, *CONDITIONS))
    first = (MANUAL,) if reading.changes_manual else ()
    return StudySettings(
        seed=seed,
        conditions=(*first, *CONDITIONS),
        parameters=tuple(reading.values.items()),
    )._replace(**dict(reading.settings))


def numbers(rows: Sequence[Mapping[str, object]], name: str) -> list[float]:
    """A column's numbers; what is empty is left out."""
    cells = (str(row[name]) for row in rows)
    return [value for text in cells if text and np.isfinite(value := float(text))]


def means(
    trials: Sequence[Mapping[str, object]], changes: Sequence[Mapping[str, object]]
) -> Means:
    """Means of one condition over trials and lane changes, in SI units and percent."""
    found = {name: float(np.mean(numbers(trials, name))) for name in TRIAL_MEASURES}
    for name in CHANGE_MEASURES:
        found[name] = float(np.mean(numbers(changes, name)))
    disputes = np.array(numbers(changes, "num_inconsistencies"))
    found["disputed"] = float(100.0 * np.mean(disputes > 0.0)) if disputes.size else 0.0
    return found


def of_tables(folder: Path) -> dict[str, Means]:
    """Means of each condition of a finished study."""
    tables = []
    for name in ("trials.csv", "lane_changes.csv"):
        with (folder / name).open(newline="", encoding="utf-8") as file:
            tables.append(list(csv.DictReader(file)))
    return by_condition(*tables)


def by_condition(
    trials: Sequence[Mapping[str, object]], changes: Sequence[Mapping[str, object]]
) -> dict[str, Means]:
    """Means of each condition that has trials."""
    names = sorted({str(row["condition"]) for row in trials})
    return {
        name: means(
            [row for row in trials if row["condition"] == name],
            [row for row in changes if row["condition"] == name],
        )
        for name in names
    }


def measured_again(folder: Path, reading: Reading) -> dict[str, Means]:
    """Means of the records of a study, measured as the other reading says."""
    parameters = MeasureParameters(**dict(reading.measures))
    trials, changes = [], []
    for path in sorted((folder / "records").glob("*.parquet")):
        record = read_record(path)
        trials.append(trial_row(record, parameters=parameters))
        changes += lane_change_rows(record, parameters)
    return by_condition(trials, changes)


def run(folder: Path, reading: Reading | None, seed: int) -> dict[str, Means]:
    """Means of each condition of a reading; what is missing is run first."""
    ours = folder / OURS / f"seed-{seed}"
    if reading is not None and reading.measures:
        return measured_again(ours, reading)
    out = ours if reading is None else folder / reading.name / f"seed-{seed}"
    if not (out / "lane_changes.csv").is_file():
        kept = Scale(records=reading is None)
        run_study(out, settings_of(reading, seed), jobs=1, report=None, scale=kept)
    return of_tables(out)


def change(ours: Means, other: Means, measure: str) -> float:
    """Of the mean against ours [%]; of the share of disputes [percentage points]."""
    if measure == "disputed":
        return other[measure] - ours[measure]
    return 100.0 * (other[measure] / ours[measure] - 1.0)


def signed(value: float) -> str:
    """A whole number with its sign; no sign of nothing."""
    return f"{value:+.0f}" if abs(value) >= 0.5 else "0"


def cell(changes: Sequence[float]) -> str:
    """Median, smallest and largest; bold if it is beyond 5 and all agree in sign."""
    median, low, high = np.median(changes), min(changes), max(changes)
    if max(abs(low), abs(high)) < 0.5:
        return "0"
    text = f"{signed(median)} ({signed(low)} to {signed(high)})"
    return f"**{text}**" if abs(median) >= 5.0 and low * high > 0.0 else text


Found = Sequence[dict[str, Means]]
"""Of each seed, the means of each condition."""


def turned(base: Found, other: Found, condition: str) -> str:
    """Measures whose difference from manual has another sign, medians over seeds."""
    found = []
    for name, heading in zip(MEASURES[:-1], HEADINGS, strict=True):
        signs = []
        for each in (base, other):
            pairs = zip(each, base, strict=True)
            alone = [(one, one.get(MANUAL, manual[MANUAL])) for one, manual in pairs]
            gaps = [change(hands, one[condition], name) for one, hands in alone]
            signs.append(np.sign(np.median(gaps)))
        if signs[0] != signs[1]:
            found.append(heading)
    return ", ".join(found)


def row(reading: Reading, base: Found, other: Found, condition: str) -> str:
    """A line of the table."""
    pairs = [(a[condition], b[condition]) for a, b in zip(base, other, strict=True)]
    cells = [cell([change(a, b, name) for a, b in pairs]) for name in MEASURES]
    words = reading.ours, reading.other, *cells, turned(base, other, condition)
    return "| " + " | ".join(words) + " |"


def print_table(
    readings: Sequence[Reading], found: Sequence[Found], base: Found, condition: str
) -> None:
    """One condition: our means against manual, then a line for each reading."""
    print(f"\n{condition}\n")
    heads = ("our reading", "the other", *HEADINGS, "disputed [points]", "turned")
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    against = [
        cell([change(each[MANUAL], each[condition], name) for each in base])
        for name in MEASURES[:-1]
    ]
    share = np.median([each[condition]["disputed"] for each in base])
    print(
        "| *ours against manual* | | " + " | ".join(against) + f" | {share:.0f} % | |"
    )
    for reading, other in zip(readings, found, strict=True):
        print(row(reading, base, other, condition))


def read_arguments(words: list[str] | None = None) -> argparse.Namespace:
    """What the command line says."""
    summary = (__doc__ or "").splitlines()[0]
    parser = argparse.ArgumentParser(prog="benchmarks.readings", description=summary)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    names = [each.name for each in READINGS]
    parser.add_argument("--only", nargs="+", choices=names, default=names)
    return parser.parse_args(words)


def main(words: list[str] | None = None) -> None:
    """Run what is missing, and print the tables."""
    asked = read_arguments(words)
    readings = [each for each in READINGS if each.name in asked.only]
    base = [run(asked.folder, None, seed) for seed in asked.seeds]
    found = [
        [run(asked.folder, reading, seed) for seed in asked.seeds]
        for reading in readings
    ]
    for condition in CONDITIONS:
        print_table(readings, found, base, condition)


if __name__ == "__main__":
    main()
