"""No form breaks a rule of axe-core, in no language and in no light."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import pytest

from costeer.sessions.questionnaires.definition import instrument_names
from tests.web.session.conftest import show

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

EVERY = list(itertools.product(instrument_names(), ("en", "de", "ja")))

CHOOSE = "for (const row of document.querySelectorAll('.row')) row.firstChild.click()"
"""Chooses the first answer wherever there are some to choose from."""


def violations(page: Page) -> list[str]:
    """Rules that the page breaks, and where."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    found = axe.run(page).response["violations"]
    return [f"{rule['id']}: {node['html']}" for rule in found for node in rule["nodes"]]


@pytest.mark.parametrize(("name", "language"), EVERY)
def test_axe_finds_nothing(page: Page, name: str, language: str) -> None:
    # No transition may be half way when colours are compared.
    page.emulate_media(color_scheme="light", reduced_motion="reduce")
    show(page, name, language)
    assert violations(page) == []
    page.evaluate(CHOOSE)
    page.locator("button.main").click()  # errors where there is more to answer
    page.emulate_media(color_scheme="dark", reduced_motion="reduce")
    assert violations(page) == []


def test_axe_finds_what_is_wrong(page: Page) -> None:
    show(page, "fms")
    page.evaluate(
        "for (const input of document.querySelectorAll('input'))"
        " input.removeAttribute('aria-label')"
    )
    assert any(rule.startswith("label") for rule in violations(page))
