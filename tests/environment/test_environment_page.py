"""docs/environment.md runs as it stands, and so does the example that it names."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("gymnasium", reason="the extra gym is not installed")

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "environment.md").read_text("utf-8")


def test_the_python_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(code, "docs/environment.md", "exec"), {})
    assert 0.0 < float(capsys.readouterr().out) < 1.0


@pytest.mark.slow
def test_the_example_learns() -> None:
    example = "examples/agents/keep_lane.py"
    assert example in PAGE
    words = [sys.executable, str(ROOT / example), "3"]
    run = subprocess.run(words, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    start, found = map(float, re.findall(r"(\d+\.\d+) s", run.stdout))
    assert found > start
