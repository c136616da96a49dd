"""Who stops or declines is kept so, and orders stay balanced."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.sessions.session import Session
from costeer.sessions.standing import OutOfStepError
from costeer.sessions.stopping import stop_taking_part, take_part_again
from tests.sessions.test_session import IDS, answer, go_on, study


def events(session: Session, who: str) -> list[tuple[str, str]]:
    """Kind and step of what happened."""
    rows = session.store.rows(
        "SELECT kind, step FROM events WHERE participant = ? ORDER BY number", who
    )
    return [(row["kind"], row["step"]) for row in rows]


def slots(session: Session) -> dict[str, int]:
    return {row["participant"]: row["slot"] for row in session.people()}


def test_who_declines_is_kept_and_gives_the_row_to_the_next(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    stop_taking_part(session, "P01")
    stop_taking_part(session, "P01")  # pressed twice
    session.close()
    again = study(tmp_path)
    assert again.status_of("P01") == "declined"
    assert again.person("P01")["reason"] == "does not consent"
    assert events(again, "P01")[1:] == [("declined", "consent")]
    again.begin("P02")
    assert slots(again) == {"P01": 1, "P02": 1}


def test_who_declined_and_comes_back_takes_a_row_that_is_free(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    stop_taking_part(session, "P01")
    session.begin("P02")
    take_part_again(session, "P01")
    assert slots(session) == {"P01": 2, "P02": 1}
    assert session.status_of("P01") == "active"
    assert events(session, "P01")[-1] == ("goes on", "consent")
    # Two conditions: the second row of the square is the first turned round.
    assert [s.id for s in session.steps_of("P01") if s.kind == "drive"][1:] == [
        *("drive-weak-gentle", "drive-strong-rapid"),
    ]


def test_who_stops_later_holds_the_row_until_replaced(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    answer(session, "P01", "consent")
    stop_taking_part(session, "P01", deletes=True)
    assert session.person("P01")["reason"].endswith("wants everything deleted")
    session.begin("P02")
    assert slots(session) == {"P01": 1, "P02": 2}
    session.drop("P01", "felt sick")
    session.begin("P03")
    assert slots(session)["P03"] == 1


def test_who_has_finished_cannot_stop(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    for _ in IDS:
        go_on(session, "P01")
    with pytest.raises(OutOfStepError, match="has finished"):
        stop_taking_part(session, "P01")


def test_a_dropout_whose_last_step_ends_stays_a_dropout(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    for _ in IDS[:-1]:
        go_on(session, "P01")
    session.drop("P01", "felt sick")  # the form of the last step is still open
    answer(session, "P01", IDS[-1])
    assert session.status_of("P01") == "dropped"
    session.repeat("P01", "break", "a test")
    assert session.status_of("P01") == "dropped"
    session.begin("P02")
    assert slots(session)["P02"] == 1
