"""Ends, repeats and notes of a session: nothing that was said or driven is lost."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from costeer.sessions.attempts import Attempts
from costeer.sessions.standing import WHOLE, OutOfStepError
from costeer.sessions.store import Moment
from tests.sessions.test_session import IDS, answer, go_on, study


def test_a_record_that_became_whole_as_the_process_died_counts(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    answer(session, "P01", "consent")
    _, record = Attempts(session).start("P01", "practise-manual", {})
    record.write_bytes(b"whole")
    session.close()
    again = study(tmp_path)
    rows = Attempts(again, lambda path, step: {"sdlp": len(path.read_bytes())}).listed()
    assert (rows[0]["state"], rows[0]["measures"]) == (WHOLE, {"sdlp": 5})
    assert record.is_file()
    assert again.standing("P01").step.id == "drive-manual"


def test_nothing_is_done_once_the_session_is_over(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    for _ in IDS:
        go_on(session, "P01")
    with pytest.raises(OutOfStepError, match="the session is over"):
        session.finish("P01", "done")
    with pytest.raises(OutOfStepError, match="the session is over"):
        session.skip("P01", "done", "a test")
    assert "done" not in session.over("P01")


def test_a_step_that_is_not_over_is_not_repeated(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    with pytest.raises(OutOfStepError, match="'consent' is not over"):
        session.repeat("P01", "consent", "a test")


def test_answers_from_before_a_repeat_stay_in_the_log(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    answer(session, "P01", "consent")
    session.repeat("P01", "consent", "the wrong form")
    (told,) = session.store.rows("SELECT data FROM events WHERE kind = 'repeat'")
    assert json.loads(told["data"]) == {"answers": {"effort": "55", "mental": "5"}}


def test_a_pseudonym_in_other_letters_is_no_new_participant(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    with pytest.raises(ValueError, match="'p01', and there is 'P01'"):
        session.begin("p01")
    assert len(session.people()) == 1


def test_people_and_drives_stand_in_their_order_whatever_the_clocks_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The wall clock is set back, and the computer is started anew."""
    session = study(tmp_path)
    moments = [
        Moment(f"2026-01-31T09:{n:02d}:00.000Z", 1.0 * n) for n in range(59, 0, -1)
    ]
    for module in ("session", "attempts", "store"):
        monkeypatch.setattr(f"costeer.sessions.{module}.now", lambda: moments.pop(0))
    for who in ("P02", "P01"):
        session.begin(who)
        answer(session, who, "consent")
    assert [row["participant"] for row in session.people()] == ["P02", "P01"]
    attempts = Attempts(session)
    for reason in ("first", "second"):
        number, _ = attempts.start("P01", "practise-manual", {})
        attempts.end("P01", "practise-manual", number, None, reason)
    assert [row["reason"] for row in attempts.listed("P01")] == ["first", "second"]
    session.set_status("P02", "active")
    assert [row["participant"] for row in session.people()] == ["P02", "P01"]


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("=1+1\x00\x1b[31m", "=1+1[31m"),
        ("\u202egnp.exe", "gnp.exe"),
        ("<b>\U0001f600</b>\ud800", "<b>\U0001f600</b>"),
    ],
)
def test_notes_and_reasons_lose_what_nobody_sees(
    tmp_path: Path, given: str, kept: str
) -> None:
    session = study(tmp_path)
    session.begin("P01")
    session.note("P01", given)
    session.skip("P01", "consent", given)
    texts = [r["text"] for r in session.store.rows("SELECT text FROM events")]
    assert texts[-2:] == [kept, kept]


def test_a_note_of_ten_kilobytes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="1 to 2,000 characters"):
        study(tmp_path).note("", "x" * 10_000)
