"""The source as syntax trees, for tests that look at its form."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "costeer"


class Function(NamedTuple):
    """A function in the source and where it stands."""

    file: Path
    node: ast.FunctionDef | ast.AsyncFunctionDef

    @property
    def place(self) -> str:
        """File, line and name, to be found by."""
        line = self.node.lineno
        return f"{self.file.relative_to(ROOT)}:{line} {self.node.name}"


def files(folder: Path = PACKAGE) -> list[Path]:
    """Python files below a folder, in order."""
    found = sorted(folder.rglob("*.py"))
    assert found, f"no Python file below {folder}"
    return found


@cache
def tree(file: Path) -> ast.Module:
    """Syntax tree of a file."""
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def nodes(file: Path) -> tuple[ast.AST, ...]:
    """Every node of a file's syntax tree."""
    return tuple(ast.walk(tree(file)))


@cache
def functions(folder: Path = PACKAGE) -> tuple[Function, ...]:
    """Every function below a folder, methods and inner functions included."""
    kinds = ast.FunctionDef | ast.AsyncFunctionDef
    return tuple(
        Function(file, node)
        for file in files(folder)
        for node in nodes(file)
        if isinstance(node, kinds)
    )


def argument_names(function: Function) -> list[str]:
    """Names of a function's arguments, `self` and `cls` left out."""
    given = function.node.args
    names = [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return [name for name in names if name not in {"self", "cls"}]


def parameter_classes() -> Iterator[tuple[Path, ast.ClassDef]]:
    """Every named tuple whose name ends in `Parameters`."""
    for file in files():
        for node in nodes(file):
            if isinstance(node, ast.ClassDef) and node.name.endswith("Parameters"):
                yield file, node
