"""How exact and how fast the elementary functions of compiled code are.

Run: `python -m benchmarks.elementary [POINTS]`

For each function the largest error over random arguments, in units in the last place of
the exact value (which mpmath computes with 200 bits), and the time of one value: alone,
eight at a time, and by the C library. Best of several rounds.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath
import numba
import numpy as np
from numpy.typing import NDArray

from costeer.base import elementary, lanes

Numbers = NDArray[np.float64]

ROUNDS, REPEATS = 7, 50
TANGENTS = ("tan", "tanh")


class Range(NamedTuple):
    """Arguments of a function.

    Attributes:
        name: Of the function.
        low: Least argument.
        high: Largest argument.
        even: Whether they are spread evenly; else their logarithms are.
    """

    name: str
    low: float
    high: float
    even: bool = True


RANGES = (
    *(Range(name, -0.785, 0.785) for name in ("sin", "cos", "tan")),
    *(Range(name, 1e-8, 0.7, even=False) for name in ("sin", "cos", "tan")),
    *(Range(name, -100.0, 100.0) for name in ("sin", "cos", "tan")),
    *(Range(name, -1.04e6, 1.04e6) for name in ("sin", "cos", "tan")),
    *(Range(name, -1e9, 1e9) for name in ("sin", "cos", "tan")),
    Range("atan", -4.0, 4.0),
    Range("atan", 1e-12, 1e12, even=False),
    Range("exp", -1.0, 1.0),
    Range("exp", -708.0, 709.0),
    Range("exp", -745.0, -708.0),
    Range("tanh", -1.0, 1.0),
    Range("tanh", -25.0, 25.0),
    Range("tanh", 1e-12, 25.0, even=False),
)


def arguments(within: Range, count: int, seed: int = 1) -> Numbers:
    """Random arguments, `(argument,)`."""
    random = np.random.default_rng(seed)
    if within.even:
        return random.uniform(within.low, within.high, count)
    return np.exp(random.uniform(math.log(within.low), math.log(within.high), count))


def allowed(name: str) -> float:
    """Largest error of a function that is promised [units in the last place]."""
    return 2.5 if name in TANGENTS else 1.0


def compiled_alone(name: str) -> Callable[[Numbers, Numbers], None]:
    """Computes a function of each number of an array into another one."""
    return _over(getattr(elementary, name))


def compiled_together(name: str) -> Callable[[Numbers, Numbers], None]:
    """The same of eight at a time; arrays `(eight, lane)`."""
    function = getattr(elementary, name)

    @numba.njit(error_model="numpy")
    def run(given: Any, out: Any) -> None:  # Any: arrays, for Numba
        for k in range(len(given)):
            out[k] = lanes.spread(function(lanes.load(given, k)))

    return run  # type: ignore[no-any-return]  # Numba has no types


def _over(function: Any) -> Callable[[Numbers, Numbers], None]:
    @numba.njit(error_model="numpy")
    def run(given: Any, out: Any) -> None:  # Any: arrays, for Numba
        for k in range(len(given)):
            out[k] = function(given[k])

    return run  # type: ignore[no-any-return]  # Numba has no types


def computed(run: Callable[[Numbers, Numbers], None], given: Numbers) -> Numbers:
    """What a compiled function gives for an array."""
    out = np.empty_like(given)
    run(given, out)
    return out


def errors(name: str, given: Numbers, found: Numbers) -> Numbers:
    """Errors of found values, `(argument,)` [units in the last place]."""
    exact_of = getattr(mpmath, name)
    wrong = np.empty(len(given))
    with mpmath.workprec(200):
        for k, (x, value) in enumerate(
            zip(given.tolist(), found.tolist(), strict=True)
        ):
            exact = exact_of(mpmath.mpf(x))
            unit = np.spacing(abs(float(exact)))
            wrong[k] = abs(mpmath.mpf(value) - exact) / mpmath.mpf(float(unit))
    return wrong


def nanoseconds(run: Callable[[Numbers, Numbers], None], given: Numbers) -> float:
    """Least time of one value [ns]."""
    out, best = np.empty_like(given), math.inf
    run(given, out)
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        for _ in range(REPEATS):
            run(given, out)
        best = min(best, time.perf_counter() - begun)
    return best / REPEATS / given.size * 1e9


def main() -> int:
    """Print errors and times; 1 if an error is larger than promised."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 8000
    count -= count % lanes.WIDTH
    failed = False
    print(
        "function, arguments: largest error [ulp]; ns alone, of eight, of the library"
    )
    for within in RANGES:
        name, given = within.name, arguments(within, count)
        alone = compiled_alone(name)
        worst = errors(name, given, computed(alone, given)).max()
        failed |= worst > allowed(name)
        eight = nanoseconds(compiled_together(name), given.reshape(-1, lanes.WIDTH))
        library = nanoseconds(_over(getattr(math, name)), given)
        print(
            f"{name:5}{within.low:>10g} to {within.high:<8g}{worst:6.2f}; "
            f"{nanoseconds(alone, given):6.2f} {eight:6.2f} {library:6.2f}",
            flush=True,
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
