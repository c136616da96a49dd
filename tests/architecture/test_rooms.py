"""What may be done where, beyond the order of the rooms that lint-imports checks."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from tests.architecture.source import PACKAGE, files, nodes

RIM = {"cli", "devices", "doctor", "runtime", "sessions", "testing", "web", "__main__"}
"""Rooms with a clock, devices and printing; `testing` tells how fast a method is."""

CLOCKS = {"time", "datetime", "random", "secrets"}
"""Modules whose answers differ from run to run."""

SIMULATING = {"configuration", "run", "jobs", "trials"}
"""Modules of the experiment that set up and run trials; others read records only."""


def room(file: Path) -> str:
    """First folder or file name below the package."""
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(file: Path) -> Iterator[str]:
    """Full names of the modules that a file imports."""
    for node in nodes(file):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def calls(file: Path, name: str) -> bool:
    """Whether a file calls a function by its bare name."""
    return any(
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == name
        for node in nodes(file)
    )


def test_no_inner_room_reads_a_clock_or_hidden_randomness() -> None:
    inner = [file for file in files() if room(file) not in RIM]
    found = {file.name: CLOCKS & set(imported(file)) for file in inner}
    assert not {name: modules for name, modules in found.items() if modules}


def test_only_the_rim_prints() -> None:
    assert [f.name for f in files() if room(f) not in RIM and calls(f, "print")] == []


def test_measures_statistics_and_figures_read_records_only() -> None:
    readers = [file for file in files(PACKAGE / "study") if file.stem not in SIMULATING]
    loop = {
        (file.name, name)
        for file in readers
        for name in imported(file)
        if name.startswith("costeer.loop.")
    }
    assert not loop


def test_one_file_of_training_simulates() -> None:
    others = [f for f in files(PACKAGE / "training") if f.stem != "simulation"]
    names = {name for file in others for name in imported(file)}
    assert not {name for name in names if name.startswith("costeer.loop.trial")}
