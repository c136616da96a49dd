"""`costeer drivers` lists, validates, plots, and tells δ of the pilot drivers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.loop.scenario import PILOT_SEED


def drivers(*options: str) -> int:
    return main(["drivers", *options])


def test_without_flags_it_lists_what_differs(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert drivers("--participants", "5", "--seed", "4") == 0
    shown = capsys.readouterr().out
    assert "5 virtual drivers, seed 4" in shown
    assert "arm.stiffness" in shown


def test_json_lists_each_driver(capsys: pytest.CaptureFixture[str]) -> None:
    assert drivers("--participants", "3", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert [driver["participant"] for driver in told["drivers"]] == [1, 2, 3]


def test_validation_prints_every_target_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plot = tmp_path / "new" / "drivers.svg"
    few = ("--participants", "2", "--jobs", "2")
    assert drivers("--validate", *few, "--plot", str(plot)) == 0
    shown = capsys.readouterr().out
    assert [f"M{n} " in shown for n in range(1, 13)] == [True] * 12
    assert "of 12 targets met" in shown
    assert "lane-change duration (yaw 0.5 deg), 50 % [s]" in shown
    assert plot.read_text(encoding="utf-8").startswith("<?xml")


def test_json_of_a_validation_has_no_nan(capsys: pytest.CaptureFixture[str]) -> None:
    assert drivers("--validate", "--participants", "1", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    by_name = {target["name"]: target for target in told["targets"]}
    assert by_name["M1"]["value"] > 0.0
    assert by_name["M2"]["value"] is None  # one driver has no spread
    assert by_name["M2"]["met"] is False


def test_the_threshold_comes_from_pilot_drivers(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert drivers("--threshold", "--participants", "1", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["seed"] == PILOT_SEED
    assert told["threshold"] == pytest.approx(2.0 * told["percentile"])
    assert drivers("--threshold", "--participants", "1") == 0
    assert "threshold, twice that" in capsys.readouterr().out


REFUSED = {
    "have a seed of their own": ("--threshold", "--seed", "3"),
    "name that ends in .svg": ("--plot", "drivers.png"),
    "0 is not allowed; give from 1": ("--participants", "0"),
    "-1 is not allowed; give at least 0": ("--seed", "-1"),
    "speed is 100.0; give a number from 12.0": ("--speed", "100"),
}


@pytest.mark.parametrize("message", REFUSED)
def test_bad_input_is_refused_in_one_line(
    message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert drivers(*REFUSED[message]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert told.count("\n") == 1


def test_a_figure_that_cannot_be_written_is_refused_before_driving(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert drivers("--plot", str(tmp_path / "file" / "drivers.svg")) == 2
    told = capsys.readouterr().err
    assert "choose a file that you may write" in told
    assert "manual trials" not in told
