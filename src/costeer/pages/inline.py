"""An SVG file as part of a page: no name of one figure meets that of another."""

from __future__ import annotations

import re
from html import escape

_ID = re.compile(r'\bid="([^"]+)"')
_REFERENCE = re.compile(r'(xlink:href="#|url\(#)([^")]+)')
_OPENING = re.compile(r"<svg\b[^>]*>")
_UNNEEDED = re.compile(
    r"<\?xml.*?\?>|<!DOCTYPE.*?>|<!--.*?-->|<metadata>.*?</metadata>"
    r"|<title>.*?</title>",
    re.DOTALL,
)
_VIEW_BOX = re.compile(r'viewBox="([^"]+)"')


def inline_svg(svg: str, name: str, title: str, description: str) -> str:
    """Return the `svg` element to put into a page.

    Args:
        svg: Content of the file.
        name: Of the figure; begins every id, so that two figures never clash.
        title: For those who do not see it.
        description: The same, in more words.
    """
    body = _ID.sub(rf'id="{name}-\1"', _UNNEEDED.sub("", svg))
    body = _REFERENCE.sub(rf"\g<1>{name}-\2", body)
    opening = _OPENING.search(body)
    box = _VIEW_BOX.search(body)
    if opening is None or box is None:
        raise ValueError(f"figure {name} is no SVG with a viewBox; draw it again")
    words = (
        f'<title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-desc">{escape(description)}</desc>'
    )
    head = (
        '<svg xmlns="http://www.w3.org/2000/svg" '
        'xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="{box[1]}" role="img" aria-labelledby="{name}-title {name}-desc">'
    )
    return f"{head}{words}{body[opening.end() :].strip()}"
