"""Elementary functions of compiled code: near the exact value, odd or even, one bit.

Exact values come from mpmath with 200 bits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest

from benchmarks.elementary import (
    RANGES,
    Range,
    allowed,
    arguments,
    compiled_alone,
    compiled_together,
    computed,
    errors,
)
from costeer.base import array as xp
from costeer.base import elementary, lanes

ODD = ("sin", "tan", "atan", "tanh")
NAMES = (*ODD, "cos", "exp")
EDGES = (7 / 16, 11 / 16, 19 / 16, 39 / 16, elementary.NEAR, elementary.FAR, 22.0)


def around(values: tuple[float, ...]) -> np.ndarray:
    """Numbers, and those next to them, with both signs; `(argument,)`."""
    low, high = (np.nextafter(values, to) for to in (-np.inf, np.inf))
    found = np.concatenate([low, values, high])
    return np.concatenate([found, -found])


@pytest.mark.parametrize("within", RANGES, ids=str)
def test_errors_stay_below_what_is_promised(within: Range) -> None:
    given = arguments(within, 800, seed=2)
    found = computed(compiled_alone(within.name), given)
    assert errors(within.name, given, found).max() <= allowed(within.name)


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_angles_next_to_whole_quarters_keep_all_digits(name: str) -> None:
    quarters = tuple(k * math.pi / 2.0 for k in (*range(1, 40), 1001, 600_000, 667_000))
    given = around(quarters)
    found = computed(compiled_alone(name), given)
    assert errors(name, given, found).max() <= allowed(name)


@pytest.mark.parametrize("name", NAMES)
def test_pieces_meet(name: str) -> None:
    given = around(EDGES)
    given = given[np.abs(given) < 700.0] if name == "exp" else given
    found = computed(compiled_alone(name), given)
    assert errors(name, given, found).max() <= allowed(name)


@pytest.mark.parametrize("name", [*ODD, "cos"])
def test_left_mirrors_right_to_the_last_bit(name: str) -> None:
    run = compiled_alone(name)
    given = np.concatenate([arguments(w, 400, 3) for w in RANGES if w.name == name])
    sign = -1.0 if name in ODD else 1.0
    there, here = computed(run, -given), sign * computed(run, given)
    assert there.tobytes() == here.tobytes()


@pytest.mark.parametrize("name", [*NAMES, "log"])
def test_eight_at_a_time_are_the_same_bits(name: str) -> None:
    drawn = [arguments(w, 400, 4) for w in RANGES if w.name == name]
    special = [0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, 1e300, -1e300]
    given = np.concatenate([*drawn, special * 4, around(EDGES * 4), [1.0, 2.0] * 20])
    given = np.random.default_rng(5).permutation(given)
    given = given[: len(given) - len(given) % lanes.WIDTH]
    if name == "log":
        given = np.abs(given)
    alone = computed(compiled_alone(name), given)
    eight = computed(compiled_together(name), given.reshape(-1, lanes.WIDTH))
    assert alone.tobytes() == eight.ravel().tobytes()


@pytest.mark.parametrize(
    ("name", "given", "wanted"),
    [
        ("sin", math.inf, math.nan),
        ("cos", -math.inf, math.nan),
        ("tan", math.nan, math.nan),
        ("atan", math.inf, math.pi / 2.0),
        ("atan", -math.inf, -math.pi / 2.0),
        ("exp", math.inf, math.inf),
        ("exp", 709.9, math.inf),
        ("exp", -math.inf, 0.0),
        ("exp", -745.2, 0.0),
        ("exp", 0.0, 1.0),
        ("exp", math.nan, math.nan),
        ("tanh", math.inf, 1.0),
        ("tanh", -math.inf, -1.0),
        ("tanh", math.nan, math.nan),
        ("cos", 0.0, 1.0),
    ],
)
def test_limits(name: str, given: float, wanted: float) -> None:
    (found,) = computed(compiled_alone(name), np.array([given]))
    np.testing.assert_equal(found, wanted)


@pytest.mark.parametrize(
    "function", [xp.sin, xp.cos, xp.tan, xp.atan, xp.exp, xp.tanh, xp.log]
)
def test_compiled_code_takes_these_and_not_the_library_s(
    function: Callable[[float], float],
) -> None:
    given = np.linspace(0.01, 3.0, 999)
    here = computed(compiled_alone(function.__name__), given)

    @numba.njit(error_model="numpy")
    def of_engine(given: Any, out: Any) -> None:
        for k in range(len(given)):
            out[k] = function(given[k])

    assert computed(of_engine, given).tobytes() == here.tobytes()
    library = np.array([function(x) for x in given.tolist()])
    np.testing.assert_array_max_ulp(here, library, 4)
