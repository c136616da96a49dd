"""The results of a comparison as its folder holds them, finished or not."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import replacing
from costeer.comparison.design import (
    Block,
    Cell,
    LeftOut,
    blocks_of,
    cells_of,
)
from costeer.comparison.entrants import Course, Entrant
from costeer.comparison.folder import ComparisonFolder, read_block
from costeer.comparison.measures import COLUMNS, Moment, TrialOutcome
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import scenario_of
from costeer.study.trial_tables import cell as text_of

if TYPE_CHECKING:
    from _csv import Writer

TRIALS_FILE = "trials.csv"
IDENTITY = ("method", "scenario", "mistake", "participant", "failure", "torque_faults")
"""First columns of `trials.csv`; those of `measures.COLUMNS` follow."""

Key = tuple[str, str, str]
"""Scenario, mistake and method."""


class Failure(NamedTuple):
    """A trial without a result."""

    method: str
    scenario: str
    mistake: str
    participant: int
    reason: str


class Results(NamedTuple):
    """What came of a comparison.

    Attributes:
        configuration: Of its folder.
        methods: Names, in the order of the tables.
        scenarios: Names.
        mistakes: Names, "none" first.
        values: Of each cell, shape `(participant, column)`, columns as
            `measures.COLUMNS`; NaN where there is no value.
        disputes: By cell, when inconsistencies came in all drives together; no entry
            for a method that gives no verdict.
        failures: Trials without a result.
        faults: By method, samples with a torque that was not finite or over the limit.
        left_out: Combinations that contradict themselves.
        num_missing: Trials that have not been driven yet.
    """

    configuration: dict[str, Any]  # Any: values of YAML
    methods: tuple[str, ...]
    scenarios: tuple[str, ...]
    mistakes: tuple[str, ...]
    values: dict[Key, NDArray[np.float64]]
    disputes: dict[Key, tuple[Moment, ...]]
    failures: tuple[Failure, ...]
    faults: dict[str, int]
    left_out: tuple[LeftOut, ...]
    num_missing: int

    @property
    def participants(self) -> int:
        """How many drivers there are [-]."""
        return int(self.configuration["participants"])

    def column(self, key: Key, name: str) -> NDArray[np.float64]:
        """A column of a cell, shape `(participant,)`; empty without the cell."""
        found = self.values.get(key)
        return np.zeros(0) if found is None else found[:, COLUMNS.index(name)]


def gathered(folder: ComparisonFolder) -> Results:
    """Read all results, and write `trials.csv` on the way.

    Raises:
        OSError: If a file cannot be read or written.
    """
    configuration = folder.configuration
    left_out = tuple(LeftOut(*each) for each in configuration["left_out"])
    cells = cells_from(configuration)
    participants = int(configuration["participants"])
    values: dict[Key, NDArray[np.float64]] = {}
    disputes: dict[Key, tuple[Moment, ...]] = {}
    failures: list[Failure] = []
    faults: dict[str, int] = {}
    num_missing = 0
    with _trials(folder.path / TRIALS_FILE) as writer:
        for cell in cells:
            outcomes = list(_outcomes(folder, cell, participants))
            num_missing += participants - len(outcomes)
            table = np.full((participants, len(COLUMNS)), math.nan)
            for each in outcomes:
                table[each.participant - 1] = each.values
                writer.writerow(_row(cell, each))
            values[_key(cell)] = table
            judged = [each.disputes for each in outcomes if each.disputes is not None]
            if judged:
                disputes[_key(cell)] = tuple(itertools.chain.from_iterable(judged))
            failures += [_failure(cell, each) for each in outcomes if each.failure]
            name = cell.entrant.name
            found = sum(each.torque_faults for each in outcomes)
            faults[name] = faults.get(name, 0) + found
    return Results(
        configuration=configuration,
        methods=tuple(configuration["methods"]),
        scenarios=tuple(configuration["scenarios"]),
        mistakes=tuple(configuration["mistakes"]),
        values=values,
        disputes=disputes,
        failures=tuple(failures),
        faults={name: number for name, number in faults.items() if number},
        left_out=left_out,
        num_missing=num_missing,
    )


def cells_from(configuration: dict[str, Any]) -> tuple[Cell, ...]:
    """The cells of a comparison, by names alone: nothing of them can be driven."""
    entrants = [Entrant(name, name, True) for name in configuration["methods"]]
    courses = [
        Course(name, scenario_in(name, each), each["length"], each["speed"])
        for name, each in configuration["scenarios"].items()
    ]
    left_out = [LeftOut(*each) for each in configuration["left_out"]]
    return cells_of(entrants, courses, configuration["mistakes"], left_out)


def num_missing(folder: ComparisonFolder) -> int:
    """How many trials have not been driven yet [-].

    Raises:
        OSError: If a file cannot be read.
    """
    participants = int(folder.configuration["participants"])
    blocks = blocks_of(cells_from(folder.configuration), participants)
    return sum(len(b.participants) for b in blocks if read_block(folder, b) is None)


def scenario_in(name: str, told: dict[str, Any]) -> str | Scenario:
    """A scenario as `compare.yaml` tells of it: by name, or itself.

    Raises:
        ValueError: If it cannot be.
    """
    return scenario_of(told["content"]) if "content" in told else name


def _outcomes(
    folder: ComparisonFolder, cell: Cell, participants: int
) -> Iterator[TrialOutcome]:
    for block in blocks_of([cell], participants):
        yield from read_block(folder, Block(cell, block.participants)) or ()


def _key(cell: Cell) -> Key:
    return cell.course.name, cell.mistake, cell.entrant.name


def _failure(cell: Cell, outcome: TrialOutcome) -> Failure:
    who = cell.entrant.name, cell.course.name, cell.mistake
    return Failure(*who, outcome.participant, outcome.failure)


def _row(cell: Cell, outcome: TrialOutcome) -> list[str]:
    named = (cell.entrant.name, cell.course.name, cell.mistake, outcome.participant)
    values = (*named, outcome.failure, outcome.torque_faults, *outcome.values)
    return [text_of(each) for each in values]


@contextmanager
def _trials(path: Path) -> Iterator[Writer]:
    """`trials.csv`, whole or not at all, written row by row."""
    with (
        replacing(path) as partial,
        partial.open("w", encoding="utf-8", newline="") as stream,
    ):
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow((*IDENTITY, *COLUMNS))
        yield writer
