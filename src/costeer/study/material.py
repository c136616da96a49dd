"""What a study folder holds, gathered for its figures and its report.

Only files are read: a study with people and one with virtual drivers look the same
from here, and a study that is not finished is one with fewer rows.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from costeer.controller.replanning import ReplanningParameters
from costeer.methods.conditions import CONDITION_NAMES, MANUAL
from costeer.records.columns import TrialRecord
from costeer.records.metadata import PERSON
from costeer.records.record import read_record
from costeer.study.definitions import DEFAULTS, MeasureParameters
from costeer.study.design import Trial
from costeer.study.folder import RECORDS, StudyFolder, read_study
from costeer.study.measures import parameters_of, prepared
from costeer.study.occasions import again_pairs
from costeer.study.outcome import WITHIN, PairRow, StudyTests, SummaryRow
from costeer.study.people import People, Who, tested_answers
from costeer.study.quantities import WORKLOAD, Quantity
from costeer.study.results import read_result
from costeer.study.statistics import MEASURES, Measure, study_tests
from costeer.study.trial_measures import trial_measures
from costeer.study.trial_tables import (
    LANE_CHANGES_FILE,
    SCENARIO_FILE,
    TRIALS_FILE,
    TRIGGERS_FILE,
)

_RECORD_NAME = re.compile(r"(\d+)-([a-z]+(?:-[a-z]+)?)\.parquet")


class StudyMaterial(NamedTuple):
    """One study folder in memory, records left on disk.

    Attributes:
        study: The folder and its configuration.
        trials: Rows of `trials.csv`.
        lane_changes: Rows of `lane_changes.csv`.
        triggers: Rows of `triggers.csv`; None if an older costeer made the tables.
        tests: Tests, pairs, summaries and what was dropped.
        records: Path of each trial record by participant and condition.
        metadata: What each of them says of itself, in the same order.
        people: Who drove, if these are people's drives and no study of costeer's.
        answers: Tests of what they answered; None without answers.
        beside: Virtual drivers to lay beside them.
        scenario: Rows of `scenario_measures.csv`; None on the paper's scenario.
        road: Parameters of the measures with the lanes that were driven on.
        again: Trials of conditions that were driven more than once, beside the first.
        num_results: Trials of which measures were kept and no record.
    """

    study: StudyFolder
    trials: pd.DataFrame
    lane_changes: pd.DataFrame
    triggers: pd.DataFrame | None
    tests: StudyTests
    records: dict[tuple[Who, str], Path]
    metadata: tuple[dict[str, object], ...]
    people: People | None = None
    answers: StudyTests | None = None
    beside: StudyMaterial | None = None
    scenario: pd.DataFrame | None = None
    road: MeasureParameters = DEFAULTS
    again: tuple[PairRow, ...] = ()
    num_results: int = 0


def read_material(folder: Path, people: People | None = None) -> StudyMaterial:
    """Read the tables of a study, test them, and find its records.

    Args:
        folder: Of the study.
        people: Whose drives these are; None for a folder with `study.yaml`.

    Raises:
        ValueError: If the folder is no study, or a table is missing or unreadable.
    """
    study = read_study(folder) if people is None else people.study
    all_trials = _read_table(folder / TRIALS_FILE, people is not None)
    all_changes = _read_table(folder / LANE_CHANGES_FILE, people is not None)
    trials, lane_changes = _of(people, all_trials), _of(people, all_changes)
    measures = (*MEASURES, *_workload(trials))
    tests = study_tests(trials, lane_changes, measures)
    measured = set(zip(trials["participant"], trials["condition"], strict=True))
    found = find_records(folder) if people is None else people.records
    # A record without a row was not believed when the tables were made.
    records = {k: path for k, path in found.items() if k in measured}
    about = [read_record(path, ()).metadata for path in records.values()]
    results = [] if people else _descriptions(study, measured - records.keys())
    about += results
    return StudyMaterial(
        study=study,
        trials=trials,
        lane_changes=lane_changes,
        triggers=_read_measured(folder / TRIGGERS_FILE, measured, people),
        tests=tests,
        records=records,
        metadata=tuple(about),
        people=people,
        answers=None if people is None else tested_answers(people),
        scenario=_read_measured(folder / SCENARIO_FILE, measured, people),
        again=()
        if people is None
        else again_pairs(people, all_trials, all_changes, measures),
        road=parameters_of(TrialRecord(about[0], {})) if about else DEFAULTS,
        num_results=len(results),
    )


def _descriptions(
    study: StudyFolder, keys: Collection[tuple[Who, str]]
) -> list[dict[str, object]]:
    """What trials without a record would say of themselves."""
    trials = (Trial(int(who), name, 0) for who, name in sorted(keys, key=str))
    results = (read_result(study, trial) for trial in trials)
    return [dict(each.about) for each in results if each is not None]


def read_virtual(folder: Path) -> StudyMaterial:
    """A study of virtual drivers, to lay beside others.

    Raises:
        ValueError: If the folder is none.
    """
    found = read_material(folder)
    if not is_virtual(found):
        raise ValueError(
            f"{folder} is a study with people; give --beside a folder of costeer study"
        )
    return found


def _workload(trials: pd.DataFrame) -> list[Measure]:
    """The scores of the NASA-TLX that somebody gave."""
    names = [each.name for each in WORKLOAD]
    given = [name for name in names if name in trials and trials[name].notna().any()]
    return [Measure(name) for name in given]


def _of(people: People | None, table: pd.DataFrame) -> pd.DataFrame:
    """The rows of the trials that a report is of; a session's tables hold more."""
    if people is None or "label" not in table:
        return table
    labels = {each.label for each in people.drives}
    return table[table["label"].isin(labels)].reset_index(drop=True)


