"""What columns are said to be agrees with the tables and the page of measures."""

from __future__ import annotations

import re
from pathlib import Path

from costeer.study.dictionary import tables
from costeer.study.measures import trial_row
from costeer.study.outcome import PairRow
from costeer.study.trial_tables import LANE_CHANGE_COLUMNS, TRIGGER_COLUMNS
from tests.study.synthetic import synthetic_record

PAGE = (Path(__file__).parents[2] / "docs" / "measures.md").read_text("utf-8")


def names(file: str) -> list[str]:
    return [entry.column for entry in tables()[file]]


def test_every_column_is_there_in_its_order() -> None:
    trial = list(trial_row(synthetic_record(length=1800.0), 1))
    series = ["label", "scenario", "occasion"]  # of sessions only
    workload = ["tlx_raw", "tlx_weighted"]
    assert names("trials.csv") == [*trial, *workload, *series, "ended_by"]
    assert names("lane_changes.csv") == [*LANE_CHANGE_COLUMNS, *series]
    assert names("triggers.csv") == [*TRIGGER_COLUMNS, *series]
    assert names("pairs.csv") == list(PairRow._fields)


def test_units_are_those_of_the_page_of_measures() -> None:
    told = {}
    for cell in re.findall(r"^\| (`[^|]*) \|", PAGE, re.MULTILINE):
        for group, unit in re.findall(r"([^\[\]]+)\[([^\]]+)\]", cell):
            told.update(dict.fromkeys(re.findall(r"`(\w+)`", group), unit))
    entries = [e for file in ("trials.csv", "lane_changes.csv") for e in tables()[file]]
    known = {entry.column: entry.unit for entry in entries}
    both = told.keys() & known.keys()
    assert len(both) > 20
    assert {name: known[name] for name in both} == {name: told[name] for name in both}


def test_explanations_come_from_the_code() -> None:
    (entry,) = [e for e in tables()["tests.csv"] if e.column == "epsilon"]
    assert entry.meaning == "Greenhouse-Geisser factor on both; 1 where it has no place"
    assert entry.unit == "-"
    assert all(e.meaning for entries in tables().values() for e in entries)
