"""What docs/scale.md shows in Python runs, and its commands are commands."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from costeer.cli import CommandGroup

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "scale.md").read_text("utf-8")


def test_its_commands_are_commands() -> None:
    named = re.findall(r"^costeer (\S+)", PAGE, re.MULTILINE)
    assert named
    assert set(named) <= set(CommandGroup.summaries)


@pytest.mark.slow
def test_its_python_runs(tmp_path: Path) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert len(blocks) == 2
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(blocks)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
