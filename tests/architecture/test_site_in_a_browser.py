"""The documentation site as a reader meets it: on a desk, on a phone, in the dark."""

from __future__ import annotations

import functools
import http.server
import os
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page

from tests.architecture.source import ROOT
from tests.web.browser import page_of

pytestmark = pytest.mark.slow

PAGES = ("index.html", "gallery.html", "api/records.html", "measures.html")


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files and tells nobody."""

    def log_message(self, *told: object) -> None:
        """Say nothing."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of the built site."""
    pytest.importorskip("material", reason="mkdocs-material is not installed")
    folder = tmp_path_factory.mktemp("site")
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"]
    done = subprocess.run(
        [*words, "--site-dir", str(folder)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    serve = functools.partial(Quiet, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), serve)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


def asked_elsewhere(page: Page, site: str) -> list[str]:
    """The list that gathers what a page asks of other servers."""
    asked: list[str] = []
    page.on(
        "request",
        lambda request: (
            None
            if request.url.startswith((site, "data:", "blob:"))
            else asked.append(request.url)
        ),
    )
    return asked


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark")])
def test_pages_can_be_read_by_everybody(site: str, width: int, scheme: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    with page_of(width, 900) as (page, wrong):
        # No transition may be half way when colours are compared.
        page.emulate_media(
            color_scheme=scheme,  # type: ignore[arg-type]  # one of two
            reduced_motion="reduce",
        )
        asked = asked_elsewhere(page, site)
        for name in PAGES:
            page.goto(site + name)
            page.wait_for_selector(".md-search[aria-label]", state="attached")
            wide = page.evaluate(
                "document.documentElement.scrollWidth"
                " > document.documentElement.clientWidth"
            )
            assert not wide, name
            found = axe.run(page).response["violations"]
            assert [(name, v["id"], v["nodes"][0]["html"]) for v in found] == []
        assert (asked, wrong) == ([], [])


def test_the_search_finds_a_page_by_its_words(site: str) -> None:
    with page_of(1280, 900) as (page, wrong):
        asked = asked_elsewhere(page, site)
        page.goto(site + "index.html")
        # The page listens to keys let go, which `fill` does not send.
        page.get_by_role("textbox", name="Search").press_sequentially("pseudo-work")
        found = page.locator(".md-search-result__link").first
        found.wait_for()
        assert "html" in (found.get_attribute("href") or "")
        assert (asked, wrong) == ([], [])
