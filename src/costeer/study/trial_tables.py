"""The tables of measures: rows per trial, per event, and per value of a scenario.

Numbers are written so that they read back bit for bit; what is undefined, such as
the duration of a lane change in manual driving, is an empty cell.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np

from costeer.base.files import replacing, write_text
from costeer.study.trigger_costs import COST_COLUMNS

TRIALS_FILE = "trials.csv"
LANE_CHANGES_FILE = "lane_changes.csv"
TRIGGERS_FILE = "triggers.csv"
SCENARIO_FILE = "scenario_measures.csv"
FAILURES_FILE = "failures.csv"

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
    "settled_time",
    "duration_until_settled",
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


class FailedRow(NamedTuple):
    """A row of `failures.csv`: a trial without a result.

    Attributes:
        participant: Who.
        condition: Of the trial.
        order: Its place in the participant's day, from 1.
        reason: Why it failed.
    """

    participant: int
    condition: str
    order: int
    reason: str


def write_trial_tables(
    folder: Path, trials: Iterable[TrialRows], failed: Sequence[FailedRow] = ()
) -> None:
    """Write the tables, rows in the order of the trials, which are read one by one.

    Those of the scenario and of failures are there only if they have rows.
    """
    with ExitStack() as open_tables:

        def table(name: str, columns: Sequence[str] | None = ()) -> _Table:
            return _Table(open_tables, folder / name, columns)

        measures = table(TRIALS_FILE)
        changes = table(LANE_CHANGES_FILE, LANE_CHANGE_COLUMNS)
        triggers = table(TRIGGERS_FILE, TRIGGER_COLUMNS)
        scenario = table(SCENARIO_FILE, None)
        failures = table(FAILURES_FILE, None)
        for each in trials:
            measures.write([each.measures])
            changes.write(each.lane_changes)
            triggers.write(each.triggers)
            scenario.write(each.scenario)
        failures.write([row._asdict() for row in failed])


class _Table:
    """A CSV file that grows row by row and takes its place at the end.

    Args:
        stack: Closes it.
        file: To write or replace.
        columns: Head of a table without rows; None if it is then not there.
    """

    def __init__(
        self, stack: ExitStack, file: Path, columns: Sequence[str] | None
    ) -> None:
        self._columns = columns
        self._file = file
        self._names: list[str] | None = None
        self._stream = stack.enter_context(self._opened())
        self._writer = csv.writer(self._stream, lineterminator="\n")

    @contextmanager
    def _opened(self) -> Iterator[TextIO]:
        """The stream; at the end the head of a table without rows, or no table."""
        with (
            replacing(self._file) as partial,
            partial.open("w", encoding="utf-8", newline="") as stream,
        ):
            yield stream
            if self._names is None and self._columns is not None:
                self._writer.writerow(self._columns)
        if self._names is None and self._columns is None:
            self._file.unlink()

    def write(self, rows: Sequence[Row]) -> None:
        """Add rows of the same keys."""
        for row in rows:
            if self._names is None:
                self._names = list(row)
                self._writer.writerow(self._names)
            self._writer.writerow([cell(row[name]) for name in self._names])


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
