"""Text and its dialects: tables as programs and laboratories write them.

Separator, decimal mark and encoding are found out from the text, as far as nobody
names them; whatever is not the usual is told in a note.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import pyarrow as pa
import pyarrow.csv

from costeer.records.arrow import refuse_twice

NAMES = ("participant", "sequence")
"""Columns that hold names, whatever the names look like."""

_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "vertical bars"}
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_QUOTED = re.compile(r'"[^"]*"')
_JAPANESE = re.compile("[\u3040-\u30ff\u4e00-\u9fff]{2}")
_PRIVATE = re.compile("[\ue000-\uf8ff]")
_POINT, _COMMA = re.compile(r"\d\.\d"), re.compile(r"\d,\d")
_NUM_LINES = 200
"""Lines that are looked at."""


class Reading(NamedTuple):
    """How a text is to be read; what is empty is found out.

    Attributes:
        separator: Between columns.
        decimal: Decimal mark, point or comma.
        encoding: By Python's name.
    """

    separator: str = ""
    decimal: str = ""
    encoding: str = ""


AS_FOUND = Reading()


class Found(NamedTuple):
    """A table and what was assumed of it.

    Attributes:
        table: Its columns.
        notes: What a reader should know of how it was read.
    """

    table: pa.Table
    notes: tuple[str, ...] = ()


@contextmanager
def understood(path: str | os.PathLike[str], what: str = "") -> Iterator[None]:
    """Turn whatever a damaged file makes its reader raise into one line.

    Args:
        path: Of the file.
        what: It is found to be, if it cannot be read; "is damaged" if empty.

    Raises:
        ValueError: Naming the file.
    """
    try:
        yield
    except (pa.ArrowException, UnicodeError) as error:
        told = f"{path} {what or 'is damaged'}: {_first_line(error)}"
        raise ValueError(told) from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    except Exception as error:  # it depends on where the damage lies
        kind = type(error).__name__
        told = f"{path} {what or 'is damaged'}: {kind}: {_first_line(error)}"
        raise ValueError(f"{told}; restore the file or write it anew") from error


def text_table(content: bytes, reading: Reading = AS_FOUND) -> Found:
    """A table in text, of whatever separator, decimal mark and encoding.

    Raises:
        ValueError: If a name stands twice, or an encoding is not known.
        pyarrow.ArrowException: If it is no table.
    """
    encoding = reading.encoding or _encoding(content)
    try:
        text = content.decode(encoding)
    except LookupError as error:
        raise ValueError(
            f"there is no encoding {encoding!r}; give one of Python's, as utf-8, "
            "cp1252 or cp932"
        ) from error
    said, _, rest = text.partition("\n")
    if said.strip().lower().startswith("sep=") and not reading.separator:
        reading, text = reading._replace(separator=said.strip("\r\n")[4:]), rest
    lines = [line for line in text[: _NUM_LINES * 4000].splitlines() if line.strip()]
    separator = reading.separator or _separator(lines)
    if separator == " ":
        text = "\n".join("\t".join(line.split()) for line in text.splitlines())
    decimal = reading.decimal or _decimal(lines[1:_NUM_LINES], separator)
    between = "\t" if separator == " " else separator
    table = _parsed(text.encode(), between, decimal)
    assumed = Reading(separator, decimal, encoding)
    return Found(table, _notes(reading, assumed))


def _encoding(content: bytes) -> str:
    """The encoding that a text seems to have."""
    for mark, name in _MARKS:
        if content.startswith(mark):
            return name
    for name in ("utf-8", "cp932", "cp1252"):
        try:
            text = content.decode(name)
        except UnicodeDecodeError:
            continue
        if name != "cp932" or (_JAPANESE.search(text) and not _PRIVATE.search(text)):
            return name
    return "latin-1"


def _separator(lines: list[str]) -> str:
    """What stands most often between the names."""
    header = _QUOTED.sub("", lines[0]) if lines else ""
    best = max(_SEPARATORS, key=header.count)
    if header.count(best):
        return best
    words = [len(line.split()) for line in lines[:2]]
    return " " if len(words) == 2 and words[0] == words[1] > 1 else ","


def _decimal(lines: list[str], separator: str) -> str:
    """The mark that stands most often between digits."""
    if separator == ",":  # numbers with a comma then stand in quotes
        lines = [" ".join(_QUOTED.findall(line)) for line in lines]
    text = "\n".join(lines)
    return "," if len(_COMMA.findall(text)) > len(_POINT.findall(text)) else "."


def _parsed(content: bytes, separator: str, decimal: str) -> pa.Table:
    """The table; what looks like dates, and names, as text."""
    first = _csv(content, separator, decimal, {})
    texts = {
        field.name: pa.string()
        for field in first.schema
        if pa.types.is_temporal(field.type) or field.name.strip() in NAMES
    }
    table = _csv(content, separator, decimal, texts) if texts else first
    names = [name.strip() for name in table.column_names]
    refuse_twice(names)
    return table.rename_columns(names)


def _csv(
    content: bytes, separator: str, decimal: str, texts: dict[str, pa.DataType]
) -> pa.Table:
    # As one block, so that the type of a column is that of all its cells.
    whole = min(len(content) + 1, 2**31 - 1)
    return pyarrow.csv.read_csv(
        io.BytesIO(content),
        pyarrow.csv.ReadOptions(block_size=whole),
        pyarrow.csv.ParseOptions(delimiter=separator),
        pyarrow.csv.ConvertOptions(decimal_point=decimal, column_types=texts),
    )


def _notes(asked: Reading, found: Reading) -> tuple[str, ...]:
    """What was assumed of a text that nobody told, where it is not the usual."""
    parts = []
    if not asked.separator and found.separator != ",":
        between = _SEPARATORS.get(found.separator, "spaces")
        parts.append(f"{between} between columns (--separator)")
    if not asked.decimal and found.decimal != ".":
        parts.append("decimal commas (--decimal)")
    if not asked.encoding and found.encoding != "utf-8":
        parts.append(f"encoding {found.encoding} (--encoding)")
    return (f"read as text with {', '.join(parts)}",) if parts else ()


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
