"""The tables of measures: rows per trial, per event, and per value of a scenario.

Numbers are written so that they read back bit for bit; what is undefined, such as
the duration of a lane change in manual driving, is an empty cell.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.base.files import write_text
from costeer.study.trigger_costs import COST_COLUMNS

TRIALS_FILE = "trials.csv"
LANE_CHANGES_FILE = "lane_changes.csv"
TRIGGERS_FILE = "triggers.csv"
SCENARIO_FILE = "scenario_measures.csv"

LANE_CHANGE_COLUMNS = (
    "participant",
    "condition",
    "strength",
    "change_duration",
    "index",
    "direction",
    "start_time",
    "crossing_time",
    "end_time",
    "duration",
    "overshoot",
    "steering_velocity_rms",
    "peak_steering_angle",
    "assisted",
    "duration_by_speed",
    "onset_to_crossing",
    "peak_lateral_speed",
    "duration_quarter_degree",
    "duration_one_degree",
    "detection_lead_time",
    "num_inconsistencies",
)
"""Head of `lane_changes.csv`, for a study in which nobody changed lanes."""

TRIGGER_COLUMNS = (
    "participant",
    "condition",
    "strength",
    "change_duration",
    "kind",
    "time",
    "direction",
    "crossing_time",
    "lead",
    "start_time",
    "end_time",
    *COST_COLUMNS,
)
"""Head of `triggers.csv`, for a study without a trigger and without a miss."""

Row = Mapping[str, object]


class TrialRows(NamedTuple):
    """What the tables say of one trial.

    Attributes:
        measures: Its row of `trials.csv`.
        lane_changes: Its rows of `lane_changes.csv`, in time.
        triggers: Its rows of `triggers.csv`, in time.
        scenario: Its rows of `scenario_measures.csv`; none on the paper's scenario.
    """

    measures: Row
    lane_changes: Sequence[Row]
    triggers: Sequence[Row] = ()
    scenario: Sequence[Row] = ()


def write_trial_tables(folder: Path, trials: Sequence[TrialRows]) -> None:
    """Write the tables, rows in the order of the trials.

    That of the scenario is there only if it has rows.
    """
    write_csv(folder / TRIALS_FILE, [each.measures for each in trials])
    changes = [row for each in trials for row in each.lane_changes]
    write_csv(folder / LANE_CHANGES_FILE, changes, LANE_CHANGE_COLUMNS)
    events = [row for each in trials for row in each.triggers]
    write_csv(folder / TRIGGERS_FILE, events, TRIGGER_COLUMNS)
    values = [row for each in trials for row in each.scenario]
    if values:
        write_csv(folder / SCENARIO_FILE, values)
    else:
        (folder / SCENARIO_FILE).unlink(missing_ok=True)


def write_csv(file: Path, rows: Sequence[Row], columns: Sequence[str] = ()) -> None:
    """Write rows of equal keys as CSV, whole or not at all.

    Args:
        file: To write or replace.
        rows: By column name.
        columns: Names to write if there is no row.
    """
    names = list(rows[0]) if rows else list(columns)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([cell(row[name]) for name in names] for row in rows)
    write_text(file, text.getvalue())


def cell(value: object) -> str:
    """Return the text of one cell: exact, and empty if the value is undefined."""
    plain = value.item() if isinstance(value, np.generic) else value
    if plain is None or plain is np.ma.masked:
        return ""
    if isinstance(plain, bool):
        return "true" if plain else "false"
    if isinstance(plain, float):
        return "" if math.isnan(plain) else repr(plain)
    return without_formula(str(plain))


def without_formula(text: str) -> str:
    """Text of a cell that no spreadsheet runs: what looks like a formula is quoted.

    Names of files and of stretches come from other people. A carriage return, which
    would end the row unquoted, becomes a line feed.
    """
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    if len(lines) < 2 or lines[0] not in "=+-@\t\n":
        return lines
    try:
        float(lines)
    except ValueError:
        return f"'{lines}"
    return lines
