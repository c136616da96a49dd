"""Why a text is no YAML, or a value none, in a line that people understand."""

from __future__ import annotations

import re

import yaml

_PLAIN = "give plain text, numbers and lists"

_PROBLEMS = {
    "2002:merge": "<< is not read; write the values out",
    "determine a constructor": f"tags (!!...) are not read; {_PLAIN}",
    "'\\t'": "a tab indents this line; indent with spaces",
    "single document": "a second document begins (---); give one",
    "mapping values are not allowed": "there is a colon too many, or the line is "
    "indented more than the one before",
}
"""What YAML says of texts, and what is said of it here."""

_EXPONENT = re.compile(r"is '[+-]?[\d.]+[eE][+-]?\d+'; give a number")


def in_words(error: ValueError, text: bytes | str, name: str) -> str:
    """The error of `base.nested` with its line, and without words of Python.

    Args:
        error: As it was raised.
        text: That was read.
        name: Of the file.
    """
    cause, told = error.__cause__, str(error).replace(" is None;", " has no value;")
    if isinstance(cause, UnicodeDecodeError):
        line = cause.object[: cause.start].count(b"\n") + 1
        byte = cause.object[cause.start]
        return f"{name}, line {line}: byte 0x{byte:02x} is no UTF-8; save it as UTF-8"
    if isinstance(cause, RecursionError):
        return f"{name} is nested deeper than any scenario; {_PLAIN}"
    if isinstance(cause, yaml.reader.ReaderError):
        before = text if isinstance(text, str) else text.decode("utf-8", "replace")
        line = before[: cause.position].count("\n") + 1
        return f"{name}, line {line}: a control character stands there; remove it"
    if isinstance(cause, yaml.MarkedYAMLError) and cause.problem_mark:
        line = cause.problem_mark.line + 1
        return f"{name}, line {line}: {_problem(cause)}"
    if isinstance(cause, yaml.YAMLError):  # a key twice; it says its line
        return f"{name}, {cause}"
    return _EXPONENT.sub(lambda found: f"{found[0]} without an exponent", told)


def _problem(error: yaml.MarkedYAMLError) -> str:
    said = " ".join(f"{error.context or ''} {error.problem or ''}".split())
    for part, told in _PROBLEMS.items():
        if part in said:
            return told
    return f"this is not YAML: {said}; compare the line with an example in the docs"
