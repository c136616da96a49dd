"""Rows of docs/paper.md name functions and tests that exist."""

from __future__ import annotations

import ast
import re
from importlib import import_module
from importlib.util import find_spec
from typing import NamedTuple

import pytest

from tests.architecture.source import ROOT

NAME = re.compile(r"`([^`]+)`")


class Row(NamedTuple):
    """A row of a table of docs/paper.md."""

    item: str
    functions: tuple[str, ...]
    tests: tuple[str, ...]


def rows() -> list[Row]:
    """Rows of every table with a function and a test column."""
    text = (ROOT / "docs" / "paper.md").read_text("utf-8")
    cells = [
        [cell.strip() for cell in line.strip().strip("|").split("|")]
        for line in text.splitlines()
        if line.startswith("|")
    ]
    return [
        Row(c[0], tuple(NAME.findall(c[2])), tuple(NAME.findall(c[3])))
        for c in cells
        if len(c) == 5 and not c[0].startswith(("Item", "---", ":--"))
    ]


def exists(name: str) -> bool:
    """Whether a dotted name below `costeer` is a module or something in one."""
    try:
        if find_spec(f"costeer.{name}") is not None:
            return True
    except ModuleNotFoundError:
        pass
    module, _, attribute = name.rpartition(".")
    try:
        return hasattr(import_module(f"costeer.{module}"), attribute)
    except ModuleNotFoundError:
        return False


def is_a_test(name: str) -> bool:
    """Whether `file` or `file::function` is a test below `tests`."""
    path, _, function = name.partition("::")
    file = ROOT / "tests" / path
    if not file.exists():
        return False
    tree = ast.parse(file.read_text("utf-8"))
    found = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    return not function or function in found


def test_the_paper_has_a_row_for_each_equation_table_and_figure() -> None:
    items = " ".join(row.item for row in rows())
    equations = [f"Eq. ({n})" for n in range(1, 14)]
    tables = [f"Table {n}" for n in ("I", "II", "III", "IV")]
    figures = [f"Fig. {n}" for n in range(1, 23)]
    listed = {*re.findall(r"Eq\. \(\d+\)|Table [IV]+|Fig\. \d+", items)}
    assert [i for i in (*equations, *tables, *figures) if i not in listed] == []


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.item)
def test_functions_of_a_row_exist(row: Row) -> None:
    assert [name for name in row.functions if not exists(name)] == []


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.item)
def test_tests_of_a_row_exist(row: Row) -> None:
    assert [name for name in row.tests if not is_a_test(name)] == []
