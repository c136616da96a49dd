"""Words of a session's pages, read anew when a lab changes them in the middle."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from costeer.sessions.questionnaires.instrument import Instrument, load_instrument
from costeer.sessions.questionnaires.texts import load_texts

_Read = TypeVar("_Read")

Stamp = tuple[tuple[str, int, int], ...]
"""Name, time and size of every file of a lab's own words."""


class Wording:
    """Texts and questionnaires of a study.

    A file that was changed and cannot be read any more does not stop a session: the
    last words that could be are shown on, and `trouble` says what is wrong.

    Args:
        folder: Of the study.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._kept: dict[tuple[str, ...], tuple[Stamp, object]] = {}
        self._wrong: dict[tuple[str, ...], str] = {}

    @property
    def trouble(self) -> str:
        """What is wrong with the files now; empty if nothing is."""
        return "; ".join(dict.fromkeys(self._wrong.values()))

    def pages(self, language: str) -> dict[str, str]:
        """Words of the pages.

        Raises:
            ValueError: If they never could be read.
            OSError: If a file cannot be read.
        """
        return self._newest(
            (language,), lambda: load_texts(language, self._folder).pages
        )

    def instrument(self, name: str, language: str) -> Instrument:
        """A questionnaire with its words.

        Raises:
            ValueError: If it never could be read.
            OSError: If a file cannot be read.
        """
        return self._newest(
            (language, name), lambda: load_instrument(name, language, self._folder)
        )

    def _newest(self, key: tuple[str, ...], read: Callable[[], _Read]) -> _Read:
        """What is kept under a key, read again if a file has changed since.

        Raises:
            ValueError: If it never could be read.
            OSError: If a file cannot be read.
        """
        stamp = self._stamp()
        known = self._kept.get(key)
        if known is not None and known[0] == stamp:
            return known[1]  # type: ignore[return-value]  # a key has one kind of value
        try:
            found = read()
        except (ValueError, OSError) as error:
            if known is None:
                raise
            self._wrong[key] = f"{error}; the words from before are shown"
            found = known[1]  # type: ignore[assignment]  # as above
        else:
            self._wrong.pop(key, None)
        self._kept[key] = stamp, found
        return found

    def _stamp(self) -> Stamp:
        files = [
            file
            for room in ("texts", "instruments")
            for file in sorted((self._folder / room).glob("*.yaml"))
        ]
        told = [(str(file), file.stat()) for file in files if file.is_file()]
        return tuple((name, about.st_mtime_ns, about.st_size) for name, about in told)
