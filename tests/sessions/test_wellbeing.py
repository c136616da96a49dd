"""Who is unwell by a questionnaire waits until the experimenter has decided."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from costeer.sessions.questionnaires.instrument import load_instrument
from costeer.sessions.session import Session
from costeer.sessions.wellbeing import held, let_go_on, unwell

PLAN = """
title: A study
steps:
  - {kind: ask, instrument: ssq}
  - {kind: drive, condition: manual}
  - {kind: ask, instrument: ssq}
  - {kind: ask, instrument: fms}
"""
SSQ = load_instrument("ssq", "en")
SICK = dict.fromkeys(("nausea", "vertigo", "sweating", "fatigue"), 2)
"""A total of 3.74 x (4 + 2 + 2 + 2) = 37.4: nausea stands in two of the three lists."""


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    """A study in which P01 has just begun."""
    (tmp_path / "plan.yaml").write_text(PLAN)
    found = Session(tmp_path)
    found.begin("P01")
    yield found
    found.close()


def answered(session: Session, step: str, **given: int) -> str:
    """Why P01 should not go on after these answers to the SSQ, which are kept."""
    answers = dict.fromkeys((item.name for item in SSQ.items), 0) | given
    why = unwell(session, "P01", step, SSQ, answers)
    session.answer("P01", step, answers, (SSQ.name, SSQ.version), why)
    return why


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ({}, SICK, ""),
        ({}, SICK | {"headache": 1}, "41.14 above the baseline, the limit 40"),
        ({"eyestrain": 1}, SICK | {"headache": 1}, ""),
    ],
)
def test_a_rise_over_the_first_answers_counts(
    session: Session, before: dict[str, int], after: dict[str, int], told: str
) -> None:
    answered(session, "ask-ssq", **before)
    session.skip("P01", "drive-manual", "tried out")
    why = answered(session, "ask-ssq-manual", **after)
    assert told in why
    assert bool(why) == bool(told)
    assert held(session, "P01") == why


def test_who_felt_so_before_the_first_drive_has_not_become_unwell(
    session: Session,
) -> None:
    worse = SICK | {"headache": 3, "general_discomfort": 3}
    assert "the limit 40" in answered(session, "ask-ssq", **worse)
    let_go_on(session, "P01", "wants to try")
    session.skip("P01", "drive-manual", "tried out")
    assert answered(session, "ask-ssq-manual", **worse) == ""
    assert held(session, "P01") == ""


def test_the_word_of_the_experimenter_is_kept(session: Session) -> None:
    answered(session, "ask-ssq")
    session.skip("P01", "drive-manual", "tried out")
    severe = dict.fromkeys((item.name for item in SSQ.items), 3)
    why = answered(session, "ask-ssq-manual", **severe)
    folder = session.folder
    session.close()
    again = Session(folder)  # after a crash
    assert held(again, "P01") == why != ""
    with pytest.raises(ValueError, match="give a reason"):
        let_go_on(again, "P01", " ")
    let_go_on(again, "P01", "rested for an hour")
    assert held(again, "P01") == ""
    with pytest.raises(ValueError, match="nothing keeps P01"):
        let_go_on(again, "P01", "rested for an hour")
    told = again.store.rows("SELECT kind, text, step FROM events ORDER BY number")
    rows = [(row["kind"], row["text"]) for row in told]
    assert ("unwell", why) in rows
    assert rows[-1] == ("goes on", "rested for an hour")
    again.close()
