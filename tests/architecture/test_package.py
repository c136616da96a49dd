"""What is built, wheel and source distribution, and what type checkers see of it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.architecture.source import ROOT

pytestmark = pytest.mark.slow  # it builds, and mypy reads the whole package

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "version"
]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the wheel and the source distribution, as `python -m build` makes."""
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-d", str(folder)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    return folder


@pytest.fixture(scope="module")
def source(built: Path) -> dict[str, bytes]:
    """Content of the source distribution by path within its one folder."""
    top = f"costeer-{VERSION}"
    with tarfile.open(built / f"{top}.tar.gz") as archive:
        files = [each for each in archive if each.isfile()]
        found = {each.name: archive.extractfile(each) for each in files}
        read = {name: file.read() for name, file in found.items() if file is not None}
    assert all(name.startswith(f"{top}/") for name in read)
    return {name.removeprefix(f"{top}/"): text for name, text in read.items()}


@pytest.mark.parametrize("folder", ["benchmarks", "examples", "tests", "docs"])
def test_a_source_distribution_has_the_whole_folder(
    source: dict[str, bytes], folder: str
) -> None:
    kept = [each for each in (ROOT / folder).rglob("*.*") if each.is_file()]
    wanted = {
        each.relative_to(ROOT).as_posix()
        for each in kept
        if each.suffix != ".pyc" and not re.search(r"/[.]", each.as_posix())
    }
    assert wanted
    assert wanted <= set(source)


def test_a_source_distribution_has_nothing_of_this_computer(
    source: dict[str, bytes],
) -> None:
    first = {name.split("/")[0] for name in source}
    assert (
        first & {".venv", "out", "dist", "site", ".mypy_cache", ".hypothesis"} == set()
    )
    here = str(ROOT).encode()
    assert [name for name, text in source.items() if here in text] == []


def test_a_wheel_has_all_that_the_package_reads_and_no_tests(built: Path) -> None:
    with zipfile.ZipFile(built / f"costeer-{VERSION}-py3-none-any.whl") as wheel:
        names = set(wheel.namelist())
    package = ROOT / "src" / "costeer"
    wanted = {
        f"costeer/{each.relative_to(package).as_posix()}"
        for each in package.rglob("*.*")
        if each.is_file() and each.suffix not in (".pyc", ".nbi", ".nbc")
    }
    assert wanted <= names
    assert "costeer/py.typed" in names
    tops = {name.split("/")[0] for name in names}
    assert tops == {"costeer", f"costeer-{VERSION}.dist-info"}


# The comments that ignore an error are errors themselves where there is none to ignore:
# where the types of costeer were not seen.
CONSUMER = """
from typing import assert_type

import costeer

record = costeer.simulate("strong-normal", length=300.0, intention="off")
assert_type(record, costeer.Record)
assert_type(costeer.sdlp(record.columns["lateral_position"]), float)
assert_type(costeer.__version__, str)
costeer.simulate(length="300 m")  # type: ignore[arg-type]
costeer.simulate(distance=300.0)  # type: ignore[call-arg]
record.column  # type: ignore[attr-defined]
"""


SETTINGS = """
[mypy]
strict = True
follow_imports = silent
[mypy-matplotlib.*,numba.*,numpy.*,pandas.*,pyarrow.*,rich.*,scipy.*,typer.*]
follow_imports = skip
"""
"""Types of other packages are not what this is about, and take minutes."""


@pytest.mark.timeout(1800)
def test_the_types_of_an_installed_costeer_reach_who_uses_it(tmp_path: Path) -> None:
    (tmp_path / "consumer.py").write_text(CONSUMER, "utf-8")
    (tmp_path / "mypy.ini").write_text(SETTINGS, "utf-8")
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("MYPYPATH", "PYTHONPATH")
    }
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "consumer.py"],
        cwd=tmp_path,
        check=False,
        capture_output=True,
        text=True,
        env=environment,
    )
    assert checked.returncode == 0, checked.stdout
