"""What the server of a session does for its pages, without a browser."""

from __future__ import annotations

import json
import threading
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path
from typing import Any

import pytest

from costeer.sessions.standing import OutOfStepError
from costeer.web.sessions import desk, shown
from costeer.web.sessions.console import Console
from costeer.web.sessions.step_drive import RUNNING
from tests.waiting import PATIENCE
from tests.web.sessions.conftest import Study

AGREED = {"experimenter_initials": "AB"}
THIRDS = {"understood": 3, "in_control": 3, "worked_against_me": 3}


def console_of(study: Study) -> Console:
    """The console, with a participant who has just sat down."""
    console = Console(study.desk)
    console.act("begin", {"participant": "P01"})
    return console


def post(address: str, body: object) -> tuple[int, dict[str, Any]]:
    """Status and answer of a request."""
    head = {"Content-Type": "application/json"}
    request = urllib.request.Request(address, json.dumps(body).encode(), head)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as refused:
        with refused:
            return refused.code, json.load(refused)


def agree(study: Study) -> None:
    """The first step is over, whatever the consent asks."""
    step = study.desk.state()["step"]
    items = [item["name"] for item in step["instrument"]["items"]]
    given = {name: AGREED.get(name, "yes") for name in items}
    study.desk.answers("P01", "consent", given)


def test_the_console_is_told_at_once_that_a_participant_declines(study: Study) -> None:
    console = console_of(study)
    code, state = post(f"{study.participant}api/session/stop", {"participant": "P01"})
    assert (code, state["stopped"]) == (200, "does not consent")
    shown = console.shown()
    assert shown["stopped"] == "does not consent"
    assert shown["people"][0]["status"] == "declined"
    assert shown["events"][0]["kind"] == "declined"
    with pytest.raises(OutOfStepError, match="P01 has stopped"):
        agree(study)
    console.act("begin", {"participant": "P01"})  # "Go on" in the list
    assert console.shown()["stopped"] == ""
    agree(study)


def test_who_stops_says_what_shall_happen_to_the_data(study: Study) -> None:
    console = console_of(study)
    agree(study)
    body = {"participant": "P01", "delete": True}
    post(f"{study.participant}api/session/stop", body)
    assert console.shown()["stopped"] == "stops taking part; wants everything deleted"
    code, state = post(f"{study.participant}api/session/resume", body)
    assert (code, state["stopped"]) == (200, "")
    assert console.shown()["people"][0]["status"] == "active"


@pytest.mark.parametrize("path", ["answers", "next", "stop", "resume"])
def test_what_a_page_of_another_participant_sends_is_refused(
    study: Study, path: str
) -> None:
    """P02 stands at the same step when the page of P01 comes to send."""
    console = console_of(study)
    console.act("begin", {"participant": "P02"})
    body = {"participant": "P01", "step": "consent", "answers": AGREED}
    code, told = post(f"{study.participant}api/session/{path}", body)
    assert code == 409
    assert told["state"]["participant"] == "P02"
    assert study.desk.session.over("P02") == {}
    assert {row["status"] for row in study.desk.session.people()} == {"active"}


@pytest.mark.parametrize("step", ["\ud800", "x" * 10_000, "<b>", "\u202e", ""])
def test_odd_steps_are_refused_in_words(study: Study, step: str) -> None:
    console_of(study)
    body = {"participant": "P01", "step": step}
    code, told = post(f"{study.participant}api/session/next", body)
    assert code == 409
    assert "is not on" in told["text"]


def test_nobody_waits_for_a_look_at_the_devices(study: Study) -> None:
    looking, seen = threading.Event(), threading.Event()

    def look() -> list[tuple[str, bool, str]]:
        looking.set()
        assert seen.wait(PATIENCE)
        return [("Camera", True, "")]

    console = console_of(study)
    study.desk.devices = study.desk.devices._replace(checks=look)
    thread = threading.Thread(target=console.act, args=("check", {}))
    thread.start()
    assert looking.wait(PATIENCE)
    code, _ = post(f"{study.participant}api/session/next", {"participant": "P01"})
    assert code == 409  # answered, while the devices are still looked at
    seen.set()
    thread.join()
    assert [each["name"] for each in study.desk.checked] == ["Camera"]


class Driven:
    """A drive that says how it was ended."""

    def __init__(self) -> None:
        self.ended: list[str] = []
        self.said = threading.Event()
        self.state = RUNNING

    def end(self, reached_end: bool, reason: str) -> None:
        """Remember it."""
        self.ended.append(reason)
        self.said.set()


def test_an_emergency_stop_waits_for_nobody(study: Study) -> None:
    console = console_of(study)
    drive = Driven()
    study.desk._drive = drive  # type: ignore[assignment]
    with study.desk.lock:  # somebody is slow
        thread = threading.Thread(target=console.act, args=("emergency", {}))
        thread.start()
        assert drive.said.wait(PATIENCE)
        study.desk._drive = None
    thread.join()
    assert drive.ended == ["emergency stop"]


