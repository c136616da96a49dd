"""What a file or a participant is called is text on a page, never a part of it."""

from __future__ import annotations

import re

from costeer.pages.frame import Section, render_page
from costeer.pages.tables import Table

WORDS = "<script>alert('P01')</script>"


def page() -> str:
    table = Table("t", WORDS, WORDS, (WORDS, "x"), ((WORDS, "1"),))
    words = dict.fromkeys(("title", "heading", "subtitle"), WORDS)
    return render_page(
        "judgement.html",
        [Section("s", WORDS, (WORDS,), (table,))],
        {
            **words,
            "looked_at": (WORDS,),
            "outcomes": ((WORDS, WORDS),),
            "caution": (WORDS, WORDS),
        },
    )


def test_no_word_becomes_markup() -> None:
    assert "<script>alert" not in page()
    assert page().count("&lt;script&gt;alert") == 15


def test_a_caption_stands_beside_what_scrolls() -> None:
    (scrolled,) = re.findall(r'<div class="table".*?</div>', page(), re.DOTALL)
    assert "<table" in scrolled
    assert "Table 1." not in scrolled
    assert 'aria-labelledby="caption-t"' in scrolled
