"""The examples of docs/datasets.md run, and the page tells what the code does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from costeer.intention.features import VARIANTS
from costeer.training.datasets.catalogue import DATASETS, FILES, read_dataset
from tests.training.datasets.test_sets import WRITERS

PAGE = (Path(__file__).parents[3] / "docs" / "datasets.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_loader_of_the_page_runs_and_prints_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}  # Any: whatever the page defines
    for block in blocks("python"):
        exec(compile(block, "docs/datasets.md", "exec"), names)
    assert capsys.readouterr().out == blocks("text")[-1]


def test_the_loader_of_the_page_has_about_20_lines() -> None:
    body = blocks("python")[0].partition("def read")[2]
    assert len(body.splitlines()) <= 26


@pytest.mark.parametrize("name", DATASETS)
def test_the_page_names_files_absent_signals_and_network(
    tmp_path: Path, name: str
) -> None:
    assert all(file in blocks("text")[0] for file in FILES[name])
    WRITERS[name](tmp_path, 2 if name == "ngsim_i80_following" else 1)
    absent = read_dataset(name, tmp_path)[0].absent
    row = next(x for x in PAGE.splitlines() if x.startswith(f"| `{name}`"))
    told, variant = (cell.strip() for cell in row.split("|")[5:7])
    named = tuple(re.findall(r"`(\w+)`", told))
    kept = told.startswith("all but")
    assert not set(named) & set(absent) if kept else set(named) == set(absent)
    assert set(VARIANTS[variant.strip("`")]) == set(absent)