@pytest.mark.parametrize(("left", "told"), [(0.4, 1), (0.0, 0), (59.2, 60)])
def test_a_page_is_not_told_of_the_end_of_a_break_too_early(
    study: Study, monkeypatch: pytest.MonkeyPatch, left: float, told: int
) -> None:
    console_of(study)
    agree(study)
    study.desk.next("P01", "instruct-welcome")
    study.desk.answers("P01", "ask-likert", THIRDS)
    for room in (shown, desk):
        monkeypatch.setattr(room, "break_left", lambda *_: left)
    assert study.desk.state()["step"]["remaining"] == told
    if told:
        with pytest.raises(ValueError, match="not over yet"):
            study.desk.next("P01", "break-break")
    else:
        assert study.desk.next("P01", "break-break")["step"]["kind"] == "ask"


def test_words_that_break_in_the_middle_stop_nobody(study: Study) -> None:
    console = console_of(study)
    folder = study.desk.session.folder
    before = study.desk.state()["texts"]["wait_title"]
    (folder / "texts").mkdir()
    (folder / "texts" / "en.yaml").write_text("pages: [")
    shown = console.shown()
    assert "en.yaml is not YAML" in shown["wording"]
    assert study.desk.state()["texts"]["wait_title"] == before
    (folder / "texts" / "en.yaml").write_text("pages: {wait_title: One moment}")
    assert study.desk.state()["texts"]["wait_title"] == "One moment"
    assert console.shown()["wording"] == ""


def test_a_language_without_words_is_refused_before_anybody_sits_down(
    study: Study,
) -> None:
    folder: Path = study.desk.session.folder
    (folder / "texts").mkdir()
    (folder / "texts" / "fr.yaml").write_text("pages: {wait_title: Attendez}")
    with pytest.raises(ValueError, match="words are missing"):
        Console(study.desk).act("begin", {"participant": "P01", "language": "fr"})
    assert study.desk.session.people() == []


def test_questions_come_in_the_same_order_after_the_plan_is_edited(
    study: Study,
) -> None:
    console_of(study)
    before = study.desk.state()["step"]["instrument"]["step"]
    study.desk.session.plan = study.desk.session.plan._replace(seed=99)
    assert study.desk.state()["step"]["instrument"]["step"] == before


def test_who_is_replaced_leaves(study: Study) -> None:
    console = console_of(study)
    console.act("replace", {"participant": "P01", "reason": "felt sick"})
    assert study.desk.participant == ""
    assert study.desk.session.status_of("P01") == "dropped"


def test_the_console_hears_how_well_the_page_draws(study: Study) -> None:
    console = console_of(study)
    assert console.shown()["pictures"] is None
    for told in ("57", "", "-1", "1e9", "9999", "nan", "\u0665"):  # an Arabic five
        query = urllib.parse.urlencode({"pictures": told})
        with urllib.request.urlopen(f"{study.participant}api/session?{query}"):
            assert console.shown()["pictures"] == 57


SICKENING = """
title: A study
steps:
  - {kind: ask, instrument: fms}
  - {kind: drive, condition: manual}
"""


class _Waiting:
    """A drive whose processes are there."""

    state, is_ending = "ready", False
    pages = None

    def __init__(self) -> None:
        self.asked: list[str] = []

    def ask(self, *command: str) -> None:
        self.asked += command

    def told(self) -> dict[str, Any]:
        return {"state": self.state}

    def end(self, *_: object) -> None:
        return


@pytest.mark.parametrize("study", [SICKENING], indirect=True)
def test_who_is_unwell_by_a_questionnaire_waits_for_the_experimenter(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk, drive, begun = study.desk, _Waiting(), list[str]()
    monkeypatch.setattr(desk, "_drive", drive)
    monkeypatch.setattr(desk, "_driven", ("P01", "drive-manual", 1))
    monkeypatch.setattr(desk, "_begin_attempt", lambda _, step: begun.append(step.id))
    monkeypatch.setattr("costeer.web.sessions.shown.is_enough", lambda *_: False)
    console = console_of(study)
    state = desk.answers("P01", "ask-fms", {"sickness": 15})
    assert (state["step"]["id"], state["held"], begun) == ("drive-manual", True, [])
    assert "fms is 15, the limit 15" in console.shown()["unwell"]
    with pytest.raises(ValueError, match="no drive may begin now"):
        console.act("start", {})
    with pytest.raises(ValueError, match="give a reason"):
        console.act("well", {"reason": ""})
    assert (begun, drive.asked) == ([], [])
    shown = console.act("well", {"reason": "rested"})
    assert (shown["unwell"], begun[:1]) == ("", ["drive-manual"])
    assert not desk.state()["held"]
    monkeypatch.setattr(desk, "_drive", None)
