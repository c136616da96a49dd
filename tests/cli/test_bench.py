"""`costeer bench` prints machine, figures and what was skipped."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.speed.timing import FULL, QUICK, Effort, Figure, Outcome, Skipped
from costeer.cli import bench, main

ASKED: list[Effort] = []
MEASURED = bench._measure


@pytest.fixture(autouse=True)
def without_measuring(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made-up figures instead of a minute of work."""

    def measured(effort: Effort) -> Outcome:
        ASKED.append(effort)
        return [
            Figure("control step", "control step, p99", "us", 1.1, 1.0, 1234.5, "kept"),
            Skipped("plant", "highway-env", "not installed"),
        ]

    ASKED.clear()
    monkeypatch.setattr(bench, "_measure", measured)


def test_the_table_has_median_and_spread(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench"]) == 0
    shown = capsys.readouterr().out
    assert "processor" in shown
    assert all(word in shown for word in ("control step, p99", "1.1", "1234", "kept"))
    assert "skipped: highway-env: not installed" in shown
    assert "compilation" in shown
    assert ASKED == [FULL]


def test_json_holds_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--quick", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["figures"][0]["median"] == 1.1
    assert told["skipped"][0]["name"] == "highway-env"
    assert told["machine"]["cores"] >= 1
    assert ASKED == [QUICK]


def test_an_install_without_benchmarks_says_where_they_are(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bench, "CHECKOUT", tmp_path)
    assert main(["bench", "--quick"]) == 2
    told = capsys.readouterr().err
    assert str(tmp_path) in told
    assert "clone the repository" in told
    assert ASKED == []


def test_every_group_is_measured_once_in_its_order(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []
    for place in (
        "control.measure_control_step",
        "control.measure_network",
        "trials.measure_trials",
        "trials.measure_engines",
        "peers.measure_peers",
        "start.measure_start",
    ):

        def measure(effort: Effort, place: str = place) -> Outcome:
            asked.append((place, effort))
            return [Skipped("", place, "")]

        monkeypatch.setattr(f"benchmarks.speed.{place}", measure)
    outcome = MEASURED(QUICK)
    assert [(found.name, QUICK) for found in outcome] == asked
    assert len(asked) == 6
    assert "measuring: start" in capsys.readouterr().err
