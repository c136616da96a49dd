"""The code of docs/export.md runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.export.mcap import write_mcap
from tests.study.synthetic import synthetic_record

PAGE = Path(__file__).parents[2] / "docs" / "export.md"


@pytest.mark.slow
def test_the_code_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = synthetic_record("weak-normal", length=300.0)
    (tmp_path / "out").mkdir()
    write_mcap(record, tmp_path / "out" / "trial.mcap")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    assert len(blocks) == 3
    names: dict[str, list[float]] = {}
    for block in blocks:
        exec(block, names)
    assert (tmp_path / "out" / "guidance.fmu").stat().st_size > 0
    assert names["gains"] == record.columns["haptic_gain"].tolist()
