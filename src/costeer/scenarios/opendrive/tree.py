"""XML with line numbers, and nothing that makes a small file large in memory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.parsers import expat

from costeer.base.files import read_whole

_LARGEST = 60_000_000
"""Longest file that is read [bytes]."""

_MOST_ELEMENTS = 1_000_000
_DEEPEST = 60

_FARTHEST = 1e8
"""No number of a road is larger [m]: twice around the earth."""

_NOT_OPENED = ("objects", "signals", "surface", "railroad", "userData", "junction")
"""Elements of which nothing inside is needed."""


class Element(NamedTuple):
    """An element of a file.

    Attributes:
        file: That it stands in.
        name: Of the element.
        line: Where it begins.
        given: Its attributes.
        children: Elements in it.
    """

    file: str
    name: str
    line: int
    given: dict[str, str]
    children: list[Element]

    @property
    def where(self) -> str:
        """File and line, for messages."""
        return f"{self.file}, line {self.line}"

    def all(self, name: str) -> list[Element]:
        """Children of a name."""
        return [each for each in self.children if each.name == name]

    def first(self, name: str) -> Element | None:
        """First child of a name."""
        return next(iter(self.all(name)), None)

    def below(self, *path: str) -> list[Element]:
        """Elements at the end of a path of names."""
        found = [self]
        for name in path:
            found = [child for each in found for child in each.all(name)]
        return found

    def number(self, name: str, missing: float = math.nan) -> float:
        """A number.

        Args:
            name: Of the attribute.
            missing: Where it is not given; NaN: it must be.

        Raises:
            ValueError: If it is none, or missing.
        """
        text = self.given.get(name)
        if text is None and not math.isnan(missing):
            return missing
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not abs(value) <= _FARTHEST:
            told = "is missing" if text is None else f"is {text[:40]!r}"
            told = f"{name} of <{self.name}> {told}; give a number up to {_FARTHEST:g}"
            raise ValueError(f"{self.where}: {told}")
        return value


class _Reader:
    """Builds the tree while the parser reads."""

    def __init__(self, name: str) -> None:
        self.root = Element(name, "", 0, {}, [])
        self.open = [self.root]
        self.closed_below: int | None = None
        self.count = 0
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.StartDoctypeDeclHandler = self.refuse

    def start(self, name: str, given: dict[str, str]) -> None:
        self.count += 1
        element = Element(
            self.root.file, name, self.parser.CurrentLineNumber, given, []
        )
        if len(self.open) > _DEEPEST or self.count > _MOST_ELEMENTS:
            raise ValueError(
                f"{element.where}: the file holds more than a road has; cut it"
            )
        if self.closed_below is None:
            self.open[-1].children.append(element)
            if name in _NOT_OPENED:
                self.closed_below = len(self.open)
        self.open.append(element)

    def end(self, _: str) -> None:
        self.open.pop()
        if self.closed_below is not None and len(self.open) <= self.closed_below:
            self.closed_below = None

    def refuse(self, *_: object) -> None:
        # Entities are declared there: a few lines could stand for gigabytes, or for
        # another file.
        line = self.parser.CurrentLineNumber
        raise ValueError(
            f"{self.root.file}, line {line}: a document type (<!DOCTYPE>) is not read; "
            "remove it"
        )


def read_tree(path: Path) -> Element:
    """The element `OpenDRIVE` of a file.

    Raises:
        ValueError: If it is no such file, naming the line.
        OSError: If it cannot be read.
    """
    return parsed_tree(read_whole(path, _LARGEST), str(path))


def parsed_tree(text: bytes, name: str) -> Element:
    """The element `OpenDRIVE` of a text.

    Args:
        text: XML in any encoding that it declares.
        name: Of the file, for messages.

    Raises:
        ValueError: If it is none, naming the line.
    """
    reader = _Reader(name)
    try:
        reader.parser.Parse(text, True)
    except expat.ExpatError as error:
        told = expat.ErrorString(error.code)
        raise ValueError(
            f"{name}, line {error.lineno}: no XML: {told}; give a whole file"
        ) from error
    except (LookupError, ValueError) as error:
        if str(error).startswith(name):  # refused above
            raise
        told = f"is in an encoding that is not read ({error}); save it as UTF-8"
        raise ValueError(f"{name} {told}") from error
    root = reader.root.children[0]
    if root.name.rpartition(":")[2] != "OpenDRIVE":
        raise ValueError(
            f"{root.where}: the file begins with <{root.name[:40]}>; give a file of "
            "OpenDRIVE roads"
        )
    return root


def walk(element: Element) -> Iterator[Element]:
    """An element and everything in it."""
    yield element
    for child in element.children:
        yield from walk(child)
