"""Drawings in one page do not disturb each other."""

from __future__ import annotations

import pytest

from costeer.pages.inline import inline_svg

FILE = """<?xml version="1.0"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/svg11.dtd">
<svg xmlns="http://www.w3.org/2000/svg" width="10pt" viewBox="0 0 10 10">
<title>as written</title><metadata>by a program</metadata><!-- a comment -->
<defs><path id="m1" d="M0 0"/><clipPath id="c1"><rect/></clipPath></defs>
<use xlink:href="#m1" clip-path="url(#c1)"/></svg>
"""


def test_ids_and_references_get_the_name_of_the_figure() -> None:
    svg = inline_svg(FILE, "sdlp", "Title", "Description")
    assert 'id="sdlp-m1"' in svg
    assert 'xlink:href="#sdlp-m1"' in svg
    assert "url(#sdlp-c1)" in svg


def test_declarations_and_metadata_are_left_out() -> None:
    svg = inline_svg(FILE, "sdlp", "Title", "Description")
    for word in ("<?xml", "DOCTYPE", "metadata", "comment", "as written", "width="):
        assert word not in svg


def test_words_for_those_who_do_not_see_it_are_escaped() -> None:
    svg = inline_svg(FILE, "sdlp", "a < b", "R&D")
    assert '<title id="sdlp-title">a &lt; b</title>' in svg
    assert '<desc id="sdlp-desc">R&amp;D</desc>' in svg
    assert 'aria-labelledby="sdlp-title sdlp-desc"' in svg


def test_what_is_no_drawing_is_refused() -> None:
    with pytest.raises(ValueError, match="figure sdlp is no SVG"):
        inline_svg("<p>none</p>", "sdlp", "", "")
