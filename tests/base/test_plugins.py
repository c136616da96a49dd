"""Plug-ins are loaded once, from the file that is meant, or refused in one line."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

from costeer.base.plugins import advertised, load_object
from costeer.base.sources import source_hash

LAW = "def law(x):\n    return {gain} * x\n"


@pytest.fixture(autouse=True)
def _clean() -> Iterator[None]:
    """Forget what a test has imported: the next one may use its names."""
    modules, path = set(sys.modules), list(sys.path)
    yield
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        del sys.modules[name]
    importlib.invalidate_caches()


def written(file: Path, text: str) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    return file


def law(file: Path, name: str = "law") -> Any:  # Any: of that file
    return load_object(f"{file}:{name}", object, "LAW")


def test_a_hash_names_the_bytes_that_were_loaded(tmp_path: Path) -> None:
    file = written(tmp_path / "hashed_law.py", LAW.format(gain=2.0))
    found = law(file)
    written(file, LAW.format(gain=3.0))
    late = source_hash((found,))
    written(file, LAW.format(gain=2.0))
    assert found(1.0) == 2.0
    assert late == source_hash((found,))


@pytest.mark.parametrize("edited", ["edited_law.py", "edited_helper.py"])
@pytest.mark.parametrize("imported", [False, True])
def test_a_file_that_was_edited_since_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, edited: str, imported: bool
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    text = "from edited_helper import GAIN\n\n" + LAW.format(gain="GAIN")
    file = written(tmp_path / "edited_law.py", text)
    written(tmp_path / "edited_helper.py", "GAIN = 2.0\n")
    place = "edited_law:law" if imported else f"{file}:law"
    assert load_object(place, object, "") is load_object(place, object, "")
    written(tmp_path / edited, (tmp_path / edited).read_text("utf-8") + "\n")
    with pytest.raises(ValueError, match=f"{edited} was edited since it was loaded"):
        load_object(place, object, "")


def test_an_edit_of_the_same_size_in_the_same_second_is_loaded(tmp_path: Path) -> None:
    file = written(tmp_path / "quick_law.py", "from quick_helper import law\n")
    hashes = []
    for gain in (2.0, 3.0):
        written(tmp_path / "quick_helper.py", LAW.format(gain=gain))
        found = law(file)
        assert found(1.0) == gain
        hashes.append(source_hash((found,)))
        del sys.modules["costeer_plugin_quick_law"], sys.modules["quick_helper"]
    assert hashes[0] != hashes[1]


def test_code_that_its_file_does_not_hold_any_more_has_no_hash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    file = written(tmp_path / "own_import.py", LAW.format(gain=2.0))
    found = importlib.import_module("own_import").law  # by the user, unseen
    written(file, LAW.format(gain=3.0))
    with pytest.raises(ValueError, match=r"own_import.py was edited since"):
        source_hash((found,))
    assert isinstance(found, FunctionType)


@pytest.mark.parametrize("statement", ["from helpers import GAIN", "import helpers"])
def test_two_helpers_of_one_name_are_refused(tmp_path: Path, statement: str) -> None:
    for folder, gain in (("a", 2.0), ("b", 3.0)):
        written(tmp_path / folder / "helpers.py", f"GAIN = {gain}\n")
        text = f"{statement}\n\n" + LAW.format(gain=1.0)
        written(tmp_path / folder / f"rival_{folder}.py", text)
    law(tmp_path / "a" / "rival_a.py")
    with pytest.raises(ValueError, match=r"imports helpers, .*b/helpers.py.*a/helpers"):
        law(tmp_path / "b" / "rival_b.py")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("raise RuntimeError('no\\nlicence')", "RuntimeError: no licence"),
        ("raise ImportError('gone')", "ImportError: gone"),
        ("raise SystemExit(7)", "SystemExit: 7"),
        ("def law(:", "SyntaxError: invalid syntax"),
    ],
)
@pytest.mark.parametrize("imported", [False, True])
def test_a_module_that_fails_is_refused_in_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    text: str,
    told: str,
    imported: bool,
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    file = written(tmp_path / "failing_law.py", text)
    with pytest.raises(ValueError, match=f"cannot be loaded: {told}") as caught:
        load_object("failing_law:law" if imported else f"{file}:law", object, "")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("place", ["..:x", ".:x", "a-b:x", "a..b:x"])
def test_what_is_no_name_of_a_module_is_refused(place: str) -> None:
    with pytest.raises(ValueError, match="is no name of a module"):
        load_object(place, object, "")


def test_the_extras_of_an_entry_point_are_no_part_of_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    about = tmp_path / "extra-1.0.dist-info"
    written(about / "METADATA", "Name: extra\nVersion: 1.0\n")
    written(about / "entry_points.txt", "[some.group]\nmine = extra:METHOD [x]\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert advertised("some.group") == {"mine": "extra:METHOD"}
