"""A whole session by both pages: drives of the real loop, questions, data."""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from costeer.records.record import read_record
from costeer.sessions.session import Session
from tests.web.browser import page_of, serving, stop

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

FIGURES = os.environ.get("COSTEER_FIGURES")
"""Folder for the pictures of docs/session.md, which take longer drives."""
LENGTH = 600 if FIGURES else 200
PLAN = f"""
title: Driving with shared steering
participants: 2
length: {LENGTH}
steps:
  - {{kind: consent, instrument: consent}}
  - {{kind: drive, condition: manual, text: trial}}
  - {{kind: ask, instrument: nasa-tlx}}
  - kind: trials
    conditions: [strong-normal]
    text: trial
    after:
      - {{kind: ask, instrument: likert}}
"""
PATIENCE = 300.0
"""Longest wait for a drive to be ready or over [s]: others may use the machine."""
HTML = "<b>bold</b>"
FRAMES = "document.getElementById('drive')?.contentWindow.costeer?.frames ?? 0"
MAY_START = """!document.getElementById("start").disabled
  && document.getElementById("facts").textContent.includes("drives")"""
SAY_READY = """[...document.querySelectorAll("button:enabled")]
  .find((each) => each.textContent === "I am ready")?.click()"""
RUNNING = """(() => {
  document.querySelector("#acknowledge:enabled")?.click();
  document.querySelector("#resume:enabled")?.click();
  return document.getElementById("state").textContent === "RUNNING";
})()"""


def wait_for(page: Page, expression: str) -> None:
    """Wait until something is so in the page; its policy forbids other ways."""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(expression):
        assert time.monotonic() < deadline, f"never {expression}"
        page.wait_for_timeout(100)


def keep_picture(page: Page, name: str) -> None:
    """Keep a picture of a page for docs/session.md, where `COSTEER_FIGURES` asks."""
    if FIGURES:
        page.bring_to_front()
        page.wait_for_timeout(300)
        page.screenshot(path=Path(FIGURES) / f"session_{name}.png")


def fill(page: Page) -> None:
    """Answer everything that a form asks, and send it."""
    page.locator("form.questionnaire").wait_for()
    for box in page.get_by_role("checkbox").all():
        box.check()
    for group in page.get_by_role("radiogroup").all():
        group.get_by_role("radio").nth(3).check()
    for text in page.locator("form textarea").all():
        text.fill(HTML)
    for text in page.locator("form input[type=text]").all():
        text.fill("AB")
    for _ in range(15):
        if page.locator(".side").count():
            page.locator(".side").first.click()
    page.locator("button[type=submit]").click()


def get_ready(page: Page, console: Page) -> None:
    """Say that one is ready, until the page drives.

    Processes that broke before anybody drove begin anew, and ask anew: on a busy
    computer the loop can stand still for so long that it is ended.
    """
    deadline = time.monotonic() + PATIENCE
    while not (console.evaluate(MAY_START) and page.evaluate(FRAMES) > 5):
        assert time.monotonic() < deadline, console.locator("body").inner_text()
        page.evaluate(SAY_READY)
        console.evaluate("document.querySelector('#acknowledge:enabled')?.click()")
        page.wait_for_timeout(200)


def drive(page: Page, console: Page) -> None:
    """Say that one is ready, start by the keyboard, and wait for the end."""
    get_ready(page, console)
    page.keyboard.press("Enter")
    keep_going(page, console)


def keep_going(page: Page, console: Page, metres: float = math.inf) -> None:
    """Wait for some metres or the end; a busy computer may pause it in between."""
    deadline = time.monotonic() + PATIENCE
    driven = "parseInt(document.querySelectorAll('#facts dd')[2].textContent)"
    while page.locator("#drive:not([inert])").count():
        if (console.evaluate(driven) or 0.0) > metres:
            return
        assert time.monotonic() < deadline
        # Through the page: a click would wait for a button that may be gone by then.
        for button in ("acknowledge", "resume"):
            console.evaluate(f"document.querySelector('#{button}:enabled')?.click()")
        page.wait_for_timeout(200)


@contextmanager
def both_pages(folder: Path) -> Iterator[tuple[Page, Page, list[str], Any]]:
    """Participant's page, console, what goes wrong in them, and the command."""
    words = ("session", "run", str(folder), "--wheel", "simulated:virtual")
    with serving(*words) as server, page_of(1280, 720) as (page, wrong):
        console = page.context.new_page()
        console.on("pageerror", lambda error: wrong.append(str(error)))
        for each in (page, console):
            each.set_default_timeout(1e3 * PATIENCE)
        page.goto(f"{server.address}?low&scale=0.5")
        console.goto(server.experimenter)
        yield page, console, wrong, server.process


def test_session_of_two_drives_leaves_records_answers_and_measures(
    tmp_path: Path,
) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN, "utf-8")
    with both_pages(tmp_path) as (page, console, wrong, process):
        page.get_by_role("heading", name="Please wait").wait_for()
        console.get_by_role("button", name="Check").click()
        console.get_by_role("button", name="Begin", exact=True).click()
        fill(page)
        page.get_by_role("heading", name="Drive 1 of 2").wait_for()
        drive(page, console)
        page.get_by_role("heading", name="Workload", exact=True).wait_for()
        for place, group in enumerate(page.get_by_role("radiogroup").all()[:2]):
            group.get_by_role("radio").nth(12 - 5 * place).check()
        keep_picture(page, "questions")
        fill(page)
        page.get_by_role("heading", name="Drive 2 of 2").wait_for()
        keep_picture(page, "participant")
        get_ready(page, console)
        console.get_by_role("button", name="Start").click()  # here the console starts
        keep_going(page, console, LENGTH - 120.0)
        if FIGURES:  # a busy computer may just have paused it
            wait_for(console, RUNNING)
        keep_picture(console, "console")
        keep_going(page, console)
        page.get_by_role("heading", name="The guidance").wait_for()
        fill(page)
        page.get_by_role("heading", name="Thank you").wait_for()
        console.locator("#state", has_text="DONE").wait_for()
        assert console.locator("#trials tbody tr").count() == 2
        shown = console.locator("#trials tbody tr td:nth-child(2)").all_inner_texts()
        # Virtual hands sway in the lane: between next to nothing and its width.
        assert all(0.0 < float(sdlp) < 1.0 for sdlp in shown), shown
        stop(process)
    assert [each for each in wrong if "Failed to load" not in each] == []
    check_data(tmp_path)


def check_data(folder: Path) -> None:
    """Two whole records and the answers after each."""
    session = Session(folder)
    attempts = session.store.rows("SELECT * FROM attempts ORDER BY monotonic")
    assert [(a["condition"], a["state"]) for a in attempts] == [
        ("manual", "finished"),
        ("strong-normal", "finished"),
    ]
    for each in attempts:
        columns = read_record(folder / each["record"]).columns
        assert columns["longitudinal_position"][-1] == pytest.approx(LENGTH, abs=2.0)
    tlx = session.answers_of("P01", "ask-nasa-tlx-manual")
    assert json.loads(tlx["mental_demand"]) == 15  # the fourth of 0, 5, 10, 15
    likert = session.answers_of("P01", "ask-likert-strong-normal")
    assert json.loads(likert["comment"]) == HTML
    session.close()
