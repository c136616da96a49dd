"""The campaign of attacks tells what is let in from what is not."""

from __future__ import annotations

from http.client import HTTPMessage

import pytest

from benchmarks.attacks import attacked, counted, may_run
from tests.web.served import Answer

EVIL = "<script>alert(1)</script>"
SAFE = {
    "Content-Security-Policy": "default-src 'self'",
    "X-Content-Type-Options": "nosniff",
    "Content-Type": "application/json",
}


def sent(**changed: str) -> Answer:
    """An answer that bears the text; headers with the underscores of Python."""
    headers = HTTPMessage()
    given = SAFE | {name.replace("_", "-"): text for name, text in changed.items()}
    for name, text in given.items():
        headers[name] = text
    return Answer(200, headers, b'{"title": "' + EVIL.encode() + b'"}')


def test_text_in_a_page_or_in_what_may_be_taken_for_one_may_run() -> None:
    assert not may_run(sent(), EVIL)
    assert may_run(sent(Content_Type="text/html"), EVIL)
    assert may_run(sent(X_Content_Type_Options=""), EVIL)
    assert may_run(sent(Content_Security_Policy=""), EVIL)
    assert may_run(sent(Content_Security_Policy="default-src 'self'; script-src *"), "")
    assert not may_run(sent(Content_Type="text/html"), "<b>another</b>")


def test_answers_are_counted_by_what_became_of_them() -> None:
    found = counted("x", iter([(True, 200), (False, 403), (False, 500), (True, 503)]))
    assert found == ("x", 4, 2, 2)


@pytest.mark.slow
def test_nothing_is_let_in() -> None:
    for tally in attacked(5):
        assert tally.tried >= 5, tally.name
        assert (tally.let_in, tally.errors) == (0, 0), tally.name
