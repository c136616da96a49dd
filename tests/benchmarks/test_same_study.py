"""Two folders of one study are told apart by digits or by more."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import same_study
from benchmarks.same_study import differences, largest_of_table
from costeer.records.columns import TrialRecord
from costeer.study.configuration import PUBLISHED_STUDY
from costeer.study.run import run_study

COLUMNS: dict[str, Any] = {
    "time": np.array([0.0, 1.0, 2.0]),
    "gain": np.array([1.0, np.nan, 4.0]),
    "mode": np.array(["a", "b", "b"]),
    "lane": np.ma.MaskedArray([1, 2, 3], mask=[False, True, False]),
}


def record(**columns: Any) -> TrialRecord:
    return TrialRecord({}, COLUMNS | columns)


def test_digits_are_shares_of_the_largest_value() -> None:
    other = record(gain=np.array([1.0, np.nan, 4.0 + 4e-9]))
    found = differences(record(), other)
    assert found.discrete == []
    assert found.shares["time"] == 0.0
    assert found.shares["gain"] == pytest.approx(1e-9)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mode", np.array(["a", "b", "c"])),
        ("lane", np.ma.MaskedArray([1, 2, 4], mask=[False, True, False])),
        ("lane", np.ma.MaskedArray([1, 2, 3], mask=[False, False, False])),
        ("gain", np.array([1.0, 2.0, 4.0])),
    ],
)
def test_more_than_digits_is_named(name: str, values: Any) -> None:
    assert differences(record(), record(**{name: values})).discrete == [name]


def test_another_length_is_named() -> None:
    short = record(time=np.array([0.0, 1.0]))
    assert differences(record(), short).discrete == ["time (length)"]


def test_tables(tmp_path: Path) -> None:
    one, other = tmp_path / "a.csv", tmp_path / "b.csv"
    one.write_text("name,value\nx,2.0\n")
    other.write_text("name,value\nx,2.0000002\n")
    assert largest_of_table(one, other) == pytest.approx(1e-7)
    other.write_text("name,value\ny,2.0\n")
    assert largest_of_table(one, other) == np.inf


def test_a_study_is_the_same_as_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = tmp_path / "study"
    settings = PUBLISHED_STUDY._replace(
        participants=1, conditions=("manual",), intention="scripted", length=300.0
    )
    run_study(made, settings, report=None)
    shutil.copytree(made, tmp_path / "twin")
    for table in ("tests", "pairs"):
        for folder in (made, tmp_path / "twin"):
            (folder / f"{table}.csv").write_text("value\n1\n")
    assert same_study.main([str(made), str(tmp_path / "twin")]) == 0
    assert "1 records, 0 differ in more than digits" in capsys.readouterr().out
