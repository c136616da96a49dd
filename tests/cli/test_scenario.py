"""`costeer scenario`, and `--scenario` of the commands that drive."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main
from costeer.records.record import read_record
from costeer.scenarios.opendrive.roads import read_road
from costeer.scenarios.reading import read_scenario, shipped
from tests.scenarios.roads import road, write

Captured = pytest.CaptureFixture[str]
SHORT = ["--engine", "python", "--intention", "scripted"]
BEND = (
    '<geometry s="0" x="0" y="0" hdg="0" length="400">'
    '<arc curvature="0.01"/></geometry>'
)

OWN = """\
name: own
speed: 60 km/h
road:
  length: 250
  traffic: right
  stations:
    - {at: 0, radius: 400}
actors:
  - {name: slow, lane: 0, at: 60, speed: 50 km/h, follows: true}
"""


def test_the_list_has_what_ships(capsys: Captured) -> None:
    assert main(["scenario", "list"]) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in shipped())


def test_what_is_shown_can_be_run(tmp_path: Path, capsys: Captured) -> None:
    assert main(["scenario", "show", "cut-in"]) == 0
    shown = capsys.readouterr().out
    assert "lane_width: 3.5" in shown  # which its file does not say
    (tmp_path / "again.yaml").write_text(shown)
    assert read_scenario(tmp_path / "again.yaml").actors[1].name == "second"


@pytest.mark.slow
def test_a_preview_is_a_picture_with_text(tmp_path: Path, capsys: Captured) -> None:
    first, second = tmp_path / "a.svg", tmp_path / "b" / "b.svg"
    for file in (first, second):
        assert (
            main(["scenario", "preview", "expressway-curves", "--out", str(file)]) == 0
        )
    text = first.read_text("utf-8")
    assert text == second.read_text("utf-8")
    assert "left-500" in text
    assert "R 1500 m" in text
    assert (
        main(["scenario", "preview", "cut-in", "--out", str(tmp_path / "c.png")]) == 2
    )
    assert "ends in .svg" in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--from", "dense-traffic"]])
def test_a_new_file_is_sound_and_never_replaces(
    options: list[str], tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "2 My Road.yaml"
    assert main(["scenario", "new", str(file), *options]) == 0
    assert read_scenario(file).name == "my-road"
    assert main(["scenario", "new", str(file)]) == 2
    assert "is there already" in capsys.readouterr().err


def test_a_road_of_a_file_is_driven_as_fast_as_it_allows(
    tmp_path: Path, capsys: Captured
) -> None:
    file, made = write(tmp_path, road(BEND)), tmp_path / "bend.yaml"
    asked = ["scenario", "new", str(made), "--opendrive", str(file)]
    assert main([*asked, "--speed", "90km/h"]) == 2
    # 25² / 3 = 208 m.
    assert "too tight for 90 km/h; give 208 m" in capsys.readouterr().err
    assert not made.exists()
    assert main([*asked, "--speed", "50km/h"]) == 0
    shown, first = capsys.readouterr().err, read_scenario(made).overtaking.first
    assert "m of the file's in every 100 m" in shown
    assert f"a slower car to overtake appears at {first:g} m; take" in shown
    made.unlink()
    assert main(asked) == 0
    # The left lane has 101.75 m: sqrt(3 * 101.75) is 62.9 km/h.
    assert read_scenario(made).speed == "60 km/h"


def test_an_exported_road_is_opendrive(tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "x.xodr"
    assert main(["scenario", "export", "cut-in", "--out", str(out)]) == 0
    assert "other cars and events are not in" in capsys.readouterr().err
    assert read_road(out).road.length == 3000.0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["lst"], "did you mean list?"),
        (["show"], "show needs a name or FILE.yaml"),
        (["show", "cutin"], "did you mean cut-in?"),
        (["show", "no.yaml"], "No such file"),
        (["list", "cut-in"], "list does not use TARGET"),
        (["preview", "cut-in"], "needs --out FILE.svg"),
        (["new", "a.txt"], "give FILE.yaml"),
        (["new", "a.yaml", "--road", "3"], "--road needs --opendrive"),
        (["new", "a.yaml", "--from", "cutin"], "did you mean cut-in?"),
        (["new", "a.yaml", "--from", "cut-in", "--opendrive", "b.xodr"], "not both"),
        (["new", "a.yaml", "--opendrive", "b.xodr"], "No such file"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    words: list[str], told: str, capsys: Captured
) -> None:
    assert main(["scenario", *words]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert len(said.splitlines()) == 1


@pytest.mark.slow
def test_a_file_of_ten_lines_is_driven_and_recorded(tmp_path: Path) -> None:
    file, out = tmp_path / "own.yaml", tmp_path / "a.parquet"
    file.write_text(OWN)
    words = ["simulate", "--out", str(out), "--scenario", str(file), *SHORT]
    assert main(words) == 0
    record = read_record(out)
    about = record.metadata["scenario"]
    assert isinstance(about, dict)
    assert about["name"] == "own"
    assert about["actors"][0]["name"] == "slow"
    assert record.metadata["speed"] == 60 / 3.6
    # It is 250 m long: so far the car came, at about 17 m/s.
    assert 10.0 < record.columns["time"][-1] < 25.0


def test_a_speed_that_the_curves_forbid_is_refused(
    tmp_path: Path, capsys: Captured
) -> None:
    words = ["simulate", "--out", str(tmp_path / "a.parquet"), *SHORT, "--scenario"]
    (tmp_path / "own.yaml").write_text(OWN.replace("400", "150"))
    assert main([*words, str(tmp_path / "own.yaml"), "--speed", "100km/h"]) == 2
    assert "too tight for 100 km/h" in capsys.readouterr().err
    assert main([*words, "cutin"]) == 2
    assert "did you mean cut-in?" in capsys.readouterr().err


def test_a_study_of_a_file_knows_its_content(tmp_path: Path, capsys: Captured) -> None:
    file, out = tmp_path / "own.yaml", tmp_path / "study"
    file.write_text(OWN)
    words = ["study", "--out", str(out), "--scenario", str(file), "--no-report"]
    words += ["--participants", "1", "--conditions", "manual", "--jobs", "1"]
    words += ["--intention", "scripted"]
    assert main(words) == 0
    assert "scenario_content" in (out / "study.yaml").read_text("utf-8")
    capsys.readouterr()
    assert main(words) == 0
    assert "0 trials simulated, 1 were there" in capsys.readouterr().out
    file.write_text(OWN.replace("50 km/h", "45 km/h"))
    assert main(words) == 2
    assert "the scenario was edited (actors)" in capsys.readouterr().err
