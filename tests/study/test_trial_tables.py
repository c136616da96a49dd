"""Tables are exact, and undefined values are empty cells."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from costeer.study.measures import lane_change_rows, trigger_rows
from costeer.study.trial_tables import (
    LANE_CHANGE_COLUMNS,
    TRIGGER_COLUMNS,
    TrialRows,
    cell,
    write_csv,
    write_trial_tables,
)
from tests.study.synthetic import synthetic_record
from tests.web.attacks import FORMULAS


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.1, "0.1"),
        (np.float64(0.1), "0.1"),
        (1e-300, "1e-300"),
        (np.int8(-1), "-1"),
        (True, "true"),
        (np.bool_(False), "false"),
        ("strong", "strong"),
        (None, ""),
        (math.nan, ""),
        (np.float64("nan"), ""),
        (np.ma.masked, ""),
    ],
)
def test_a_cell_is_exact_or_empty(value: object, text: str) -> None:
    assert cell(value) == text


def test_numbers_read_back_bit_for_bit() -> None:
    for value in np.random.default_rng(1).normal(size=100):
        assert float(cell(value)) == value


@pytest.mark.parametrize("text", FORMULAS)
def test_no_spreadsheet_takes_a_text_for_a_formula(tmp_path: Path, text: str) -> None:
    write_csv(tmp_path / "t.csv", [{"note": text, "gap": -0.5, "unit": "-"}])
    with (tmp_path / "t.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    kept = text.replace("\r", "\n")
    kept = kept if text.startswith("a") else "'" + kept
    assert row == {"note": kept, "gap": "-0.5", "unit": "-"}


def test_a_comma_in_a_text_stays_in_its_cell(tmp_path: Path) -> None:
    write_csv(tmp_path / "t.csv", [{"a": "x, y", "b": 1}])
    assert (tmp_path / "t.csv").read_bytes() == b'a,b\n"x, y",1\n'


@pytest.mark.parametrize(
    ("name", "columns"),
    [("lane_changes.csv", LANE_CHANGE_COLUMNS), ("triggers.csv", TRIGGER_COLUMNS)],
)
def test_events_are_headed_even_if_there_are_none(
    tmp_path: Path, name: str, columns: tuple[str, ...]
) -> None:
    write_trial_tables(tmp_path, [TrialRows({"participant": 1}, [])])
    text = (tmp_path / name).read_text(encoding="utf-8")
    assert text == ",".join(columns) + "\n"


def test_those_heads_are_the_ones_of_a_study_with_lane_changes() -> None:
    record = synthetic_record(length=2000.0)
    assert tuple(lane_change_rows(record)[0]) == LANE_CHANGE_COLUMNS
    assert tuple(trigger_rows(record)[0]) == TRIGGER_COLUMNS


def test_only_another_scenario_than_the_papers_has_a_table_of_its_own(
    tmp_path: Path,
) -> None:
    row = {"measure": "time_gap_mean", "value": math.nan, "unit": "s"}
    write_trial_tables(tmp_path, [TrialRows({"participant": 1}, [], scenario=[row])])
    text = (tmp_path / "scenario_measures.csv").read_text()
    assert text == "measure,value,unit\ntime_gap_mean,,s\n"
    write_trial_tables(tmp_path, [TrialRows({"participant": 1}, [])])
    assert not (tmp_path / "scenario_measures.csv").exists()
