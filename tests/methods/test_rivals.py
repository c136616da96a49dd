"""All methods to compare: what every method must have, and thresholds as documented."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.base.described import value_at
from costeer.controller.signals import LANE_CHANGING
from costeer.loop.jax_rollout import float64
from costeer.loop.parameters import DT
from costeer.methods.interface import usual_parameters
from costeer.methods.registry import METHODS
from costeer.methods.rivals import RIVALS
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import cruising_lane
from costeer.testing import check_method
from costeer.testing.drive import driven, random_drive, strong_parameters
from costeer.testing.method import _check_compiled_step
from tests.methods.loops import ROADS, apart, names, rows

PAGE = Path(__file__).parents[2] / "docs" / "methods.md"

every_rival = pytest.mark.parametrize("method", RIVALS, ids=[m.name for m in RIVALS])


@pytest.mark.parametrize(
    "name",
    [
        m.name
        if m.name == "bandwidth"
        else pytest.param(m.name, marks=pytest.mark.slow)
        for m in RIVALS
    ],
)
def test_a_rival_is_pure_bounded_mirrored_and_bears_lost_samples(name: str) -> None:
    said = dict(check_method(name, engines=("python",), jax=False).findings)
    assert said["NaN"] == "a sample of NaN gives a finite torque"


@pytest.mark.slow
@every_rival
def test_a_step_of_a_rival_is_the_same_in_every_engine(method: Any) -> None:
    jax = pytest.importorskip("jax")
    road = RoadParameters()
    moments = random_drive(np.random.default_rng(1), road)
    in_python = driven(method, moments, road)
    assert "us a control step" in _check_compiled_step(method, moments, in_python)

    def traced(tree: Any) -> Any:
        return jax.tree_util.tree_map(jax.numpy.asarray, tree)

    with float64():
        given = strong_parameters(method, road)
        state = traced(method.initial_state(given, cruising_lane(road)))
        given = traced(given)
        step = jax.jit(lambda s, m, r: method.step(given, s, m, r, DT))
        for now, answer in zip(moments[:300], in_python.answers, strict=False):
            state, said = step(state, traced(now.measurement), traced(now.request))
            expected = pytest.approx(answer.applied_torque, abs=1e-9)
            assert float(said.applied_torque) == expected


every_loop = pytest.mark.parametrize("name", METHODS)
on_each_road = pytest.mark.parametrize("road", ROADS)


@pytest.mark.no_cover  # tracing so much plain Python takes half a minute
@pytest.mark.slow
@on_each_road
@every_loop
def test_the_closed_loop_of_every_method_is_the_same_in_python(
    name: str, road: str
) -> None:
    assert_agrees(name, road, "python")


@pytest.mark.no_cover
@pytest.mark.slow  # JAX compiles each for 5 to 10 s
@on_each_road
@every_loop
def test_the_closed_loop_of_every_method_is_the_same_in_jax(
    name: str, road: str
) -> None:
    pytest.importorskip("jax")
    assert_agrees(name, road, "jax")


def assert_agrees(name: str, road: str, engine: str) -> None:
    """The engines part by rounding alone, which the loop damps: see test_engines.py.

    1e-9 leaves room for other libraries' tanh, not for another equation; a path that
    begins a step apart would show as a difference of 1.
    """
    there, here = rows(name, road, engine), rows(name, road, "numba")
    difference = apart(there, here)
    worst = int(np.argmax(difference))
    assert difference[worst] < 1e-9, names(name)[worst]


@pytest.mark.slow
@on_each_road
@every_loop
def test_the_loops_that_are_compared_hold_what_the_methods_do(
    name: str, road: str
) -> None:
    method, seen = (
        METHODS[name],
        dict(zip(names(name), rows(name, road, "numba").T, strict=True)),
    )
    assert set(seen["lane"]) == {0.0, 1.0}
    assert set(seen["driver_intention"]) == {-1.0, 0.0, 1.0}
    assert (np.abs(seen["applied_torque"]).max() > 0.5) == method.assists
    assert (LANE_CHANGING in seen["mode"]) == (name not in PLANLESS)
    bends = np.ptp(seen["road_curvature"])
    assert bends == pytest.approx(1.0 / 1500.0 if road == ROADS[1] else 0.0)


PLANLESS = {
    "lane-keeping",
    "cooperative-status",
    "fixed-sharing",
    "four-design-choices",
    "bandwidth",
    "bandwidth-constant",
    "traded",
}
"""Methods that never begin a path; `traded` could, but this driver holds the wheel."""


def test_a_torque_that_is_a_millionth_weaker_is_seen_as_a_difference() -> None:
    # What 1e-9 would catch: in two seconds 3 % of the torque's own millionth at least.
    usual = rows("lane-keeping", ROADS[0], "python", 120, 1.0)
    weaker = rows("lane-keeping", ROADS[0], "python", 120, 1.0 - 1e-6)
    difference = dict(zip(names("lane-keeping"), apart(weaker, usual), strict=True))
    assert difference["applied_torque"] > 3e-8


def test_the_page_has_every_method_in_its_table() -> None:
    table, _, _ = PAGE.read_text("utf-8").partition("\n## ")
    named = re.findall(r"^\| `([a-z-]+)` \|", table, re.MULTILINE)
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
