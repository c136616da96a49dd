"""One idea a file, and functions that fit on a screen."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tests.architecture.source import (
    PACKAGE,
    ROOT,
    Function,
    argument_names,
    files,
    functions,
)

BESIDE = ("benchmarks", "requirements", "tests")
"""Folders with code beside the package."""

MOST_LINES_IN_FILE = 400
MOST_LINES_IN_BODY = 40
MOST_ARGUMENTS = 7


def body_lines(function: Function) -> int:
    """Lines of a function's body without its docstring."""
    has_docstring = ast.get_docstring(function.node) is not None
    statements = function.node.body[int(has_docstring) :]
    if not statements:
        return 0
    return (statements[-1].end_lineno or 0) - statements[0].lineno + 1


def is_command(function: Function) -> bool:
    """Whether the arguments of this function are options, as those of a command."""
    room, name = function.file.parent, function.node.name
    command = room == PACKAGE / "cli" and name == function.file.stem
    return command or (room == PACKAGE / "api" and not name.startswith("_"))


def test_no_file_is_longer_than_400_lines() -> None:
    every = [*files(), *(f for name in BESIDE for f in files(ROOT / name))]
    lengths = {file: len(file.read_text("utf-8").splitlines()) for file in every}
    long = {str(f): n for f, n in lengths.items() if n > MOST_LINES_IN_FILE}
    assert not long


@pytest.mark.parametrize(
    "folder",
    [PACKAGE, *(pytest.param(ROOT / n, marks=pytest.mark.slow) for n in BESIDE)],
)
def test_no_function_body_is_longer_than_40_lines(folder: Path) -> None:
    lines = {f.place: body_lines(f) for f in functions(folder)}
    long = {place: n for place, n in lines.items() if n > MOST_LINES_IN_BODY}
    assert not long


def test_no_function_takes_more_than_seven_arguments() -> None:
    counts = {f.place: len(argument_names(f)) for f in functions() if not is_command(f)}
    assert not {place: n for place, n in counts.items() if n > MOST_ARGUMENTS}


def test_a_docstring_is_not_counted_as_body(tmp_path: Path) -> None:
    source = tmp_path / "module.py"
    source.write_text(
        'def f():\n    """One.\n\n    Two.\n    """\n    x = 1\n    return x\n'
    )
    (function,) = functions(tmp_path)
    assert body_lines(function) == 2