def _read_measured(
    file: Path, measured: set[tuple[Who, str]], people: People | None
) -> pd.DataFrame | None:
    """The rows of the trials that were measured; None if there is no such table."""
    if not file.exists():
        return None
    table = _of(people, _read_table(file, people is not None))
    if table.empty and file.name == SCENARIO_FILE:
        return None
    keys = zip(table["participant"], table["condition"], strict=True)
    # An empty list would be taken for one of columns.
    return table[np.array([key in measured for key in keys], dtype=bool)]


def _read_table(file: Path, by_name: bool) -> pd.DataFrame:
    """A table of a study; pseudonyms such as 007 stay texts."""
    try:
        return pd.read_csv(file, dtype={"participant": str} if by_name else None)
    except FileNotFoundError:
        raise ValueError(
            f"{file.parent} has no {file.name}: not one trial of this study is "
            "finished; run it first"
        ) from None
    except pd.errors.EmptyDataError:
        return pd.DataFrame()
    except (pd.errors.ParserError, UnicodeDecodeError):
        raise ValueError(
            f"{file} is not a table of a study; delete it and run the study again"
        ) from None


def find_records(folder: Path) -> dict[tuple[Who, str], Path]:
    """Return the trial records by participant and condition, in their order."""
    found: dict[tuple[Who, str], Path] = {}
    for path in (folder / RECORDS).glob("*.parquet"):
        match = _RECORD_NAME.fullmatch(path.name)
        if match and match[2] in CONDITION_NAMES:
            found[int(match[1]), match[2]] = path
    place = {name: index for index, name in enumerate(CONDITION_NAMES)}
    return dict(
        sorted(found.items(), key=lambda item: (int(item[0][0]), place[item[0][1]]))
    )


def conditions_driven(material: StudyMaterial) -> tuple[str, ...]:
    """Return the conditions of which there is a trial, in the order of Table IV."""
    driven = set(material.trials["condition"])
    return tuple(name for name in CONDITION_NAMES if name in driven)


def strengths_driven(material: StudyMaterial) -> tuple[str, ...]:
    """Return the strengths of which there is a trial: manual, strong, weak."""
    driven = set(material.trials["strength"])
    return tuple(name for name in ("manual", "strong", "weak") if name in driven)


def is_virtual(material: StudyMaterial) -> bool:
    """Whether no person held the wheel in any trial."""
    return all(each["driver_kind"] != PERSON for each in material.metadata)


def why_without(material: StudyMaterial, measure: str) -> str:
    """Why no assisted trial has a value, as the first one's record says.

    Args:
        material: The study.
        measure: Column of `trials.csv`.

    Returns:
        The reason; empty if one has a value, or no trial is assisted.
    """
    trials = material.trials
    assisted = trials[trials["condition"] != MANUAL]
    if assisted.empty or assisted[measure].notna().any():
        return ""
    path = next((p for key, p in material.records.items() if key[1] != MANUAL), None)
    if path is None:
        return "no record of an assisted trial is left"
    return trial_measures(prepared(read_record(path)))[measure].reason


def replan_gain(material: StudyMaterial) -> float:
    """Return the gain below which the system planned anew [-]."""
    for each in material.metadata:
        value = each["replan_gain"]
        if isinstance(value, int | float):
            return float(value)
    return float(ReplanningParameters().replan_gain)


def participant_means(
    material: StudyMaterial, quantity: Quantity, factor: str
) -> dict[str, pd.Series[float]]:
    """Return each participant's mean per level of a factor, in shown units.

    Args:
        material: The study.
        quantity: What to average.
        factor: `condition` or `strength`.

    Returns:
        By level, one value for each participant who has one, in order.
    """
    table: pd.DataFrame = getattr(material, quantity.table)
    if quantity.name not in table:
        return {}
    means = table.groupby([factor, "participant"])[quantity.name].mean().dropna()
    return {
        str(level): values.droplevel(0) * quantity.factor
        for level, values in means.groupby(level=0)
    }


def summary(
    material: StudyMaterial, measure: str, factor: str, level: str
) -> SummaryRow | None:
    """Return mean and interval of a measure over participants' means."""
    wanted = (measure, WITHIN, factor, level)
    rows = material.tests.summaries
    return next((row for row in rows if row[:4] == wanted), None)


def pair(
    material: StudyMaterial, measure: str, analysis: str, first: str, second: str
) -> PairRow | None:
    """Return the comparison of two levels under an analysis."""
    wanted = (measure, analysis, first, second)
    return next((row for row in material.tests.pairs if row[:4] == wanted), None)


def mark_of(row: PairRow | None) -> str:
    """Return the mark of a comparison: `n.s.` without, a dash if it was not made."""
    if row is None or not math.isfinite(row.p_corrected):
        return "–"
    return row.mark or "n.s."
