"""`costeer analyse` shows measures, reasons and notes, and refuses in one line."""

from __future__ import annotations

import json
from pathlib import Path

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
    assert "Lane changes: to -1 right, +1 left" in shown
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
