"""Output that is not UTF-8: what it cannot show is written in letters that it can."""

from __future__ import annotations

import codecs
import sys
import unicodedata

_WORDS = {
    "·": "*",
    "°": " deg",
    "µ": "u",
    "–": "-",
    "—": "-",
    "−": "-",
    "…": "...",
    "±": "+/-",
    "≤": "<=",
    "≥": ">=",
    "α": "alpha",
    "β": "beta",
    "δ": "delta",
    "Δ": "Delta",
    "θ": "theta",
    "λ": "lambda",
    "τ": "tau",
    "ψ": "psi",
    "━": "-",
    "─": "-",
    "┃": "|",
    "│": "|",
}
"""What stands for a letter that an encoding lacks."""

_BOXES = range(0x2500, 0x2580)
_NAME = "costeer.substitute"


def _substitute(error: UnicodeError) -> tuple[str, int]:
    """The handler of letters that cannot be encoded."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    return "".join(map(_plain, lacking)), error.end


def _plain(letter: str) -> str:
    """ASCII that stands for a letter; ? if nothing does."""
    if letter in _WORDS:
        return _WORDS[letter]
    if ord(letter) in _BOXES:
        return "+"
    parts = unicodedata.normalize("NFKD", letter)
    return parts.encode("ascii", "ignore").decode() or "?"


def write_any_text() -> None:
    """Let stdout and stderr write any text, whatever their encoding."""
    codecs.register_error(_NAME, _substitute)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=_NAME)
