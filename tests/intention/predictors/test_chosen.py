"""The predictor that is meant: a file of weights as it is now."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.predictors.chosen import chosen_predictor
from costeer.intention.weights import (
    load_weights,
    save_weights,
    weights_hash,
)
from tests.methods.test_plug_ins import installed


def test_weights_that_are_written_anew_are_read_anew(tmp_path: Path) -> None:
    file = tmp_path / "mine.npz"
    save_weights(file, load_weights())
    before = chosen_predictor(weights=str(file))
    assert chosen_predictor(weights=str(file)) is before
    network = load_weights()
    changed = network.weights._replace(output_bias=network.weights.output_bias + 1)
    save_weights(file, network._replace(weights=changed, hash=weights_hash(changed)))
    assert chosen_predictor(weights=str(file)).hash != before.hash


NET = """
import json
from pathlib import Path

class Net:
    def __init__(self, bias):
        self.bias = bias

    def __call__(self, window):
        return self.bias

    def judge(self, window):
        return self.bias

NET = Net(json.loads(Path(__file__).with_suffix(".json").read_text()))
JUDGE = NET.judge

def PREDICTOR(window):
    return NET(window)
"""


@pytest.mark.parametrize("name", ["NET", "JUDGE", "PREDICTOR"])
def test_the_numbers_that_an_object_has_read_are_in_its_hash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    hashes = []
    for stem, bias in (("net_a", 0.25), ("net_b", 0.25), ("net_c", 0.5)):
        (tmp_path / stem).mkdir()
        file = tmp_path / stem / "read_net.py"
        file.write_text(NET, "utf-8")
        file.with_suffix(".json").write_text(str(bias), "utf-8")
        monkeypatch.delitem(sys.modules, "costeer_plugin_read_net", raising=False)
        found = chosen_predictor(f"{file}:{name}")
        assert found.judge is not None
        assert found.judge(np.zeros((180, 6))) == bias
        hashes.append(found.hash)
    assert hashes[0] == hashes[1] != hashes[2]


def half(share: float, window: Any) -> float:  # Any: a window
    return share


def test_a_partial_bears_the_name_of_its_function() -> None:
    found = chosen_predictor(partial(half, 0.5))
    assert found.name == "half"
    assert found.hash != chosen_predictor(partial(half, 0.25)).hash


@pytest.mark.parametrize("place", ["builtins:len", "math:sin", "builtins:dict"])
def test_what_is_no_function_of_python_is_refused(place: str) -> None:
    with pytest.raises(ValueError, match="write it as a def in a file"):
        chosen_predictor(place)


def test_an_installed_plug_in_of_a_name_of_costeer_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(tmp_path, "rivals", "[costeer.predictors]\ngru = rivals:leaning [x]\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match="'gru': costeer's own and rivals:leaning;"):
        chosen_predictor("gru")
