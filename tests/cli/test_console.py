"""Progress goes to stderr, and a log file gets few lines."""

from __future__ import annotations

import sys

import pytest

from costeer.cli import console


def test_a_log_gets_a_line_for_each_tenth(capsys: pytest.CaptureFixture[str]) -> None:
    with console.progress("Trials", 84) as advance:
        for _ in range(84):
            advance(1)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.splitlines()) == 10
    assert shown.err.splitlines()[-1].startswith("Trials: 84 of 84, ")


def test_resumed_work_starts_where_it_stopped(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with console.progress("Trials", 10, done=8) as advance:
        advance(1)
    assert capsys.readouterr().err.startswith("Trials: 9 of 10, ")


def test_nothing_to_do_prints_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with console.progress("Trials", 0) as advance:
        advance(0)
    assert capsys.readouterr().err == ""


def test_a_terminal_gets_a_bar(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with console.progress("Trials", 2) as advance:
        advance(2)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "2/2" in shown.err


def test_notes_stay_away_from_results(capsys: pytest.CaptureFixture[str]) -> None:
    console.note("resuming")
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", "resuming\n")


def test_numbers_of_a_table_lean_right(capsys: pytest.CaptureFixture[str]) -> None:
    console.print_table(["name", "s"], [["slow [one]", "10.5"], ["fast", "2"]], "Times")
    lines = capsys.readouterr().out.splitlines()
    assert "Times" in lines[0]
    assert any("slow [one] │ 10.5" in line for line in lines)
    assert any("fast       │    2" in line for line in lines)


def test_a_narrow_terminal_loses_no_letter_of_a_table(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "24")
    console.print_table(["measure", "s"], [["line_crossing_time_median", "10.5"]])
    rows = [line.split("│") for line in capsys.readouterr().out.splitlines()]
    shown = "".join(cells[1].strip() for cells in rows if len(cells) == 4)
    assert shown == "line_crossing_time_median"
