"""The check of a method finds what is wrong with it and lets a sound one pass."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from costeer.methods.registry import AnyMethod
from costeer.records.columns import Column
from costeer.testing import MethodError, check_method
from tests.methods import rivals
from tests.methods.rivals import FILE, Law, rival


def checked(method: AnyMethod) -> dict[str, str]:
    """What is said of a method that is not compiled."""
    return dict(check_method(method, engines=("python",), jax=False).findings)


def test_a_sound_method_passes_and_is_described() -> None:
    said = checked(rival(rivals.damping))
    assert said["made of"] == "1 parameters, 1 numbers of state"
    assert said["bounded"].startswith("at most 0.9")
    assert said["NaN"].startswith("a sample of NaN gives no number for 1 steps")


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (rivals.not_a_number, r"not finite: it asks for nan N·m at step \d+"),
        (rivals.too_strong, r"not bounded: it asks for \d+.* more than 5 N·m"),
        (rivals.one_sided, r"not mirrored: torque is .* and should be"),
        (rivals.forgetful, r"not pure: the same drive again gives"),
        (rivals.breaking, r"breaks at step \d+ .* RuntimeError: too far"),
    ],
)
def test_the_first_property_that_is_missing_is_named(law: Law, message: str) -> None:
    with pytest.raises(MethodError, match=message):
        checked(rival(law))


def test_an_array_changed_in_place_is_refused() -> None:
    with pytest.raises(MethodError, match="not pure: step 0 changes"):
        checked(rival(rivals.in_place, last=np.zeros(3)))


def test_a_torque_of_a_method_that_does_not_assist_is_refused() -> None:
    with pytest.raises(MethodError, match="more than 0 N·m"):
        checked(rival(rivals.damping)._replace(assists=False))


@pytest.mark.slow
def test_a_column_that_mirrors_other_than_it_says_is_refused() -> None:
    column = Column("method_rate", "rad/s", "float64", "of the wheel", "method.last")
    with pytest.raises(MethodError, match="column method_rate is"):
        checked(rival(rivals.damping)._replace(columns=(column,)))
    flipped = (column._replace(mirrored="flipped"),)
    assert checked(rival(rivals.damping)._replace(columns=flipped))["columns"] == (
        "method_rate"
    )


@pytest.mark.slow
def test_a_method_that_is_not_compiled_is_refused_by_numba() -> None:
    with pytest.raises(ValueError, match=r"'rival' cannot be compiled.*@compiled"):
        check_method(rival(rivals.damping), jax=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["ibhs", pytest.param("manual", marks=pytest.mark.slow)]
)
def test_the_methods_of_costeer_pass_in_python(name: str) -> None:
    report = check_method(name, engines=("python",), jax=False)
    assert "a sample of NaN gives a finite torque" in str(report)


@pytest.mark.slow
def test_the_example_passes_in_every_engine_and_is_short() -> None:
    report = check_method(str(FILE), jax=True)
    said = dict(report.findings)
    assert said["columns"] == "method_integral"
    assert said["engines"] == "python and numba agree; jax agrees"
    microseconds = float(said["speed"].split()[0])
    assert 0.0 < microseconds < math.inf
    assert str(report).startswith("method pi-keeping 1\n")
    assert sum(map(bool, map(str.strip, FILE.read_text("utf-8").splitlines()))) < 60


@pytest.mark.slow
def test_the_page_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    root = Path(__file__).parents[2]
    monkeypatch.chdir(root)
    page = (root / "docs" / "plug-ins.md").read_text("utf-8")
    blocks = [part.split("```")[0] for part in page.split("```python\n")[1:]]
    assert len(blocks) == 3
    names: dict[str, object] = {"__name__": "__main__"}
    for block in blocks:
        exec(compile(block, "docs/plug-ins.md", "exec"), names)
