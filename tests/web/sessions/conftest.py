"""A study without drives, its server in this process, and both of its pages."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest

from costeer.sessions.session import Session
from costeer.web.sessions.app import session_app
from costeer.web.sessions.desk import Desk
from costeer.web.sessions.devices import Devices
from tests.web.page.conftest import browser as browser  # a fixture
from tests.web.served import served

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PLAN = """
title: A study
participants: 2
steps:
  - {kind: consent, instrument: consent}
  - {kind: instruct, text: welcome}
  - {kind: ask, instrument: likert}
  - {kind: break, text: break, minutes: 0.02}
  - {kind: ask, instrument: nasa-tlx}
"""
CHECKS = [("Disk", True, "enough"), ("Wheel", False, "<b>plug it in</b>")]


class Study(NamedTuple):
    """A study whose pages are served.

    Attributes:
        desk: Of the session.
        participant: Address of the participant's page.
        console: Address of the console.
        token: Query that makes an experimenter of who asks.
    """

    desk: Desk
    participant: str
    console: str
    token: str


@pytest.fixture(autouse=True)
def home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A folder of settings that is nobody's: who withdraws here loses nothing."""
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path / "home"))


@pytest.fixture
def study(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Study]:
    """A study that has just been begun, by `PLAN` or by the parameter."""
    (tmp_path / "plan.yaml").write_text(getattr(request, "param", PLAN), "utf-8")
    desk = Desk(Session(tmp_path), Devices(checks=lambda: CHECKS))
    try:
        with served(lambda access: session_app(desk, access)) as running:
            address, _, token = running.experimenter_address.partition("?")
            console = f"{address}console?{token}"
            yield Study(desk, running.address, console, f"?{token}")
    finally:
        desk.close()


@pytest.fixture
def open_page(browser: Browser) -> Iterator[OpenPage]:
    """Opens pages of one person; what goes wrong in them fails the test."""
    opened = OpenPage(browser)
    yield opened
    opened.context.close()
    assert opened.wrong == []


class OpenPage:
    """Opens pages in one context.

    Attributes:
        wrong: What went wrong; a test takes out what it caused.
    """

    def __init__(self, browser: Browser) -> None:
        self.context = browser.new_context(viewport={"width": 1280, "height": 720})
        self.wrong: list[str] = []

    def __call__(self, address: str) -> Page:
        """A new page at an address."""
        page = self.context.new_page()
        page.set_default_timeout(60_000.0)
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on(
            "console",
            lambda m: self.wrong.append(m.text) if m.type == "error" else None,
        )
        page.goto(address)
        return page
