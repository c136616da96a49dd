"""What the package imports is what it asks for, no less and no more."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from functools import cache
from importlib.metadata import packages_distributions

from tests.architecture.source import ROOT, files, nodes

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]

PEERS = {
    "highway_env": "highway-env",
    "vehiclemodels": "commonroad-vehicle-models",
    "Box2D": "box2d",
    "pybullet": "pybullet",
    "pybullet_data": "pybullet",
}
"""Modules of the extra `bench`, which need not be installed, and what brings them."""

OWN = {"benchmarks", "costeer", "tests"}

COMES_WITH = {"llvmlite": "numba", "markupsafe": "jinja2"}
"""Imported packages that another one is made of and pins itself."""

LOADED_BY_NAME = {"websockets": "uvicorn"}
"""Packages that another one imports because it is told to, and that one."""


def named(requirements: list[str]) -> set[str]:
    """Names of the packages in a list of requirements."""
    named = (re.split(r"[^A-Za-z0-9._-]", line, maxsplit=1)[0] for line in requirements)
    return {name.lower() for name in named}


@cache
def imported() -> frozenset[str]:
    """Names of the distributions that package and benchmarks import, anywhere."""
    owners, found = packages_distributions(), set()
    for file in [*files(), *files(ROOT / "benchmarks")]:
        for node in nodes(file):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module:
                names = [node.module]
            found |= {name.partition(".")[0] for name in names}
    return frozenset(
        PEERS.get(top) or owners.get(top, [top])[0].lower()
        for top in found - sys.stdlib_module_names - OWN
    )


def test_every_base_dependency_is_imported() -> None:
    by_name = {part for part, user in LOADED_BY_NAME.items() if user in imported()}
    assert named(PROJECT["dependencies"]) - imported() - by_name == set()


def test_every_import_is_a_dependency_or_of_an_extra() -> None:
    extras = PROJECT["optional-dependencies"].values()
    asked = named([*PROJECT["dependencies"], *(line for e in extras for line in e)])
    made_of = {part for part, whole in COMES_WITH.items() if whole in asked}
    assert imported() - asked - made_of == set()


def test_extras_add_to_the_base_and_do_not_repeat_it() -> None:
    for name, requirements in PROJECT["optional-dependencies"].items():
        assert not named(requirements) & named(PROJECT["dependencies"]), name
