"""Arguments keep one order everywhere: parameters, state, signals, dt, key."""

from __future__ import annotations

import itertools
from pathlib import Path

from tests.architecture.source import Function, argument_names, functions

ORDER = ("parameters", "state", "measurement", "signals", "dt", "key")


def ranks(function: Function) -> list[int]:
    """Place in the order of each argument that has one."""
    names = argument_names(function)
    found = [ORDER.index(name) for name in names if name in ORDER]
    # Measurement and signals are two names for what comes in at a step.
    return [ORDER.index("signals") if ORDER[r] == "measurement" else r for r in found]


def is_ordered(function: Function) -> bool:
    """Whether no argument stands before one that should precede it."""
    return all(a <= b for a, b in itertools.pairwise(ranks(function)))


def test_arguments_stand_in_the_order_of_the_house() -> None:
    assert [f.place for f in functions() if not is_ordered(f)] == []


def test_swapped_arguments_are_seen(tmp_path: Path) -> None:
    (tmp_path / "module.py").write_text("def step(state, parameters, dt): ...\n")
    (function,) = functions(tmp_path)
    assert not is_ordered(function)
