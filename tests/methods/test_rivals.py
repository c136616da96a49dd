"""All methods to compare: what every method must have, and thresholds as documented."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from costeer.base.described import value_at
from costeer.methods.interface import usual_parameters
from costeer.methods.registry import METHODS
from costeer.methods.rivals import RIVALS
from costeer.testing import check_method

PAGE = Path(__file__).parents[2] / "docs" / "methods.md"

every_rival = pytest.mark.parametrize("method", RIVALS, ids=[m.name for m in RIVALS])


@every_rival
def test_a_rival_is_pure_bounded_mirrored_and_bears_lost_samples(method: Any) -> None:
    said = dict(check_method(method, engines=("python",), jax=False).findings)
    assert said["NaN"] == "a sample of NaN gives a finite torque"


@pytest.mark.slow
@every_rival
def test_the_engines_agree_on_a_rival(method: Any) -> None:
    said = dict(check_method(method, jax=True).findings)
    assert said["engines"] == "python and numba agree; jax agrees"


def test_the_page_has_every_method_in_its_table() -> None:
    named = re.findall(r"^\| `([a-z-]+)` \|", PAGE.read_text("utf-8"), re.MULTILINE)
    assert named == list(METHODS)


@pytest.mark.parametrize(
    ("name", "leaf"),
    [
        ("lane-crossing-time", "trigger.crossing_time"),
        ("inclusion", "intent.threshold"),
        ("pseudo-work", "consistency.inconsistency_threshold"),
        ("cooperative-status", "cooperation.initiative_threshold"),
    ],
)
def test_a_threshold_is_what_the_page_says_that_pilot_drivers_gave(
    name: str, leaf: str
) -> None:
    found = re.search(
        rf"^{name}, {leaf}: ([0-9.]+) ", PAGE.read_text("utf-8"), re.MULTILINE
    )
    assert found is not None
    in_use = value_at(usual_parameters(METHODS[name]), leaf)
    # Rounded to two figures.
    assert in_use == float(f"{float(found[1]):.2g}")
