"""A drive on both pages: charts, a second tab, reload, back, emergency stop."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path

import pytest
from playwright.sync_api import Page

from costeer.sessions.session import Session
from tests.web.browser import stop
from tests.web.sessions.test_whole_session import (
    PATIENCE,
    both_pages,
    get_ready,
    wait_for,
)

pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(900)]

PLAN = """
title: A drive
participants: 1
length: 20000
steps:
  - {kind: drive, condition: manual, text: trial}
"""
SEEN = "#drive:not([inert])"
# Within one task: on a busy computer two keys may be too far apart to count.
ESCAPE_TWICE = """for (const _ of [1, 2]) document.body.dispatchEvent(
  new KeyboardEvent("keydown", { code: "Escape", bubbles: true }));"""
STATE = "document.getElementById('state').textContent"


def start(page: Page, console: Page) -> None:
    """Say that one is ready, and start at the console."""
    get_ready(page, console)
    console.get_by_role("button", name="Start").click()
    go_on(console)


def go_on(console: Page, further: float = 5.0) -> None:
    """Let it drive some metres; a page that left, or a busy computer, pauses it."""
    goal = metres(console) + further
    deadline = time.monotonic() + PATIENCE
    while metres(console) < goal:
        assert time.monotonic() < deadline
        for button in ("acknowledge", "resume"):
            console.evaluate(f"document.querySelector('#{button}:enabled')?.click()")
        console.wait_for_timeout(200)


def metres(console: Page) -> float:
    """Driven so far."""
    text = "parseInt(document.querySelectorAll('#facts dd')[2].textContent)"
    found = float(console.evaluate(text) or 0.0)
    return found if math.isfinite(found) else 0.0


def test_a_drive_survives_tabs_reload_and_back_and_stops_at_once(
    tmp_path: Path,
) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN, "utf-8")
    with both_pages(tmp_path) as (page, console, wrong, process):
        console.get_by_role("button", name="Begin", exact=True).click()
        start(page, console)
        wait_for(console, "document.querySelector('#facts').innerText.includes(' fps')")
        check_charts(console)
        check_second_tab(page, console)
        driven = metres(console)
        page.reload()
        page.locator(SEEN).wait_for()
        go_on(console)
        page.goto("about:blank")
        wait_for(console, f"{STATE} === 'PAUSED'")
        page.go_back()
        page.locator(SEEN).wait_for()
        go_on(console)
        assert metres(console) >= driven  # the same drive
        console.evaluate(ESCAPE_TWICE)
        page.get_by_role("button", name="I am ready").wait_for()
        console.locator("#trials", has_text="aborted").wait_for()
        assert page.locator(SEEN).count() == 0
        start(page, console)  # the frame that was kept joins the next attempt
        stop(process)
    assert [each for each in wrong if "Failed to load" not in each] == []
    check_attempts(tmp_path)


def check_charts(console: Page) -> None:
    """Values under the pointer; a zoom that stays until it is left."""
    wait_for(console, "document.querySelectorAll('.value')[4].textContent.length > 1")
    plot = console.locator(".plot .u-over").nth(3)
    box = plot.bounding_box()
    assert box is not None
    left, middle = box["x"], box["y"] + box["height"] / 2.0
    # Without the pointer the newest value shows; the course begins at 70 km/h.
    console.mouse.move(left + 1.0, middle)
    wait_for(
        console, "document.querySelectorAll('.value')[4].textContent.startsWith('70')"
    )
    console.mouse.down()
    console.mouse.move(left + box["width"] * 0.5, middle, steps=5)
    console.mouse.up()
    back = console.get_by_role("button", name="Live again")
    back.wait_for()
    console.wait_for_timeout(1000)
    assert back.is_visible()
    back.click()
    back.wait_for(state="hidden")


def check_second_tab(page: Page, console: Page) -> None:
    """It is told that another page drives, and takes nothing from that one."""
    other = page.context.new_page()
    other.goto(page.url)
    banner = other.locator("#banner", has_text="in another window")
    banner.wait_for(timeout=1e3 * PATIENCE)
    other.keyboard.press("Enter")
    other.close()
    page.bring_to_front()
    go_on(console)


def check_attempts(folder: Path) -> None:
    """Both are kept with the reason, and their records are set aside."""
    session = Session(folder)
    rows = session.store.rows("SELECT * FROM attempts ORDER BY rowid")
    session.close()
    assert [row["reason"] for row in rows] == [
        *("emergency stop", "the session was closed"),
    ]
    assert {row["state"] for row in rows} == {"aborted"}
    assert json.loads(rows[1]["facts"])["frame_rate"] is not None  # of the first drive
    kept = (folder / "aborted").glob("*-attempt?.parquet")
    assert len(list(kept)) == 2
