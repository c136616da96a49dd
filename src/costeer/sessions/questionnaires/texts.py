"""Words of questionnaires and pages, a YAML file per language.

Those of costeer are in `texts/`. A study folder changes single words by
`texts/LANGUAGE.yaml` with only what differs, or brings a language of its own.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from costeer.sessions.questionnaires.definition import own_folder, read_mapping

Words = Mapping[str, Any]  # Any: nested texts as YAML gives them back

BLANK = re.compile(r"\[\[(\w+)\]\]")
"""A place in a text that a study fills: `[[contact]]`."""

_FIELDS = {"language", "wording", "blanks", "pages", "instruments"}


class Texts(NamedTuple):
    """All words in one language.

    Attributes:
        language: Code of the language, for the page's `lang`.
        pages: Words of the session's pages, by key.
        instruments: Words of the instruments, by name.
        blanks: What the study puts into `[[...]]`.
    """

    language: str
    pages: dict[str, str]
    instruments: dict[str, Words]
    blanks: dict[str, str]


def languages(folder: Path | None = None) -> tuple[str, ...]:
    """Codes of all languages, those of the study folder among them."""
    places = [own_folder("texts"), *([folder / "texts"] if folder else [])]
    return tuple(sorted({f.stem for place in places for f in place.glob("*.yaml")}))


def load_texts(language: str, folder: Path | None = None) -> Texts:
    """The words in a language, those of the study folder over those of costeer.

    Args:
        language: Its code, which is the name of the file without `.yaml`.
        folder: The study folder, which may have `texts/LANGUAGE.yaml`.

    Raises:
        ValueError: If there is no such language, a file is wrong, or words of the
            pages are missing.
        OSError: If a file cannot be read.
    """
    if language not in languages(folder):
        raise ValueError(
            f"there is no language {language!r}; choose from "
            f"{', '.join(languages(folder))}, or write texts/{language}.yaml in the "
            "study folder"
        )
    places = [own_folder("texts"), *([folder / "texts"] if folder else [])]
    paths = [f for place in places if (f := place / f"{language}.yaml").is_file()]
    words: dict[str, Any] = {}
    for path in paths:
        said = read_mapping(path)
        unknown = sorted(set(said) - _FIELDS)
        if unknown:
            raise ValueError(
                f"{path}: there is no field {unknown[0]!r}; choose from "
                f"{', '.join(sorted(_FIELDS))}"
            )
        _refuse_shapes(path, said)
        words = merged(words, said)
    blanks = {k: str(v) for k, v in words.get("blanks", {}).items() if v}
    pages = {k: filled(str(v), blanks) for k, v in words.get("pages", {}).items()}
    _refuse_missing(paths[-1], pages)
    return Texts(language, pages, words.get("instruments", {}), blanks)


def _refuse_shapes(path: Path, said: Words) -> None:
    """Raise ValueError where neither words nor lines of them are written."""
    for field in ("wording", "blanks", "pages"):
        for key, text in _lines(path, field, said.get(field, {})).items():
            if not isinstance(text, str):
                raise ValueError(f"{path}: {field}: {key}: give a text in quotes")
    for name, words in _lines(path, "instruments", said.get("instruments", {})).items():
        items = _lines(path, name, words).get("items", {})
        for item, text in _lines(path, f"{name}: items", items).items():
            if not isinstance(text, str):
                _lines(path, f"{name}: {item}", text)
        instruction = words.get("instruction", [])
        if not isinstance(instruction, str | list):
            raise ValueError(f"{path}: {name}: instruction: give a list of paragraphs")
        for each in (words, *(i for i in items.values() if isinstance(i, dict))):
            _lines(path, f"{name}: labels", each.get("labels", {}))


def _lines(path: Path, where: str, value: object) -> Words:
    if not isinstance(value, dict):
        raise ValueError(f"{path}: {where}: give NAME: VALUE lines")
    return value


def _refuse_missing(path: Path, pages: Mapping[str, str]) -> None:
    """Raise ValueError if the pages lack words that the English ones have."""
    wanted = read_mapping(own_folder("texts") / "en.yaml")["pages"]
    missing = sorted(set(wanted) - set(pages))
    if missing:
        raise ValueError(f"{path}: pages: words are missing: {', '.join(missing)}")


def merged(under: Words, over: Words) -> dict[str, Any]:  # Any: nested texts
    """Words with others laid over them, level by level.

    A text alone is the `text` of an item that has more.
    """
    both = dict(under)
    for key, value in over.items():
        below = both.get(key)
        if isinstance(below, dict) and isinstance(value, str):
            value = {"text": value}
        elif isinstance(below, str) and isinstance(value, dict):
            below = {"text": below}
        if isinstance(value, dict) and isinstance(below, dict):
            value = merged(below, value)
        both[key] = value
    return both


def filled(text: str, blanks: Mapping[str, str]) -> str:
    """A text with the blanks that the study fills; others stay as they are."""
    return BLANK.sub(lambda found: blanks.get(found[1], found[0]), text)
