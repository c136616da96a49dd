"""Answers as they come from a page, checked before they are kept."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping
from typing import Literal, NamedTuple

from costeer.sessions.questionnaires.definition import Definition, Item
from costeer.sessions.questionnaires.instrument import Instrument

Value = float | str
"""A number for scales and numbers; for all else a text."""

Code = Literal[
    "missing",
    "not_a_number",
    "out_of_range",
    "off_step",
    "not_an_option",
    "must_agree",
    "not_text",
    "too_long",
    "personal",
    "unknown",
]
"""What may be wrong; the page's texts have `error_CODE` for each."""

MOST_ITEMS = 500
"""Most answers that are looked at."""


class Problem(NamedTuple):
    """What is wrong with one answer.

    Attributes:
        code: For the page, which says it in the participant's language.
        text: For whoever reads a log.
    """

    code: Code
    text: str


class AnswersError(ValueError):
    """Answers are missing or wrong; `problems` names each by its item."""

    def __init__(self, name: str, problems: Mapping[str, Problem]) -> None:
        self.problems = dict(problems)
        told = "; ".join(f"{item} {p.text}" for item, p in problems.items())
        super().__init__(f"{name}: {told}")

    def codes(self) -> dict[str, str]:
        """Code of each problem by item, for the page."""
        return {item: problem.code for item, problem in self.problems.items()}


def checked_answers(
    instrument: Instrument | Definition, given: Mapping[str, object]
) -> dict[str, Value]:
    """Answers that fit an instrument; what was left out and may be is not there.

    A text stays what it is, also if it looks like HTML: it is data.

    Args:
        instrument: What was asked.
        given: Value by item, as JSON gives it; None and "" are no answers.

    Raises:
        AnswersError: If answers are missing, out of range, between two steps, too
            long, not asked for or personal; all of them are named at once.
    """
    if not isinstance(given, Mapping):  # what a page sends may be anything
        raise AnswersError(instrument.name, {"answers": Problem("unknown", "are none")})
    problems: dict[str, Problem] = {}
    answers: dict[str, Value] = {}
    for item in instrument.items:
        value = given.get(item.name)
        if isinstance(value, str):
            value = cleaned(value)
        if value is None or value == "":
            if item.required:
                problems[item.name] = Problem("missing", "has no answer")
            continue
        found = _checked(item, value)
        if isinstance(found, Problem):
            problems[item.name] = found
        else:
            answers[item.name] = found
    known = {item.name for item in instrument.items}
    for name in sorted(map(str, set(given) - known))[:MOST_ITEMS]:
        text = f"is not asked; {instrument.name} has {len(known)} items"
        problems[_short(name)] = Problem("unknown", text)
    if problems:
        raise AnswersError(instrument.name, problems)
    return answers


def _checked(item: Item, value: object) -> Value | Problem:
    """The answer, or what is wrong with it."""
    if item.kind in ("scale", "number"):
        return _number(item, value)
    if item.kind == "text":
        return _text(item, value)
    if value not in item.options:
        listed = ", ".join(item.options)
        return Problem("not_an_option", f"is {_short(value)}; give one of {listed}")
    if item.must_agree and value != "yes":
        return Problem("must_agree", "is not agreed to; without it the session ends")
    return str(value)


def _number(item: Item, value: object) -> float | Problem:
    """A number on one of the steps."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return Problem("not_a_number", f"is {_short(value)}; give a number")
    if not item.low <= value <= item.high:  # also if it is not a number
        limits = f"{item.low:g} to {item.high:g}"
        return Problem("out_of_range", f"is {_short(value)}; give {limits}")
    steps = (value - item.low) / item.step
    if not math.isclose(steps, round(steps), abs_tol=1e-6):
        asked = f"{item.low:g} to {item.high:g} in steps of {item.step:g}"
        return Problem("off_step", f"is {_short(value)}; give {asked}")
    return item.low + round(steps) * item.step


def _text(item: Item, value: object) -> str | Problem:
    """A text that says nothing of how to reach someone."""
    if not isinstance(value, str):
        return Problem("not_text", f"is {_short(value)}; give a text")
    if len(value) > item.longest:
        told = f"has {len(value)} characters; give at most {item.longest}"
        return Problem("too_long", told)
    what = personal(value)
    if what:
        told = f"looks as if it held {what}; leave that out, answers bear no names"
        return Problem("personal", told)
    return value


_BIDI = re.compile("[\u202a-\u202e\u2066-\u2069]")
"""Marks that make a text read in another order than it is kept."""


def cleaned(text: str) -> str:
    """A text without control characters; line ends stay, tabs become spaces."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").replace("\t", " ")
    kept = (c for c in text if c == "\n" or unicodedata.category(c) not in ("Cc", "Cs"))
    return _BIDI.sub("", "".join(kept)).strip()


_EMAIL = re.compile(
    r"[^\s@]{1,64}\s{0,2}(?:@|[(\[{]\s?at\s?[)\]}])\s{0,2}[^\s@.]{1,64}"
    r"\s?(?:\.|[(\[{]\s?dot\s?[)\]}])\s?\w"
)
_DATE = re.compile(
    r"(?<!\d)(?:\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4})(?!\d)"
)
_GROUPS = re.compile(r"(?<![\w.,])[+(]{0,2}\d(?:[ ()/.-]{0,3}\d){6,16}(?![\w.,]*\d)")
_DIALLED = re.compile(
    r"[+(]|0\d|\d{7,}$|\d{3}[ .-]\d{3}[ .-]\d{4}$|\d{3,5}-\d{3,5}$|1-\d{3}-\d{3}"
)


def personal(text: str) -> str:
    """What a text seems to hold to reach someone by; empty if nothing.

    Dates and plain decimal numbers are no phone numbers. Seven digits in a row are, so
    that a few harmless answers are refused rather than a number kept.
    """
    plain = unicodedata.normalize("NFKC", text)
    if _EMAIL.search(plain):
        return "an e-mail address"
    plain = re.sub(r"[‐-―−]", "-", plain)
    for found in _GROUPS.finditer(_DATE.sub(" ", plain)):
        number = found[0]
        if re.fullmatch(r"\d+\.\d+", number):
            continue
        if _DIALLED.match(number):
            return "a phone number"
    return ""


def _short(value: object) -> str:
    """A value for a message, cut where it is long."""
    shown = value if isinstance(value, str) and value.isidentifier() else repr(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."
