"""The example of docs/drivers.md runs, and its table is that of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.drivers.population import POPULATIONS
from costeer.validation.targets import TARGETS

PAGE = Path(__file__).parents[2] / "docs" / "drivers.md"


def test_example_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    exec(compile(code, str(PAGE), "exec"), {})
    assert re.search(r"N·m/rad, reliance 0\.\d\d\nplans", capsys.readouterr().out)


@pytest.mark.parametrize("domain", TARGETS)
def test_the_page_shows_every_target_with_its_range(domain: str) -> None:
    text = PAGE.read_text("utf-8")
    for target in TARGETS[domain]:
        row = f"| {target.name} | {target.quantity} [{target.unit}] | "
        assert f"{row}{target.low:g} to {target.high:g} |" in text


def test_the_page_names_every_population() -> None:
    text = PAGE.read_text("utf-8")
    for population in POPULATIONS.values():
        assert f"| `{population.name}` | {population.version} |" in text
