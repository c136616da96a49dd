from __future__ import annotations

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "statistics.md"


def test_examples_of_the_page_run(capsys: pytest.CaptureFixture[str]) -> None:
    codes = re.findall(r"^```python\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    for code in codes:
        exec(compile(code, str(PAGE), "exec"), {})
    printed = capsys.readouterr().out
    assert "within condition: F(6, 66)" in printed
    assert "Kendall's W of 11; F(6, 60)" in printed
