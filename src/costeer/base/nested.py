"""Settings of a file as nested named tuples: every key known, every value of its kind.

The class says what a file may hold: fields of text, numbers, flags, tuples of them and
further named tuples. A line number is told where the file's text is at hand.
"""

from __future__ import annotations

import difflib
import math
import re
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import yaml

from costeer.base.files import read_whole

# Any, in this file: values of a file, and the kinds of fields.
Settings = TypeVar("Settings")

_LARGEST = 1_000_000
"""Longest file that is read [bytes]."""

_WORDS = {str: "text", float: "a number", int: "a whole number", bool: "yes or no"}


class Lined(dict[str, Any]):
    """A mapping that knows the line each key stands in."""

    lines: dict[str, int]


class _NoNumber(yaml.YAMLError):
    """What stands for no number that people mean: its line, and it in words."""

    def __str__(self) -> str:
        line, told = self.args
        return f"line {line}: {told}"


class _Loader(yaml.SafeLoader):
    """YAML with line numbers, no key twice, no dates."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> Any:
        found = Lined()
        found.lines = {}
        for key_node, value_node in node.value:
            key = str(self.construct_object(key_node, deep=True))
            line = key_node.start_mark.line + 1
            if key in found:
                raise yaml.YAMLError(f"line {line}: {key} stands twice; give it once")
            try:
                found[key] = self.construct_object(value_node, deep=True)
            except _NoNumber as error:
                line, told = error.args
                raise yaml.YAMLError(f"line {line}: {key} is {told}") from error
            found.lines[key] = line
        return found


def _mapping(loader: Any, node: Any) -> Any:
    return loader.construct_mapping(node)


def _word(loader: Any, node: Any) -> Any:
    return loader.construct_yaml_str(node)


def _number(loader: Any, node: Any) -> Any:
    """A finite number as people write it, none of those that YAML 1.1 alone knows.

    There 0100 is 64 and 1:30 is 90; later versions read them as text or as 100.

    Raises:
        _NoNumber: If it is another.
    """
    kind = "int" if node.tag.endswith("int") else "float"
    try:
        value = getattr(loader, f"construct_yaml_{kind}")(node)
    except (ValueError, IndexError):  # a tag before no number, thousands of digits
        value = math.nan
    line, told = node.start_mark.line + 1, node.value[:40]
    if not value - value == 0:  # whole numbers may be larger than any float
        raise _NoNumber(line, f"{told}; give a number, or leave it out")
    if _ODD.fullmatch(node.value):
        meant = "write the number that is meant, or put it in quotes"
        raise _NoNumber(line, f"{told}, which is read as {value}; {meant}")
    return value


_ODD = re.compile(r"[-+]?(0[0-9_]+|0[bx].*|.*:.*)", re.IGNORECASE)
"""Octal, binary and hexadecimal numbers, and those of base 60."""

_Loader.add_constructor("tag:yaml.org,2002:int", _number)
_Loader.add_constructor("tag:yaml.org,2002:float", _number)
_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)
_Loader.add_constructor("tag:yaml.org,2002:timestamp", _word)


def read_mapping(path: Path) -> Lined:
    """The mapping of a YAML file.

    Raises:
        ValueError: If it is none.
        OSError: If it cannot be read.
    """
    return parsed_mapping(read_whole(path, _LARGEST), str(path))


def parsed_mapping(text: bytes | str, name: str) -> Lined:
    """The mapping of a YAML text.

    Args:
        text: UTF-8.
        name: Of the file, for messages.

    Raises:
        ValueError: If it is none.
    """
    try:
        told = text.decode("utf-8") if isinstance(text, bytes) else text
        content = yaml.load(told, _Loader)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise ValueError(f"{name} is not YAML that can be read: {reason}") from error
    if content is None:
        raise ValueError(f"{name} is empty; give names and values, as 'seed: 1'")
    if not isinstance(content, Lined):
        raise ValueError(f"{name} is no list of names and values, as 'seed: 1'")
    return content


def filled(kind: type[Settings], given: Mapping[str, Any], name: str) -> Settings:
    """A named tuple with the values of a mapping; what is missing has its default.

    Args:
        kind: Class of the named tuple.
        given: Values by field.
        name: Of the file or of the part of it, for messages.

    Raises:
        ValueError: Naming the first key that is not known, is missing, or has a value
            of another kind; with its line if that is known.
    """
    hints = get_type_hints(kind)
    fields: tuple[str, ...] = getattr(kind, "_fields", ())
    defaults: Mapping[str, Any] = getattr(kind, "_field_defaults", {})
    for key in given:
        if key not in fields:
            raise ValueError(
                f"{_place(given, key, name)} is not known{_near(key, fields)}"
            )
    values = {
        key: _value(hints[key], given[key], _place(given, key, name)) for key in given
    }
    missing = [key for key in fields if key not in values and key not in defaults]
    if missing:
        raise ValueError(f"{name} lacks {', '.join(missing)}; give a value")
    return kind(**values)


def _near(key: str, fields: tuple[str, ...]) -> str:
    close = difflib.get_close_matches(key, fields, n=1)
    guess = f" (did you mean {close[0]}?)" if close else ""
    return f"{guess}; give one of {', '.join(fields)}"


def _place(given: Mapping[str, Any], key: str, name: str) -> str:
    line = getattr(given, "lines", {}).get(key)
    return f"{name}: {key}" if line is None else f"{name}, line {line}: {key}"


def _value(kind: Any, value: Any, name: str) -> Any:
    """A value as a field of a kind takes it.

    Raises:
        ValueError: If it is of another kind.
    """
    origin = get_origin(kind)
    if origin in (Union, types.UnionType):
        return _one_of(get_args(kind), value, name)
    if origin is tuple:
        return _several(get_args(kind)[0], value, name)
    if origin is not None:  # a mapping from names to values of one kind
        return _named(get_args(kind)[1], value, name)
    if hasattr(kind, "_fields"):
        if not isinstance(value, Mapping):
            raise ValueError(f"{name} is {value!r}; give names and values")
        return filled(kind, value, name)
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if kind is str and isinstance(value, int | float) and not isinstance(value, bool):
        return str(value)
    if isinstance(value, kind) and not (kind is int and isinstance(value, bool)):
        return value
    raise ValueError(f"{name} is {value!r}; give {_WORDS.get(kind, kind.__name__)}")


def _one_of(kinds: tuple[Any, ...], value: Any, name: str) -> Any:
    if value is None and type(None) in kinds:
        return None
    return _value(next(each for each in kinds if each is not type(None)), value, name)


def _several(kind: Any, value: Any, name: str) -> tuple[Any, ...]:
    if isinstance(value, str) or not isinstance(value, list | tuple):
        raise ValueError(f"{name} is {value!r}; give a list, as [{_example(kind)}]")
    return tuple(
        _value(kind, each, f"{name}, entry {place}")
        for place, each in enumerate(value, start=1)
    )


def _named(kind: Any, value: Any, name: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise ValueError(f"{name} is {value!r}; give names and values")
    return {key: _value(kind, each, f"{name}: {key}") for key, each in value.items()}


def _example(kind: Any) -> str:
    return "{...}" if hasattr(kind, "_fields") else _WORDS.get(kind, "...")
