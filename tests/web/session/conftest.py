"""A page with nothing but a form, under the content policy of the real server."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from costeer.sessions.questionnaires.instrument import load_instrument, rendered
from costeer.sessions.questionnaires.texts import load_texts
from tests.web.page.conftest import browser as browser  # a fixture
from tests.web.page.stub import POLICY, STATIC

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

ORIGIN = "http://costeer.test"
PAGE = """<!doctype html><html lang="en"><head><title>costeer</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,"><link rel="stylesheet" href="/session.css"></head>
<body><main id="root"></main></body></html>"""

SHOW = """async ([instrument, texts]) => {
  const isConsent = instrument.name === "consent";
  const module = isConsent ? "consent" : "questionnaire";
  const made = await import(`/js/session/${module}.js`);
  const show = isConsent ? made.renderConsent : made.renderQuestionnaire;
  window.sent = [];
  window.declined = 0;
  window.failure = null;
  const submit = async (answers) => {
    if (window.failure) throw Object.assign(new Error("no link."), window.failure);
    window.sent.push(answers);
  };
  document.documentElement.lang = instrument.language;
  show(document.getElementById("root"), instrument, texts, submit,
    () => { window.declined += 1; });
}"""


def answer(route: Route) -> None:
    """A file of the page, with the server's policy."""
    path = route.request.url.removeprefix(ORIGIN).split("?")[0]
    policy = {"Content-Security-Policy": POLICY.decode()}
    if path == "/":
        route.fulfill(body=PAGE, content_type="text/html", headers=policy)
    elif (file := STATIC / path.lstrip("/")).is_file():
        route.fulfill(path=file, headers=policy)
    else:
        route.fulfill(status=404)


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty page; what goes wrong in it fails the test."""
    wrong: list[str] = []
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda m: wrong.append(m.text) if m.type == "error" else None)
    page.route(f"{ORIGIN}/**", answer)
    page.goto(f"{ORIGIN}/")
    yield page
    context.close()
    assert wrong == []


Json = dict[str, Any]  # Any: as JSON has it


def show(
    page: Page, name: str, language: str = "en", seed: int = 1, **texts: Any
) -> Json:
    """Show an instrument of costeer; return what the page was given.

    Args:
        page: To show it on.
        name: Of the instrument.
        language: Code of its language.
        seed: Of the step.
        texts: Replace fields of the JSON, to try what a lab might write.
    """
    given = rendered(load_instrument(name, language), seed) | texts
    page.evaluate(SHOW, [given, load_texts(language).pages])
    return given
