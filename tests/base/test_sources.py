"""A hash tells apart what computes something else, and only that."""

from __future__ import annotations

import importlib
import json
import math
import sys
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from costeer.base.plugins import load_object
from costeer.base.sources import is_interactive, source_hash
from costeer.plant.parameters import CARS


class Gains(NamedTuple):
    """Some gains."""

    first: float


class Net:
    """Something with numbers that can be called."""

    def __init__(self, weights: Any) -> None:  # Any: whatever a file may hold
        self.weights = weights

    def __call__(self, window: float) -> float:
        """As it came."""
        return window

    def judge(self, window: float) -> float:
        """As it came."""
        return window


def law(gain: Any, x: float) -> float:  # Any: as above
    return x


def closure(gain: Any) -> Callable[[], Any]:  # Any: as above
    return lambda: gain


@pytest.fixture
def _clean() -> Iterator[None]:
    modules, path = set(sys.modules), list(sys.path)
    yield
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        del sys.modules[name]
    importlib.invalidate_caches()


@pytest.mark.usefixtures("_clean")
@pytest.mark.parametrize("where", ["data_law.py", "data_helper.py"])
@pytest.mark.parametrize(
    "kind",
    ["{}", "[{}]", "({},)", "dict(a={{'b': [{}]}})", "Gains({})", "Own({})"],
)
def test_numbers_of_a_data_file_count(tmp_path: Path, where: str, kind: str) -> None:
    read = kind.format("json.loads(Path(DATA).read_text())[0]")
    held = (
        "import json\nfrom pathlib import Path\nfrom typing import NamedTuple\n"
        f"DATA = {str(tmp_path / 'data.json')!r}\n"
        "class Gains(NamedTuple):\n    first: float\n"
        "class Own:\n    def __init__(self, x):\n        self.x = x\n"
        f"VALUE = {read}\n"
    )
    texts = {"data_law.py": "import data_helper\n", "data_helper.py": ""}
    texts[where] += held
    texts["data_law.py"] += "def law(x):\n    return x\n"
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf-8")
    hashes = []
    for gain in (2.0, 3.0, 2.0):
        (tmp_path / "data.json").write_text(json.dumps([gain]), "utf-8")
        found = load_object(f"{tmp_path / 'data_law.py'}:law", object, "")
        hashes.append(source_hash((found,)))
        del sys.modules["costeer_plugin_data_law"], sys.modules["data_helper"]
    assert hashes[0] == hashes[2] != hashes[1]


@pytest.mark.parametrize(
    "made",
    [Net, lambda x: Net(x).judge, lambda x: partial(law, x), closure],
    ids=["object", "bound method", "partial", "closure"],
)
@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1.0, 2.0),
        ([1.0], [2.0]),
        ({"a": (1.0,)}, {"a": (2.0,)}),
        (Gains(1.0), Gains(2.0)),
        (np.zeros(2), np.ones(2)),
        (np.ma.masked_equal([1.0, 2.0], 1.0), np.ma.masked_equal([1.0, 2.0], 2.0)),
        (Net([1.0]), Net([2.0])),
        (closure(1.0), closure(2.0)),
        (math.sin, math.cos),
        (np.sin, np.cos),
        (np.random.default_rng(1), np.random.default_rng(2)),
    ],
)
def test_what_a_function_is_bound_to_counts(
    made: Callable[[Any], Any], one: Any, other: Any
) -> None:
    assert source_hash((made(one),)) == source_hash((made(one),))
    assert source_hash((made(one),)) != source_hash((made(other),))


def test_an_object_that_holds_itself_has_a_hash() -> None:
    net = Net([1.0])
    net.weights.append(net)
    assert len(source_hash((net,))) == 16


def test_what_cannot_be_hashed_is_refused() -> None:
    with pytest.raises(ValueError, match="a lock cannot be hashed, so no record"):
        source_hash((Net(threading.Lock()),))


@pytest.mark.parametrize("given", [len, math.sin, Net, partial(len, "a"), np.sin])
def test_what_is_no_python_function_is_refused(given: Any) -> None:
    for asked in (source_hash, is_interactive):
        with pytest.raises(ValueError, match="write it as a def in a file"):
            asked((given,))


def test_a_function_without_a_file_is_known_by_what_it_uses() -> None:
    def made(gain: float, other: float) -> Any:  # Any: of an exec
        names: dict[str, Any] = {"GAIN": gain, "OTHER": other}
        exec("def inner(x):\n    return GAIN * x", names)
        exec("def law(x):\n    return inner(x)", names)
        return names["law"]

    assert is_interactive((made(1.0, 1.0),))
    assert source_hash((made(1.0, 1.0),)) == source_hash((made(1.0, 2.0),))
    assert source_hash((made(1.0, 1.0),)) != source_hash((made(2.0, 1.0),))


@pytest.mark.usefixtures("_clean")
def test_a_table_of_costeer_is_no_number_of_a_plug_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "table_law.py"
    text = "from costeer.plant.parameters import CARS\n\ndef law(x):\n    return x\n"
    file.write_text(text, "utf-8")
    found = load_object(f"{file}:law", object, "")
    before = source_hash((found,))
    monkeypatch.setitem(CARS, "my-own", next(iter(CARS.values())))
    assert source_hash((found,)) == before


LAW = "def law(x):\n    return {} * x\n"


@pytest.mark.usefixtures("_clean")
def test_a_module_that_was_edited_and_reloaded_is_another_one(tmp_path: Path) -> None:
    file = tmp_path / "reloaded_law.py"
    file.write_text(LAW.format("1.0"), "utf-8")
    sys.path.insert(0, str(tmp_path))
    module = importlib.import_module("reloaded_law")
    before = source_hash((module.law,))
    file.write_text(LAW.format("22.0"), "utf-8")
    assert source_hash((module.law,)) == before
    importlib.reload(module)
    after = source_hash((module.law,))
    assert after != before
    # Python tells bytecode by seconds and size: each text has a size of its own.
    file.write_text(LAW.format("1.0") + "\n\n", "utf-8")
    importlib.reload(module)
    assert source_hash((module.law,)) not in {before, after}


@pytest.mark.usefixtures("_clean")
def test_a_function_that_an_editor_patched_in_place_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "patched_law.py"
    file.write_text(LAW.format("1.0"), "utf-8")
    sys.path.insert(0, str(tmp_path))
    module = importlib.import_module("patched_law")
    source_hash((module.law,))
    file.write_text(LAW.format("22.0"), "utf-8")
    names: dict[str, Any] = {}
    exec(compile(file.read_text("utf-8"), str(file), "exec"), names)
    module.law.__code__ = names["law"].__code__
    with pytest.raises(ValueError, match=r"patched_law\.py was edited .*importlib\."):
        source_hash((module.law,))
    importlib.reload(module)
    assert len(source_hash((module.law,))) == 16
