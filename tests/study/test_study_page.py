"""docs/study.md: its Python runs, its commands exist, its table is the code's."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.methods.conditions import CONDITIONS, Condition
from costeer.records.record import read_record

PAGE = (Path(__file__).parents[2] / "docs" / "study.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_python_of_the_page_runs(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for block in blocks("python"):
        exec(compile(block, "docs/study.md", "exec"), {})
    assert capsys.readouterr().out.split() == ["2", "0", "2"]
    assert read_record("out/trial.parquet").metadata["condition"] == "weak-gentle"


@pytest.mark.parametrize("command", ["study", "report"])
def test_every_option_of_the_page_is_known(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main([command, "--help"])
    shown = capsys.readouterr().out
    lines = [shlex.split(line) for block in blocks("sh") for line in block.splitlines()]
    own = [line for line in lines if line[:2] == ["costeer", command]]
    used = {word for line in own for word in line if word.startswith("--")}
    assert used
    assert [option for option in sorted(used) if option not in shown] == []
    if command == "study":
        told = set(re.findall(r"^\| `(--[a-z-]+)", PAGE, re.MULTILINE))
        assert used <= told
        assert [option for option in sorted(told) if option not in shown] == []


@pytest.mark.parametrize("each", CONDITIONS[1:], ids=lambda each: each.name)
def test_the_table_of_conditions_is_that_of_the_code(each: Condition) -> None:
    row = (
        f"| `{each.name}` | {each.strength_factor:.1f} | {each.change_duration:.0f} s |"
    )
    assert row in PAGE
