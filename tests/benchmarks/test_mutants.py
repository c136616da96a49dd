"""Faults are put where code runs, and those that nobody can observe are still there."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from benchmarks import mutants as bench
from benchmarks.mutants import UNSEEN, changed, mutants

CODE = '''"""A file."""

LIMIT: float = 8.0


def held(wanted: float | None, least: int = 2) -> bool:
    """Whether."""
    return min(wanted, LIMIT) < least and not wanted
'''


def test_each_change_alters_one_thing_and_no_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "PACKAGE", tmp_path)
    (tmp_path / "one.py").write_text(CODE)
    found = list(mutants("one.py"))
    assert sorted(each.told for each in found) == [
        "2 -> 3.6",
        "8.0 -> 11.4",
        "min -> max",
        "min(wanted, LIMIT) < least -> min(wanted, LIMIT) >= least",
        "min(wanted, LIMIT) < least and (not wanted)"
        " -> min(wanted, LIMIT) < least or not wanted",
        "not wanted -> +bool(wanted)",
    ]
    assert len({each.text for each in found}) == len(found)
    assert {each.source for each in found} <= {
        line.strip() for line in CODE.splitlines()
    }


def test_what_cannot_be_changed_is_left_alone() -> None:
    assert changed(ast.parse("'text'").body[0].value) == ""  # type: ignore[attr-defined]


@pytest.mark.slow
def test_changes_that_nobody_can_observe_are_changes_that_are_made() -> None:
    files = {file for file, _, _ in UNSEEN}
    made = {(m.file, m.source, m.told) for file in files for m in mutants(file)}
    assert set(UNSEEN) <= made
    assert all(UNSEEN.values())
