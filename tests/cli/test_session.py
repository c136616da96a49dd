"""`costeer session`: what it says before anybody takes part."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main

BENDS = "has bends, and the network that comes with costeer has seen straight roads"


@pytest.mark.parametrize(
    "words", [["power"], ["status"], ["run", "--wheel", "simulated:keys"]]
)
def test_a_folder_without_a_study_says_how_to_make_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    folder = tmp_path / "study"
    assert main(["session", words[0], str(folder), *words[1:]]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert f"no plan.yaml in it; make one with: costeer session new {folder}" in said
    assert not folder.exists()


@pytest.mark.parametrize(
    ("intention", "where", "is_told"),
    [
        ("network", "expressway-curves", True),
        ("network", "expressway", False),
        ("indicator", "expressway-curves", False),
    ],
)
def test_a_plan_on_a_road_with_bends_says_what_the_network_makes_of_it(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    intention: str,
    where: str,
    is_told: bool,
) -> None:
    plan = tmp_path / "mine.yaml"
    plan.write_text(
        f"title: Bends\nintention: {intention}\nsteps:\n"
        f"  - {{kind: drive, condition: weak-normal, scenario: {where}}}\n"
    )
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 0
    said = " ".join(capsys.readouterr().err.split())
    assert (f"{where} {BENDS}" in said) == is_told
