"""The examples of docs/measures.md run, and its tables name columns that exist."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.records.columns import COLUMN_NAMES
from costeer.study.measures import lane_change_rows, trial_row, trigger_rows
from costeer.study.traffic import ACCEPTED, NEARNESS
from tests.study.synthetic import synthetic_record

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "measures.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_commands_of_the_page_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) == 2
    for command in commands:
        assert main(shlex.split(command)[1:]) == 0
    assert capsys.readouterr().out.count("swrr") == 2


@pytest.mark.parametrize("block", blocks("python"))
def test_the_python_of_the_page_runs(
    block: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(block, "docs/measures.md", "exec"), {})


def test_the_page_describes_every_column() -> None:
    record = synthetic_record(length=2500.0)
    columns = {*trial_row(record), *lane_change_rows(record)[0]}
    columns |= set(trigger_rows(record)[0])
    identity = {"participant", "condition", "strength", "change_duration", "order"}
    described = set(re.findall(r"`(\w+)`", PAGE))
    assert columns - identity - described == set()


def test_the_terms_of_the_practice_name_what_is_measured() -> None:
    section = PAGE.partition("## Names of SAE J2944")[2].partition("\n## ")[0]
    rows = [line.split("|")[2] for line in re.findall(r"^\| .*", section, re.MULTILINE)]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    record = synthetic_record(length=2500.0)
    known = {*trial_row(record), *lane_change_rows(record)[0], *COLUMN_NAMES}
    known |= {*NEARNESS, *ACCEPTED}
    assert len(rows) == 9  # one of them the head
    assert len(named) == 13
    assert named - known == set()
