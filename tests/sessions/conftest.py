"""A study with people, made once for all tests that only look at it."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.sessions.attempts import Attempts
from tests.sessions.made_up import drive, made_up_session

DRIVEN = ("manual", "strong-rapid", "weak-gentle")
PEOPLE = ("P01", "P02", "P03", "P04")


@pytest.fixture(autouse=True)
def home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A folder of settings that is nobody's: who withdraws here loses nothing."""
    folder = tmp_path / "home"
    monkeypatch.setenv("COSTEER_HOME", str(folder))
    return folder


@pytest.fixture(scope="session")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four people; an exclusion, an aborted attempt, a dropout, notes; read only."""
    folder = tmp_path_factory.mktemp("studied") / "study"
    session = made_up_session(folder, PEOPLE, DRIVEN)
    attempts = Attempts(session)
    attempts.exclude("P02", "drive-weak-gentle", 1, "the screen went dark")
    session.repeat("P03", "drive-manual", "looked at the phone")
    number, _ = attempts.start("P03", "drive-manual", {})
    attempts.end("P03", "drive-manual", number, None, "=stopped")
    drive(session, "P03", session.standing("P03").step)
    session.drop("P04", "felt sick")
    session.note("P01", "=1+1, said P01")
    session.close()
    return folder
