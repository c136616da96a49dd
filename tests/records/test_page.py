"""docs/records.md says what records hold."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.records.metadata import CLOCK_FIELDS, METADATA_FIELDS
from costeer.records.record import write_record
from tests.records.make_columns_table import PAGE, TABLE, columns_table
from tests.study.synthetic import synthetic_record

TEXT = PAGE.read_text("utf-8")


def test_the_table_is_that_of_the_declared_columns() -> None:
    (table,) = TABLE.findall(TEXT)
    assert table == columns_table(), "run: python -m tests.records.make_columns_table"


def test_every_field_of_the_description_is_explained_once() -> None:
    _, _, text = TEXT.partition("## Description")
    told = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    plugged = ("method_version", "method_source_hash", "predictor", "torque_faults")
    plugged = (*plugged, "network_form", "scenario", "mistakes")
    plugged = (*plugged, "other_cars", "outcome")
    some = ("markers", "intention_source", "head_tracker", "study_hash")
    wanted = sorted((*METADATA_FIELDS, *CLOCK_FIELDS, *plugged, *some))
    assert sorted(re.findall(r"`(\w+)`", " ".join(told))) == wanted


def test_the_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("out").mkdir()
    write_record("out/trial.parquet", synthetic_record("weak-normal", length=900.0))
    (example,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    exec(compile(example, "docs/records.md", "exec"), {})
    # 900 m at 70 km/h, 60 rows a second.
    assert capsys.readouterr().out == "weak-normal 2777\n"
