"""`costeer analyse` shows measures, reasons and notes, and refuses in one line."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pandas as pd
import pytest

from costeer.cli import main
from costeer.records.record import write_record
from tests.study.synthetic import synthetic_record

EXAMPLES = Path(__file__).parents[2] / "examples" / "steering"
COMMA = [
    "analyse",
    str(EXAMPLES / "comma2k19.csv"),
    "--rename",
    "t=time",
    "--rename",
    "steering_angle_deg=steering_wheel_angle",
]


def test_a_foreign_table_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*COMMA, "--scale", "steering_wheel_angle=0.0174533"]) == 0
    shown, notes = capsys.readouterr()
    assert "comma2k19.csv: 30.0 s at 82.9" in shown
    assert "swrr" in shown
    assert "not computed: driver_torque_rms: needs the column driver_torque" in shown
    assert "comma2k19.csv: unevenly sampled" in notes


def test_a_trial_record_shows_its_lane_changes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_record(tmp_path / "t.parquet", synthetic_record(length=2500.0))
    assert main(["analyse", str(tmp_path / "t.parquet")]) == 0
    shown = capsys.readouterr().out
    table = shown[shown.index("Lane changes") :].splitlines()
    assert all(unit in table[2] for unit in ("rms deg/s", "peak deg"))
    assert "right" in table[4]
    assert "left" in table[5]
    (speed,) = (line for line in shown.splitlines() if "mean_speed" in line)
    assert "km/h" in speed
    assert "num_lane_changes" in shown


def test_json_is_one_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*COMMA, "--json", "--cutoff", "0", "--gap-deg", "1"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert entry["measures"]["swrr"]["value"] > 0
    assert entry["measures"]["sdlp"]["value"] is None
    assert any("looks like degrees" in n or "unevenly" in n for n in entry["notes"])


def test_several_files_follow_each_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.csv").write_text("time,yaw_angle\n0,0\n0.1,0\n")
    (tmp_path / "b.csv").write_text("time,yaw_angle\n0,0\n0.1,0\n")
    assert main(["analyse", str(tmp_path / "a.csv"), str(tmp_path / "b.csv")]) == 0
    shown = capsys.readouterr().out
    assert shown.index("a.csv") < shown.index("b.csv")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--rename", "t"], "--rename t: write it as name=value"),
        (["--rename", "t=time"], "this name is given twice"),
        (["--rename", "speed=time"], "this name is given twice"),
        (["--scale", "time=fast"], "--scale time=fast: fast is no number"),
        (["--scale", "time=1", "--scale", "time=2"], "this name is given twice"),
        (["--cutoff", "-1"], "-1.0 is not allowed; give at least 0 Hz"),
        (["--gap-deg", "nan"], "nan is not allowed; give above 0 deg"),
        (["--sequence", "part"], "--sequence part: there is no such column"),
    ],
)
def test_bad_options_are_refused_in_one_line(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*COMMA, *words]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert shown.out == ""
    assert len(shown.err.splitlines()) == 1


def test_a_broken_file_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_record(tmp_path / "t.parquet", synthetic_record(length=900.0))
    whole = (tmp_path / "t.parquet").read_bytes()
    (tmp_path / "t.parquet").write_bytes(whole[: len(whole) // 2])
    assert main(["analyse", str(tmp_path / "t.parquet")]) == 2
    shown = capsys.readouterr()
    assert "was cut short" in shown.err
    assert len(shown.err.splitlines()) == 1


def test_a_missing_file_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["analyse", str(tmp_path / "none.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err


LAB = """
names: {Zeit: time, Lenkwinkel: steering_wheel_angle, v: longitudinal_velocity}
units: {steering_wheel_angle: deg, longitudinal_velocity: km/h}
flip: [steering_wheel_angle]
separator: semicolon
decimal: comma
encoding: cp1252
"""


def lab_drives(folder: Path) -> Path:
    """Two drives in the words of a laboratory, and its file of names."""
    folder.mkdir()
    lines = [f"{k / 20};{30 * math.sin(k / 20)};72.0;aus" for k in range(400)]
    text = "Zeit;Lenkwinkel;v;Wähler\n" + "\n".join(lines).replace(".", ",")
    for name in ("a.txt", "b.CSV"):
        (folder / name).write_bytes(text.encode("cp1252"))
    (folder.parent / "lab.yaml").write_text(LAB)
    return folder.parent / "lab.yaml"


def test_a_file_of_names_says_names_units_signs_and_marks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lab = lab_drives(tmp_path / "drives")
    file = str(tmp_path / "drives" / "a.txt")
    assert main(["analyse", file, "--map", str(lab), "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert entry["measures"]["mean_speed"]["value"] == pytest.approx(20.0)
    assert entry["measures"]["swrr"]["value"] == pytest.approx(19.1, abs=1.5)
    assert not any("read as text" in note for note in entry["notes"])


def test_a_folder_gives_a_table_with_a_row_for_each_drive(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lab = lab_drives(tmp_path / "drives")
    words = ["analyse", str(tmp_path / "drives"), "--map", str(lab)]
    out = tmp_path / "table.csv"
    assert main([*words, "--out", str(out)]) == 0
    table = pd.read_csv(out)
    assert [Path(file).name for file in table["file"]] == ["a.txt", "b.CSV"]
    assert table["mean_speed"].tolist() == pytest.approx([20.0, 20.0])
    (tmp_path / "drives" / "c.csv").write_text("PK")
    assert main([*words, "--out", str(out)]) == 2
    assert "2 drives, 1 files not read" in capsys.readouterr().err
    table = pd.read_csv(out)
    assert len(table) == 3
    assert "c.csv" in table["error"][2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nomen: {}", "there is no field 'nomen'; choose from names"),
        ("names: [a]", "names: give NAME: VALUE lines"),
        ("names: {a: time, b: time}", "time is given twice"),
        ("units: {time: fortnights}", "fortnights is not known; give one of deg"),
        ("scale: {time: fast}", "fast is no factor"),
        ("a: [", "is not YAML"),
        ("3", "has no fields"),
        ("separator: ab", "--separator ab: give one letter"),
    ],
)
def test_a_bad_file_of_names_is_refused_in_one_line(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "lab.yaml").write_text(text)
    assert main([*COMMA, "--map", str(tmp_path / "lab.yaml")]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert len(shown.err.splitlines()) == 1
