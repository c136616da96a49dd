"""Chromium for the tests of the page; they are left out where there is none."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import pytest

from benchmarks.speed.pace import CHROMIUM
from tests.web.browser import chromium as chromium_path

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PATIENCE = 60.0
"""Longest wait for the page [s]: others may use the machine at the same time."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One Chromium for a module; skips where browser or libraries are missing."""
    api = pytest.importorskip("playwright.sync_api")
    program = chromium_path()
    with api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=program, args=list(CHROMIUM)
        )
        yield chromium
        chromium.close()


def until(page: Page, expression: str) -> Any:  # Any: what the expression gives
    """Value of an expression in the page as soon as it is true.

    The page's content policy forbids `wait_for_function`, which evaluates text.
    """
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        if value := page.evaluate(expression):
            return value
        page.wait_for_timeout(20)
    raise AssertionError(f"not true within {PATIENCE:g} s: {expression}")


def wait_for(page: Page, happened: Callable[[], bool]) -> None:
    """Let the page go on until something happened outside it."""
    deadline = time.monotonic() + PATIENCE
    while not happened():
        assert time.monotonic() < deadline, "it did not happen"
        page.wait_for_timeout(20)
