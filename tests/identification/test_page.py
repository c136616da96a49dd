"""The example of docs/fit.md runs, and its tables name what the code estimates."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.identification.parameters import NOT_IDENTIFIED, STEERING
from costeer.identification.recording import NEEDED

PAGE = (Path(__file__).parents[2] / "docs" / "fit.md").read_text("utf-8")


@pytest.mark.slow  # fits a driver
def test_the_example_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
    exec(compile(code, "docs/fit.md", "exec"), {})
    printed = capsys.readouterr().out
    assert re.search(r"^arm\.stiffness \d", printed, re.M)
    assert "reliance.*: acts on guidance only" in printed


def test_the_page_has_a_row_for_each_parameter_and_names_the_columns() -> None:
    for parameter in STEERING:
        assert f"| `{parameter.name}` |" in PAGE
    for name in NEEDED:
        assert f"`{name}`" in PAGE


def test_every_recovery_on_the_page_is_what_is_required() -> None:
    counts = re.findall(r"\| (\d+) of 100 \|", PAGE)
    assert len(counts) == len(STEERING) + 4
    assert all(int(count) >= 90 for count in counts)


def test_what_is_held_is_named_on_the_page() -> None:
    for each in NOT_IDENTIFIED:
        for name in re.findall(r"\.(\w+)", each.name):
            assert f"{name}`" in PAGE
