"""What the columns of a comparison's tables are: a row of `columns.csv` each."""

from __future__ import annotations

import re
from typing import NamedTuple

from costeer.comparison.criteria import CRITERIA
from costeer.comparison.effects import EffectRow, MeanRow
from costeer.comparison.results import TRIALS_FILE, Failure
from costeer.comparison.winners import WinnerRow
from costeer.comparison.worst import WORST_FILE, WorstCase

EFFECTS_FILE = "effects.csv"
MEANS_FILE = "means.csv"
WINNERS_FILE = "winners.csv"
EXCLUSIONS_FILE = "exclusions.csv"
COLUMNS_FILE = "columns.csv"


class ColumnRow(NamedTuple):
    """A row of `columns.csv`: file, column, meaning and unit."""

    file: str
    column: str
    meaning: str
    unit: str = "-"


_IDENTITY = (
    ColumnRow(TRIALS_FILE, "method", "name of the method"),
    ColumnRow(TRIALS_FILE, "scenario", "name of the scenario"),
    ColumnRow(TRIALS_FILE, "mistake", "that was injected, or none"),
    ColumnRow(TRIALS_FILE, "participant", "number of the virtual driver"),
    ColumnRow(TRIALS_FILE, "failure", "why there is no result; empty if there is one"),
    ColumnRow(
        TRIALS_FILE,
        "torque_faults",
        "samples with a torque that was not finite or over the limit",
    ),
)

_BESIDE = (
    ColumnRow(TRIALS_FILE, "num_lane_changes", "lane changes completed"),
    ColumnRow(TRIALS_FILE, "num_dropped_changes", "crossings that are no lane change"),
    ColumnRow(TRIALS_FILE, "duration", "of the trial", "s"),
    ColumnRow(TRIALS_FILE, "distance", "that was driven", "m"),
)

_OF_ROWS = (
    (EFFECTS_FILE, EffectRow),
    (MEANS_FILE, MeanRow),
    (WINNERS_FILE, WinnerRow),
    (WORST_FILE, WorstCase),
)


def column_rows() -> list[ColumnRow]:
    """Every column of every table."""
    rows = list(_IDENTITY)
    rows += [
        ColumnRow(TRIALS_FILE, each.name, each.meaning, each.si_unit)
        for each in CRITERIA
    ]
    rows += _BESIDE
    for file, kind in _OF_ROWS:
        told = _attributes(kind.__doc__ or "")
        rows += [ColumnRow(file, name, told[name]) for name in kind._fields]
    rows += [
        ColumnRow(EXCLUSIONS_FILE, name, meaning)
        for name, meaning in zip(Failure._fields, _OF_A_FAILURE, strict=True)
    ]
    return rows


_OF_A_FAILURE = (
    "name of the method",
    "name of the scenario",
    "that was injected, or none",
    "number of the virtual driver",
    "why there is no result",
)


def _attributes(text: str) -> dict[str, str]:
    """Meaning of each attribute in a docstring."""
    body = text.partition("Attributes:")[2]
    found = re.findall(r"^ {8}(\w+): (.+(?:\n {12}.+)*)", body, re.MULTILINE)
    return {name: " ".join(words.split()).rstrip(".") for name, words in found}
