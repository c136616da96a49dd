"""A break lasts as long as the plan says, whatever ends or is set meanwhile."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.sessions import breaks, store
from costeer.sessions.breaks import break_left
from costeer.sessions.session import Session
from costeer.sessions.store import Moment, StoreError

PLAN = """
title: A break
steps:
  - {kind: break, minutes: 2}
  - {kind: instruct, text: welcome}
"""


class Clocks:
    """Both clocks of a computer, set by the test."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.wall, self.steady = 1_800_000_000.0, 5000.0
        for module in (breaks, store):
            monkeypatch.setattr(module, "now", self.now)

    def now(self) -> Moment:
        """This moment."""
        return Moment(store.utc_of(self.wall), self.steady)

    def pass_by(self, seconds: float) -> None:
        """Let time pass."""
        self.wall += seconds
        self.steady += seconds


@pytest.fixture
def clocks(monkeypatch: pytest.MonkeyPatch) -> Clocks:
    return Clocks(monkeypatch)


def begun(folder: Path) -> Session:
    """A session at its break; opened again if there is one."""
    (folder / "plan.yaml").write_text(PLAN)
    session = Session(folder)
    session.begin("P01")
    return session


def left(session: Session) -> float:
    return break_left(session, session.standing("P01"))


def test_break_goes_on_while_the_server_is_not_there(
    tmp_path: Path, clocks: Clocks
) -> None:
    session = begun(tmp_path)
    assert left(session) == 120.0
    clocks.pass_by(30.0)
    assert left(session) == 90.0
    session.close()
    clocks.pass_by(50.0)
    assert left(begun(tmp_path)) == 40.0


@pytest.mark.parametrize("by", [-7200.0, 7200.0])
def test_clock_that_is_set_changes_nothing(
    tmp_path: Path, clocks: Clocks, by: float
) -> None:
    session = begun(tmp_path)
    left(session)
    clocks.wall += by
    clocks.pass_by(30.0)
    assert left(session) == 90.0


def test_wall_clock_tells_after_the_computer_was_started_anew(
    tmp_path: Path, clocks: Clocks
) -> None:
    session = begun(tmp_path)
    left(session)
    clocks.pass_by(45.0)
    clocks.steady = 10.0
    assert left(session) == 75.0
    clocks.wall -= 3600.0  # and set back: a moment that is still to come
    assert left(session) == 120.0


def test_break_that_is_repeated_begins_anew(tmp_path: Path, clocks: Clocks) -> None:
    session = begun(tmp_path)
    left(session)
    clocks.pass_by(200.0)
    assert left(session) == 0.0
    session.finish("P01", "break")
    session.repeat("P01", "break", "was called away")
    clocks.pass_by(1.0)
    assert left(session) == 120.0
    clocks.pass_by(20.0)
    assert left(session) == 100.0


def test_full_disk_ends_no_break_early(
    tmp_path: Path, clocks: Clocks, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = begun(tmp_path)

    def full(*_: object) -> None:
        raise StoreError("disk full")

    monkeypatch.setattr(session.store, "tell", full)
    assert left(session) == 120.0
