"""docs/python.md and the notebook run as `__main__`, from first block to last."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import costeer

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text("utf-8")
NOTEBOOK = json.loads((ROOT / "examples" / "first_hour.ipynb").read_text("utf-8"))

RUN = """
import json, sys
for number, block in enumerate(json.load(sys.stdin)):
    exec(compile(block, f"block {number}", "exec"))
"""


def run(blocks: list[str], folder: Path) -> str:
    """What blocks of code print when a new interpreter runs them in order."""
    done = subprocess.run(
        [sys.executable, "-c", RUN],
        input=json.dumps(blocks),
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_the_python_of_the_page_runs(tmp_path: Path) -> None:
    printed = run(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL), tmp_path)
    assert printed.startswith("<costeer record: participant 3, strong-normal, ibhs")
    assert printed.splitlines()[-2:] == ["rad/s", "4 out/pilot"]
    assert (tmp_path / "trial.svg").stat().st_size > 0


def test_the_page_names_all_that_is_public() -> None:
    table = PAGE.partition("The import takes")[0]
    told = set(re.findall(r"`(\w+)(?:\([^`]*\))?`", table))
    assert set(costeer.__all__) - {"__version__"} <= told


@pytest.mark.slow
def test_the_notebook_runs_cell_by_cell(tmp_path: Path) -> None:
    cells = [c for c in NOTEBOOK["cells"] if c["cell_type"] == "code"]
    printed = run(["".join(cell["source"]) for cell in cells], tmp_path)
    assert printed.splitlines()[0] == "N·m"
    assert (tmp_path / "out" / "first-hour" / "trials.csv").is_file()


def test_the_notebook_is_kept_without_outputs() -> None:
    cells = [c for c in NOTEBOOK["cells"] if c["cell_type"] == "code"]
    assert [c["outputs"] for c in cells] == [[]] * len(cells)
