"""Data of a session in the formats of other programs, read back by their readers."""

from __future__ import annotations

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from costeer.cli import main
from costeer.records.columns import COLUMNS
from costeer.records.record import read_record
from costeer.sessions.export import export_session
from costeer.sessions.session import Session
from costeer.study.plain_folder import people_of_records
from tests.sessions.made_up import made_up_session

pytestmark = pytest.mark.slow

MOTION = "sub-P01/ses-01/motion/sub-P01_ses-01_task-strongRapid"
NUM_TRIALS = 8
"""Of the made-up study that count."""


@pytest.fixture(scope="module")
def dataset(studied: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study as BIDS."""
    out = tmp_path_factory.mktemp("bids")
    export_session(studied, "bids", out)
    return out


def table(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, delimiter="\t"))


def errors_of(dataset: Path) -> set[str]:
    """Codes of the errors that the validator of BIDS finds."""
    program = shutil.which("bids-validator-deno")
    if program is None:
        pytest.skip("bids-validator-deno is not installed; pip install it to check")
    found = subprocess.run(
        [program, str(dataset), "--format", "json"],
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
        env={**os.environ, "DENO_NO_UPDATE_CHECK": "1"},
    )
    issues: list[dict[str, Any]] = json.loads(found.stdout)["issues"]["issues"]
    return {each["code"] for each in issues if each["severity"] == "error"}


@pytest.mark.slow  # the validator takes seconds to start
def test_the_validator_of_bids_finds_no_error(dataset: Path) -> None:
    assert errors_of(dataset) == set()


@pytest.mark.slow
def test_the_validator_would_find_one(dataset: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(dataset, broken)
    file = broken / f"{MOTION}_tracksys-wheel_motion.json"
    about = json.loads(file.read_text())
    del about["SamplingFrequency"]
    file.write_text(json.dumps(about))
    assert errors_of(broken)


def test_a_dataset_holds_motion_answers_and_sources(dataset: Path) -> None:
    motions = sorted(dataset.glob("sub-*/ses-01/motion/*_motion.tsv"))
    assert len(motions) == NUM_TRIALS
    people = [row["participant_id"] for row in table(dataset / "participants.tsv")]
    assert people == ["sub-P01", "sub-P02", "sub-P03", "sub-P04"]
    ages = [float(row["age"]) for row in table(dataset / "participants.tsv")]
    assert ages == [21.0, 22.0, 23.0, 24.0]
    beh = dataset / "sub-P01/ses-01/beh/sub-P01_ses-01_task-questionnaires_beh.tsv"
    assert len(table(beh)) == 3 + 2 + 3 * 21
    assert len(list(dataset.glob("sourcedata/sub-*/*.parquet"))) == NUM_TRIALS
    derived = {file.name for file in (dataset / "derivatives/costeer").iterdir()}
    assert {"trials.csv", "exclusions.csv", "codebook.csv", "events.csv"} <= derived


def test_channels_hold_the_numbers_of_the_record(studied: Path, dataset: Path) -> None:
    channels = table(dataset / f"{MOTION}_tracksys-wheel_channels.tsv")
    text = (dataset / f"{MOTION}_tracksys-wheel_motion.tsv").read_text("utf-8")
    cells = [line.split("\t") for line in text.splitlines()]
    record = read_record(studied / "records/P01-drive-strong-rapid.parquet")
    assert [each["name"] for each in channels] == [each.name for each in COLUMNS]
    assert len(cells) == record.columns["time"].size
    names = [each["name"] for each in channels]
    for name in ("time", "lateral_position", "driver_torque"):
        values = [float(row[names.index(name)]) for row in cells]
        assert values == record.columns[name].tolist()
    modes = [row[names.index("mode")] for row in cells]
    codes = {"manual": "0.0", "lane_keeping": "1.0", "lane_changing": "2.0"}
    assert modes == [codes[mode] for mode in record.columns["mode"].tolist()]
    (mode,) = [each for each in channels if each["name"] == "mode"]
    assert "2: lane_changing" in mode["description"]


def test_pauses_are_events(dataset: Path) -> None:
    found = table(dataset / f"{MOTION}_events.tsv")
    assert [(row["onset"], row["trial_type"]) for row in found] == [
        ("10.0", "paused"),
        ("10.0", "resumed"),
        ("20.0", "paused"),
        ("20.0", "resumed"),
    ]


def test_matlab_reads_what_the_record_holds(studied: Path, tmp_path: Path) -> None:
    export_session(studied, "matlab", tmp_path / "out")
    assert len(list((tmp_path / "out").glob("*.mat"))) == NUM_TRIALS
    file = tmp_path / "out" / "P01-strong-rapid.mat"
    found = loadmat(file, simplify_cells=True)
    record = read_record(studied / "records/P01-drive-strong-rapid.parquet")
    columns = found["columns"]
    assert np.array_equal(columns["time"], record.columns["time"])
    assert np.array_equal(columns["head_yaw"], record.columns["head_yaw"])
    consistent = columns["consistent"]
    wanted = np.ma.filled(record.columns["consistent"].astype(float), np.nan)
    assert np.array_equal(consistent, wanted, equal_nan=True)
    manual = loadmat(tmp_path / "out" / "P01-manual.mat", simplify_cells=True)
    assert np.isnan(manual["columns"]["consistent"]).all()
    words = found["labels"]["mode"]
    modes = [words[int(code)] for code in columns["mode"]]
    assert modes == record.columns["mode"].tolist()
    assert found["units"]["driver_torque"] == "N·m"
    assert json.loads(str(found["metadata"]))["participant"] == "P01"


@pytest.mark.slow
def test_the_same_record_gives_the_same_bytes(tmp_path: Path) -> None:
    session = made_up_session(tmp_path / "s", ["P01"], ["manual", "weak-gentle"])
    session.close()
    for name in ("a", "b"):
        export_session(tmp_path / "s", "matlab", tmp_path / name)
    first, second = (tmp_path / name / "P01-manual.mat" for name in ("a", "b"))
    assert first.read_bytes() == second.read_bytes()
    assert b"Created on" not in first.read_bytes()[:128]


@pytest.mark.slow
def test_all_formats_come_into_folders_of_their_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "s", tmp_path / "out"
    made_up_session(folder, ["P01"], ["manual", "weak-gentle"]).close()
    given = ["session", "export", str(folder), "--format", "all", "--out", str(out)]
    assert main(given) == 0
    names = {"csv", "bids", "matlab", "mcap", "autoui"}
    assert {each.name for each in out.iterdir()} == names
    assert {each.name for each in (out / "mcap").iterdir()} == {
        "P01-manual.mcap",
        "P01-weak-gentle.mcap",
    }
    assert "2 trials" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["--format", "xdf", "--out", "{new}"], "--format is xdf; choose one of csv"),
        (["--out", "{used}"], "is not empty; give a new folder"),
        (["--out", "{inside}"], "within the study; give a folder outside"),
        ([], "give --out and a new folder"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(
    given: list[str],
    told: str,
    studied: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "old.csv").write_text("P09")
    places = {
        "{new}": str(tmp_path / "new"),
        "{used}": str(tmp_path / "used"),
        "{inside}": str(studied / "shared"),
    }
    words = [places.get(each, each) for each in given]
    assert main(["session", "export", str(studied), *words]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert len(error.splitlines()) == 1
    assert (tmp_path / "used" / "old.csv").read_text() == "P09"


def test_a_study_that_nobody_finished_still_gives_its_answers(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    made_up_session(folder, [], ["manual", "weak-gentle"]).close()
    session = Session(folder)
    session.begin("P01")
    session.note("P01", "a note")
    session.close()
    export_session(folder, "csv", tmp_path / "out")
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert "participants.csv" in names
    assert "trials.csv" not in names
    log = (tmp_path / "out" / "exclusions.csv").read_text("utf-8")
    assert log.count("not driven yet") == 2


@pytest.mark.slow
def test_the_trace_of_the_wheel_goes_along(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    session = made_up_session(folder, ["P01"], ["manual", "weak-gentle"])
    session.close()
    (folder / "records/P01-drive-manual.wheel.parquet").write_bytes(b"trace")
    export_session(folder, "bids", tmp_path / "out")
    kept = tmp_path / "out/sourcedata/sub-P01/P01-drive-manual.wheel.parquet"
    assert kept.read_bytes() == b"trace"
    attempts = tmp_path / "out/derivatives/costeer/attempts.csv"
    assert "records/P01-drive-manual.wheel.parquet" in attempts.read_text("utf-8")


def test_an_artifact_has_the_trials_that_count_and_a_report_can_be_made_of_them(
    studied: Path, tmp_path: Path
) -> None:
    export_session(studied, "autoui", tmp_path / "out")
    drives = people_of_records(tmp_path / "out").drives
    assert len(drives) == NUM_TRIALS
    assert {each.participant for each in drives} <= {"P01", "P02", "P03", "P04"}
    told = (tmp_path / "out" / "autoui-repro.yml").read_text("utf-8")
    assert all(f"records/{each.record.name}" in told for each in drives)
    published = {each.name for each in (tmp_path / "out" / "published").iterdir()}
    assert {"trials.csv", "questionnaires.csv", "exclusions.csv"} <= published
