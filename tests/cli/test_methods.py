"""`costeer methods` lists what `--method` takes, and says what cannot be used."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from costeer.cli import main
from costeer.comparison.catalogue import LAWS
from costeer.methods.interface import Method, Tunable
from costeer.methods.registry import METHODS
from costeer.records.columns import Column
from tests.architecture.source import ROOT
from tests.methods.rivals import FILE
from tests.methods.test_plug_ins import installed

POINTS = """[costeer.methods]
pi = listed_module:METHOD
gone = listed_nowhere:METHOD
"""


def listed(capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, Any]]:
    assert main(["methods", "--json"]) == 0
    return {each["name"]: each for each in json.loads(capsys.readouterr().out)}


def test_every_method_of_costeer_has_its_line() -> None:
    assert list(LAWS) == list(METHODS)
    # The guide has them in the same order.
    text = (ROOT / "docs" / "methods.md").read_text("utf-8")
    table = text.partition("our additions")[2].partition("None of the twelve")[0]
    assert re.findall(r"^\| `([a-z-]+)` \|", table, re.MULTILINE) == list(METHODS)


def test_it_says_what_a_method_must_be_told(capsys: pytest.CaptureFixture[str]) -> None:
    found = listed(capsys)
    # docs/methods.md: trigger and paths of these three are those of the paper.
    assert {n for n, each in found.items() if each["intention"]} == {
        "ibhs",
        "pseudo-work",
        "traded",
    }
    assert {n for n, each in found.items() if each["indicator"]} == {
        "indicator",
        "indicator-acsf",
    }


@pytest.mark.slow
def test_plug_ins_are_listed_and_those_that_fail_say_why(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    shutil.copy(FILE, tmp_path / "listed_module.py")
    installed(tmp_path, "rivals", POINTS)
    monkeypatch.syspath_prepend(tmp_path)
    found = listed(capsys)
    assert found["pi"]["place"] == "listed_module:METHOD"
    assert found["pi"]["law"].startswith("Lane keeping with an integrator")
    assert "no module 'listed_nowhere'" in found["gone"]["failure"]
    assert main(["methods"]) == 0
    shown = capsys.readouterr()
    assert "listed_module:METHOD" in shown.out
    assert "gone" not in shown.out
    assert shown.err.startswith("costeer: gone (listed_nowhere:METHOD) cannot be used")


def test_plug_ins_of_one_name_do_not_hide_the_others(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for package in ("one", "two"):
        points = f"[costeer.methods]\nsame = {package}:METHOD\n"
        installed(tmp_path, package, points)
    monkeypatch.syspath_prepend(tmp_path)
    found = listed(capsys)
    assert found["ibhs"]["failure"] == ""
    assert "one:METHOD and two:METHOD; remove" in found["same"]["failure"]


def test_one_method_is_shown_with_its_own_parameters(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["methods", "--method", str(FILE), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    own = [(each["name"], each["unit"]) for each in told["parameters"]]
    # The fields of its parameters, with the units of their docstring.
    assert own == [
        ("controller.lane_width", "m"),
        ("controller.strength", "-"),
        ("controller.offset", "N·m/m"),
        ("controller.yaw", "N·m/rad"),
        ("controller.integral", "N·m/(m·s)"),
        ("controller.limit", "N·m"),
    ]
    assert {each["of"] for each in told["parameters"]} == {"method"}


def test_a_parameter_without_a_unit_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    silent = FILE.read_text("utf-8").replace("\n    Attributes:", "\n    Numbers:")
    (tmp_path / "silent_rival.py").write_text(silent, "utf-8")
    assert main(["methods", "--method", str(tmp_path / "silent_rival.py")]) == 0
    shown = capsys.readouterr()
    # The unit of a tunable serves where the docstring has none.
    assert "N·m/m" in shown.out
    assert "names no unit of controller.lane_width, controller.strength, " in shown.err
    assert "controller.offset" not in shown.err


def test_a_name_that_is_no_method_is_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["methods", "--method", "ibsh"]) == 2
    assert "did you mean ibhs?" in capsys.readouterr().err


@pytest.mark.parametrize("kind", [Method, Column, Tunable])
def test_the_guide_names_every_field(kind: Any) -> None:  # Any: a named tuple
    text = (ROOT / "docs" / "plug-ins.md").read_text("utf-8")
    table = text.partition(f"| field of `{kind.__name__}` |")[2].partition("\n\n")[0]
    names = set(re.findall(r"`(\w+)`", table))
    # What a column was in older files is no affair of a plug-in.
    assert set(kind._fields) - {"before"} <= names
