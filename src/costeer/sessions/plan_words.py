"""The words of a plan: that they are there, and what of them is left to the lab."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from pathlib import Path

from costeer.sessions.plan import Plan
from costeer.sessions.questionnaires.instrument import load_instrument, unfilled
from costeer.sessions.questionnaires.texts import load_texts

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
"""What a name of the text files looks like; one word may be a text, too."""

_ALIKE = 0.75
"""Words that are this much alike are the same one, mistyped."""


def check_words(plan: Plan, folder: Path | None, language: str = "") -> None:
    """Refuse a plan whose words or questionnaires are not there.

    Args:
        plan: Of the study.
        folder: Of the study, which may bring its own; None before there is one.
        language: Of a participant; the plan's if empty.

    Raises:
        ValueError: Naming what is missing.
        OSError: If a file cannot be read.
    """
    chosen = language or plan.language
    pages = load_texts(chosen, folder).pages
    for each in plan.steps:
        for step in (each, *each.after):
            _check_text(step.text, pages, chosen)
            if step.instrument:
                load_instrument(step.instrument, chosen, folder)


def _check_text(text: str, pages: Mapping[str, str], language: str) -> None:
    """Refuse a name that no page has: participants would read the name.

    Raises:
        ValueError: Naming those that there are.
    """
    if not _NAME.fullmatch(text) or f"{text}_text" in pages:
        return
    known = [
        key.removesuffix("_text")
        for key in pages
        if key.endswith("_text") and f"{key.removesuffix('text')}title" in pages
    ]
    alike = difflib.get_close_matches(text, known, n=1, cutoff=_ALIKE)
    if "_" in text or alike:
        meant = f" (did you mean {alike[0]}?)" if alike else ""
        raise ValueError(
            f"text '{text}' is no page{meant}; choose from {', '.join(known)}, or "
            f"write {text}_title and {text}_text under pages in texts/{language}.yaml "
            "of the study folder"
        )


def blank_notes(plan: Plan, folder: Path) -> list[str]:
    """Which places of the consent the lab has not filled; participants read them.

    Raises:
        ValueError: If words or questionnaires are not there.
        OSError: If a file cannot be read.
    """
    names = {each.instrument for each in plan.steps if each.kind == "consent"}
    told = []
    for name in sorted(names):
        empty = unfilled(load_instrument(name, plan.language, folder))
        if empty:
            file = f"{folder}/texts/{plan.language}.yaml"
            left = ", ".join(empty)
            told.append(f"{name} has blanks: {left}; fill them in {file}")
    return told
