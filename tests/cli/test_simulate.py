"""`costeer simulate` writes a record, tells what happened, refuses in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main
from costeer.cli.trial_summary import number, print_summary
from costeer.records.record import read_record, write_record
from tests.study.synthetic import synthetic_record

# 100 m take 5 s; the Python engine needs no compilation.
SHORT = ["--length", "100", "--engine", "python", "--intention", "scripted"]


def simulate(out: Path, *options: str) -> int:
    return main(["simulate", "--out", str(out), *SHORT, *options])


def test_a_trial_leaves_its_record_and_a_summary(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "trial.parquet"
    assert simulate(out, "--condition", "weak-gentle", "--participant", "3") == 0
    about = read_record(out).metadata
    assert (about["condition"], about["participant"]) == ("weak-gentle", 3)
    assert (about["strength_factor"], about["change_duration"]) == (0.4, 8.0)
    shown = capsys.readouterr().out
    assert "participant 3, weak-gentle" in shown
    assert shown.endswith(f"{out}\n")


def test_the_same_options_give_the_same_bytes_and_others_replace_them(
    tmp_path: Path,
) -> None:
    first, second = tmp_path / "a.parquet", tmp_path / "b.parquet"
    assert simulate(first, "--seed", "1") == simulate(second, "--seed", "1") == 0
    assert first.read_bytes() == second.read_bytes()
    assert simulate(second, "--seed", "2") == 0
    assert read_record(second).metadata["seed"] == 2


@pytest.mark.slow
def test_manual_driving_has_no_guidance(tmp_path: Path) -> None:
    assert simulate(tmp_path / "m.parquet", "--condition", "manual") == 0
    record = read_record(tmp_path / "m.parquet")
    assert not record.columns["applied_torque"].any()
    assert record.metadata["method"] == "manual"


def test_the_system_changes_lanes_when_told(tmp_path: Path) -> None:
    out = tmp_path / "t.parquet"
    hands_off = ("--driver", "hands-off", "--no-events", "--initial-offset", "0.3")
    assert simulate(out, *hands_off, "--trigger-at", "1", "--trigger-at", "4") == 0
    record = read_record(out)
    assert record.columns["lateral_position"][0] == pytest.approx(0.3, abs=0.01)
    assert (record.columns["mode"] == "lane_changing").any()


def test_a_person_s_trial_is_never_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "p.parquet"
    record = synthetic_record(length=1000.0)
    about = {**record.metadata, "driver_kind": "person"}
    write_record(out, record._replace(metadata=about))
    before = out.read_bytes()
    assert simulate(out) == 2
    assert "exists and is not a simulated trial" in capsys.readouterr().err
    assert out.read_bytes() == before


def test_another_file_is_never_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "thesis.tex").write_text("years")
    assert simulate(tmp_path / "thesis.tex") == 2
    assert simulate(tmp_path) == 2
    assert (tmp_path / "thesis.tex").read_text() == "years"
    assert capsys.readouterr().err.count("choose another --out") == 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--condition", "strong"], "unknown condition 'strong'"),
        (["--speed", "nan"], "speed is nan"),
        (["--length", "-1"], "length is -1"),
        (["--trigger-at", "nan"], "trigger time nan"),
        (["--trigger-at", "5", "--condition", "manual"], "choose an assisted"),
        (["--initial-offset", "9"], "initial_offset is 9"),
        (["--driver", "robot"], "driver 'robot'"),
        (["--participant", "-1"], "participant is -1"),
        (["--engine", "steam"], "steam"),
    ],
)
def test_a_wrong_option_is_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    message: str,
) -> None:
    assert simulate(tmp_path / "t.parquet", *options) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert message in said[0]
    assert not list(tmp_path.iterdir())


def test_lane_changes_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    print_summary(synthetic_record("strong-rapid", length=2000.0))
    shown = capsys.readouterr().out
    assert "right" in shown
    assert "left" in shown


def test_what_is_undefined_is_a_dash() -> None:
    assert number(float("nan"), 2) == number(None, 2) == "-"
    assert number(1.234, 2) == "1.23"


def test_a_device_is_refused_without_being_read(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "endless.parquet"
    out.symlink_to("/dev/zero")  # reading it would fill the memory
    assert simulate(out) == 2
    assert "exists and is not a simulated trial" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["trial.csv", "trial", "trial.parquet.gz"])
def test_a_name_that_is_not_of_parquet_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert simulate(tmp_path / name) == 2
    assert "give a name that ends in .parquet" in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


def test_a_lane_change_after_the_end_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "t.parquet"
    assert simulate(out, "--trigger-at", "3", "--trigger-at", "900") == 0
    told = capsys.readouterr().err
    assert "--trigger-at 900 had no effect: the trial ended after 5." in told


def test_a_count_out_of_range_has_no_unit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert simulate(tmp_path / "t.parquet", "--participant", "-3") == 2
    assert capsys.readouterr().err.endswith("give a number from 1 to 10000000\n")
