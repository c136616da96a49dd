"""`import costeer`: a small set of names, imported late, each with an example."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys
from importlib import import_module
from typing import Any

import matplotlib as mpl
import pytest

import costeer

NAMES = [name for name in costeer.__all__ if name != "__version__"]

PROMISED = {
    "Column",
    "Driver",
    "Method",
    "Predictor",
    "ReadingWarning",
    "Record",
    "Scenario",
    "compare",
    "compiled",
    "evaluate",
    "fit_driver",
    "load_record",
    "measures",
    "DriverModel",
    "parameters",
    "population",
    "replayed_hands",
    "sdlp",
    "simulate",
    "steering_wheel_reversal_rate",
    "study",
    "write_record",
}
"""What docs/python.md and the issue that asked for it name."""


def public(name: str) -> Any:  # Any: a class or a function
    """What has a public name; of `study` the function."""
    from costeer.api.trials import study

    return study if name == "study" else getattr(costeer, name)


def run_python(code: str) -> str:
    """What code prints in a new interpreter."""
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_the_public_names_are_those_that_were_promised() -> None:
    assert set(NAMES) == PROMISED
    assert set(dir(costeer)) == {*PROMISED, "__version__"}


def test_an_import_of_costeer_imports_nothing_heavy() -> None:
    heavy = "{'numpy', 'numba', 'pandas', 'scipy', 'pyarrow', 'matplotlib', 'jax'}"
    code = f"import sys, costeer; dir(costeer); print({heavy} & set(sys.modules))"
    assert run_python(code) == "set()"


def test_an_import_of_costeer_imports_one_module_of_its_own() -> None:
    code = (
        "import sys, costeer; "
        "print(sorted(m for m in sys.modules if m.startswith('costeer')))"
    )
    assert run_python(code) == "['costeer', 'costeer.moved']"


def test_a_name_that_does_not_exist_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        _ = costeer.simulat  # type: ignore[attr-defined]  # that is the point


LONG = ("evaluate", "fit_driver")
"""Examples that take seconds of what quick tests of their rooms do as well."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.slow) if n in LONG else n for n in NAMES],
)
def test_each_public_name_has_an_example_that_runs(name: str) -> None:
    text = inspect.getdoc(public(name)) or ""
    assert "Example:" in text
    examples = doctest.DocTestParser().get_doctest(
        text, {"__name__": "__main__"}, name, None, None
    )
    assert examples.examples
    with mpl.rc_context():
        failed, tried = doctest.DocTestRunner().run(examples)
    assert (failed, tried) == (0, len(examples.examples))


@pytest.mark.slow
@pytest.mark.parametrize("first", ["costeer.study.run", "costeer"])
def test_study_is_a_room_and_runs_whatever_was_imported_first(first: str) -> None:
    code = (
        f"import {first}, costeer, inspect; from costeer.study.design import Trial; "
        "print(callable(costeer.study), list(inspect.signature(costeer.study)"
        ".parameters)[:2], costeer.study.design.Trial is Trial)"
    )
    assert run_python(code) == "True ['out', 'participants'] True"


@pytest.mark.parametrize("name", NAMES)
def test_a_public_name_is_the_object_of_the_deep_import(name: str) -> None:
    found = public(name)
    module = import_module(found.__module__)
    assert getattr(module, found.__name__) is found
