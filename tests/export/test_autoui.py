"""A study that was exported as an artifact is made again by its own script."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from costeer.cli import main
from costeer.export.autoui import MANIFEST
from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import write_record
from costeer.study.configuration import StudySettings
from costeer.study.run import run_study
from tests.study.fakes import made_up
from tests.study.synthetic import synthetic_record

SETTINGS = StudySettings(
    participants=3, conditions=CONDITION_NAMES, intention="scripted", length=1800.0
)
KEYS = {
    "": {"version", "title", "environment", "paper", "data", "run"}
    | {"expected_outputs", "badges_claimed"},
    "environment": {"builder", "type", "dependencies", "r_packages", "image"},
    "run": {"steps", "network"},
    "data": {"path", "source", "checksum"},
    "steps": {"path", "kind", "runner", "args", "tool", "project", "tier"}
    | {"expected_outputs", "description"},
}
"""Names that version 1 of the manifest knows; it refuses all others."""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of virtual drivers, exported by the command."""
    room = tmp_path_factory.mktemp("shared")
    run_study(room / "study", SETTINGS, jobs=1, report=None, simulate=made_up)
    out = room / "out"
    words = ["export", str(room / "study"), "--to", "autoui", "--out", str(out)]
    assert main(words) == 0
    return out


# Any: a manifest as YAML gives it back.
def told(folder: Path) -> dict[str, Any]:
    """What the manifest of an artifact says."""
    found = yaml.safe_load((folder / MANIFEST).read_text("utf-8"))
    assert isinstance(found, dict)
    return found


def test_the_manifest_has_only_what_its_form_knows(shared: Path) -> None:
    manifest = told(shared)
    assert manifest["version"] == 1
    assert set(manifest) <= KEYS[""]
    for part in ("environment", "run"):
        assert set(manifest[part]) <= KEYS[part]
    for each in manifest["data"]:
        assert set(each) <= KEYS["data"]
    for each in manifest["run"]["steps"]:
        assert set(each) <= KEYS["steps"]
    assert manifest["environment"]["builder"] == "pinned-base"


def test_each_record_is_named_with_its_hash(shared: Path) -> None:
    listed = {each["path"]: each["checksum"] for each in told(shared)["data"]}
    there = sorted(f"records/{each.name}" for each in (shared / "records").iterdir())
    assert sorted(listed) == there
    assert len(there) == 3 * len(CONDITION_NAMES)
    for path, checksum in listed.items():
        digest = hashlib.sha256((shared / path).read_bytes()).hexdigest()
        assert checksum == f"sha256:{digest}"


@pytest.mark.slow  # a whole report
def test_the_script_makes_what_the_manifest_promises(shared: Path) -> None:
    manifest = told(shared)
    promised = manifest["expected_outputs"]
    assert [name for name in promised if (shared / name).exists()] == []
    (step,) = manifest["run"]["steps"]
    subprocess.run(
        [sys.executable, step["path"]],
        cwd=shared,
        check=True,
        capture_output=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert [name for name in promised if not (shared / name).is_file()] == []
    for name in ("trials.csv", "lane_changes.csv"):
        published = shared / "published" / name
        assert (shared / name).read_bytes() == published.read_bytes()


def test_drives_of_people_are_an_artifact_too(tmp_path: Path) -> None:
    folder, out = tmp_path / "drives", tmp_path / "out"
    folder.mkdir()
    for condition in ("manual", "weak-normal"):
        record = synthetic_record(condition, length=300.0)
        write_record(folder / f"{condition}.parquet", record)
    assert main(["export", str(folder), "--to", "autoui", "--out", str(out)]) == 0
    assert told(out)["title"] == "costeer drives, participants: 1"
    names = {each["path"] for each in told(out)["data"]}
    assert names == {"records/manual.parquet", "records/weak-normal.parquet"}


def test_what_is_no_study_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    empty, full, session = (tmp_path / name for name in ("empty", "full", "session"))
    for folder in (empty, full, session):
        folder.mkdir()
    (full / "notes.txt").write_text("keep")
    (session / "session.sqlite").write_bytes(b"")
    out = str(tmp_path / "out")
    wrong = {
        "is not a study folder": [str(empty), "--out", out],
        "is not empty": [str(empty), "--out", str(full)],
        "within the study": [str(empty), "--out", str(empty / "out")],
        "costeer session export": [str(session), "--out", out],
    }
    for reason, words in wrong.items():
        assert main(["export", *words, "--to", "autoui"]) == 2
        shown = capsys.readouterr().err
        assert reason in shown
        assert shown.count("\n") == 1
    assert not Path(out).exists()
