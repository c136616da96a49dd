"""Rows of docs/paper.md are whole, and name functions and tests that exist."""

from __future__ import annotations

import ast
import re
from functools import cache
from importlib import import_module
from typing import NamedTuple

from tests.architecture.source import ROOT, tree

TEXT = (ROOT / "docs" / "paper.md").read_text("utf-8")
HEADER = ["Item", "It says", "Function", "Test", "Our reading"]
TABLE_SECTIONS = {"Equations", "Tables", "Figures", "Sections"}
NAME = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\]\(#([a-z0-9-]+)\)")

EQUATIONS = {
    *(f"Eq. ({number})" for number in range(1, 14) if number != 12),
    "Eq. (12), gain",
    "Eq. (12), Sec. III-F",
}
TABLES = {f"Table {number}" for number in ("I", "II", "III", "IV")}
FIGURES = set(range(1, 23))
"""All of them."""


class Row(NamedTuple):
    """A row of one of the page's tables of the paper."""

    item: str
    says: str
    function: str
    test: str
    reading: str


def cells(line: str) -> list[str]:
    """Cells of a line of a table."""
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def rows(text: str) -> list[Row]:
    """Rows of every table with the header of this page."""
    found, within = [], False
    for line in text.splitlines():
        if not line.startswith("|"):
            within = False
        elif cells(line) == HEADER:
            within = True
        elif within and not line.startswith("|---"):
            found.append(Row(*cells(line)))
    return found


ROWS = rows(TEXT)


def names(cell: str) -> list[str]:
    """Names in a cell that holds nothing but names between commas."""
    found = NAME.findall(cell)
    rest = NAME.sub("", cell).replace(",", "").strip()
    return [] if rest else found


def is_importable(name: str) -> bool:
    """Whether a dotted name is a function or a class of the package."""
    module, _, attribute = name.rpartition(".")
    if not module.startswith("costeer."):
        return False
    try:
        return callable(getattr(import_module(module), attribute, None))
    except ModuleNotFoundError:
        return False


@cache
def functions_of(path: str) -> frozenset[str]:
    """Names of the test functions of a file."""
    file = ROOT / path
    if not path.startswith("tests/") or not file.is_file():
        return frozenset()
    found = (node for node in tree(file).body if isinstance(node, ast.FunctionDef))
    return frozenset(node.name for node in found if node.name.startswith("test_"))


def is_a_test(name: str) -> bool:
    """Whether `tests/file.py::test_function` is a test."""
    path, _, function = name.partition("::")
    return function in functions_of(path)


def numbers(item: str) -> set[int]:
    """Numbers of figures in an item, ranges written out."""
    found = {int(number) for number in re.findall(r"\d+", item)}
    if match := re.search(r"(\d+) to (\d+)", item):
        found |= set(range(int(match[1]), int(match[2]) + 1))
    return found


def anchor(title: str) -> str:
    """What a link to a section bears."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def test_every_equation_has_one_row() -> None:
    listed = [row.item for row in ROWS if row.item.startswith("Eq.")]
    assert sorted(listed) == sorted(EQUATIONS)


def test_every_table_has_one_row() -> None:
    listed = [row.item for row in ROWS if row.item.startswith("Table")]
    assert sorted(listed) == sorted(TABLES)


def test_every_figure_that_is_used_has_a_row() -> None:
    listed = [numbers(row.item) for row in ROWS if row.item.startswith("Fig")]
    assert set().union(*listed) == FIGURES


def test_no_item_stands_twice() -> None:
    items = [row.item for row in ROWS]
    assert len(items) == len(set(items))


def test_every_row_is_whole_and_names_functions_and_tests_that_exist() -> None:
    assert [row.item for row in ROWS if not all(row)] == []
    for row in ROWS:
        functions, tests = names(row.function), names(row.test)
        assert functions, row.item
        assert tests, row.item
        assert [name for name in functions if not is_importable(name)] == [], row.item
        assert [name for name in tests if not is_a_test(name)] == [], row.item


def test_every_section_explains_a_row() -> None:
    titles = set(re.findall(r"^## (.+)$", TEXT, re.MULTILINE)) - TABLE_SECTIONS
    linked = {link for row in ROWS for link in LINK.findall(row.reading)}
    assert {anchor(title) for title in titles} == linked


def test_what_is_missing_would_be_seen() -> None:
    (row,) = rows("| " + " | ".join(HEADER) + " |\n|---|---|\n| a | b | | `c` | d |")
    assert not all(row)
    assert names("`costeer.base.bezier.quintic` and more") == []
    assert not is_importable("costeer.base.bezier")
    assert not is_importable("costeer.base.bezier.cubic")
    assert not is_a_test("tests/base/test_bezier.py")
    assert not is_a_test("tests/base/test_bezier.py::test_of_a_cubic")
