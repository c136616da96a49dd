"""A plain folder of drives with pseudonyms, and what it must not hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main
from costeer.records.record import write_record
from costeer.study.people import natural
from costeer.study.plain_folder import people_of_records
from tests.study.synthetic import synthetic_record

LENGTH = 1800.0


def put(folder: Path, name: str, who: object, condition: str, began: str = "") -> None:
    """A record of a person under any name."""
    record = synthetic_record(condition, len(str(who)), length=LENGTH)
    about = {**record.metadata, "participant": who, "driver_kind": "person"}
    if began:
        about["started_at"] = f"2026-01-31T{began}:00Z"
    folder.mkdir(exist_ok=True)
    write_record(folder / f"{name}.parquet", record._replace(metadata=about))


@pytest.fixture
def drives(tmp_path: Path) -> Path:
    """Two people, one of whom lacks a condition."""
    put(tmp_path, "a", "P10", "manual", "09:00")
    put(tmp_path, "b", "P10", "weak-gentle", "10:00")
    put(tmp_path, "c", "P2", "weak-gentle", "09:00")
    (tmp_path / "a.wheel.parquet").write_bytes(b"a trace, no record")
    return tmp_path


def test_participant_and_condition_are_those_of_the_record(drives: Path) -> None:
    people = people_of_records(drives)
    assert [(d.participant, d.condition, d.order) for d in people.drives] == [
        ("P2", "weak-gentle", 1),
        ("P10", "manual", 1),
        ("P10", "weak-gentle", 2),
    ]
    (gap,) = people.exclusions
    assert (gap.participant, gap.condition, gap.state) == ("P2", "manual", "missing")
    assert people.study.configuration["speed"] == pytest.approx(70.0 / 3.6)


def test_without_dates_there_is_no_order(tmp_path: Path) -> None:
    put(tmp_path, "a", "P1", "manual")
    assert people_of_records(tmp_path).drives[0].order is None


def test_records_in_their_own_folder_are_found(tmp_path: Path) -> None:
    put(tmp_path / "records", "a", "P1", "manual")
    assert len(people_of_records(tmp_path).drives) == 1


def test_a_damaged_record_is_named_and_left_out(drives: Path) -> None:
    (drives / "d.parquet").write_bytes((drives / "a.parquet").read_bytes()[:500])
    people = people_of_records(drives)
    assert len(people.drives) == 3
    assert people.exclusions[0].state == "unreadable"
    assert "d.parquet" in people.exclusions[0].reason


def test_p2_comes_before_p10() -> None:
    assert sorted(["P10", "P2", "7", "A1"], key=natural) == ["7", "A1", "P2", "P10"]


def test_what_cannot_be_is_refused_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(folder: Path) -> str:
        assert main(["report", str(folder)]) == 2
        error = capsys.readouterr().err
        assert len(error.splitlines()) == 1
        return error

    (tmp_path / "empty").mkdir()
    assert "no session and no trial records" in refused(tmp_path / "empty")
    put(tmp_path / "twice", "a", "P1", "manual")
    put(tmp_path / "twice", "b", "P1", "manual")
    told = refused(tmp_path / "twice")
    assert "a.parquet and b.parquet are both of participant P1, manual" in told
    assert "exclude one, or move it out" in told
    put(tmp_path / "nobody", "a", None, "manual")
    assert "a.parquet says no participant" in refused(tmp_path / "nobody")
    record = synthetic_record("manual", 1, length=LENGTH)
    (tmp_path / "other").mkdir()
    about = {**record.metadata, "condition": "medium-slow", "participant": "P1"}
    file = tmp_path / "other" / "a.parquet"
    write_record(file, record._replace(metadata=about))
    assert "is of condition 'medium-slow', which is none of" in refused(file.parent)


def test_beside_needs_a_study(
    drives: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(drives), "--beside", str(tmp_path / "no")]) == 2
    assert "which has no study.yaml" in capsys.readouterr().err


@pytest.mark.slow  # a report of its own
def test_a_plain_folder_gets_a_report(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(drives)]) == 0
    shown = capsys.readouterr()
    assert shown.out == f"{drives / 'report.html'}\n"
    assert "1 drive is excluded or missing" in shown.err
    page = (drives / "report.html").read_text("utf-8")
    assert "2 participants drove the conditions manual and weak-gentle." in page
    assert "there is no record of it" in page
    assert "Methods, ready to paste" in page
