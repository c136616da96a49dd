"""What one verdict of the exact window costs, counted: operations and bytes.

Counted is what the window needs, 180 starts and the real number of hidden units; what
the kernel adds to fill its vectors (192 starts, an even number of units) is not. A
fused multiply-add is two operations, a division one; comparisons, copies and the
exponential of the verdict are none.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.intention.features import NUM_INPUTS, WINDOW_LENGTH
from costeer.intention.gru import GATES

FRACTION = 18
"""tanh up to its division: square, two polynomials of four fused steps, times x [-]."""

GATE_OPERATIONS = (
    2  # projections added to reset and update
    + (2 * FRACTION + 1 + 1 + 2 + 2 * 2)  # both logistic functions, one division
    + (1 + 2)  # candidate: bias, reset times that plus projection
    + (FRACTION + 1)  # its tanh
    + (1 + 2)  # new state: difference, update times that plus candidate
)
"""Operations that close the gates of one hidden unit of one window start [-]."""

_FLOAT = 4


class Cost(NamedTuple):
    """Of one verdict.

    Attributes:
        matrix: Operations of U h, six per pair of units and start [-].
        gates: Operations of sigmoid, tanh and the new state [-].
        projection: Operations of W x, once for all starts [-].
        output: Operations of the logit [-].
        states: Hidden states read and written [byte].
        weights: Read [byte].
    """

    matrix: int
    gates: int
    projection: int
    output: int
    states: int
    weights: int


def verdict_cost(hidden: int) -> Cost:
    """Count for a number of hidden units."""
    rows = len(GATES) * hidden
    numbers = rows * (hidden + NUM_INPUTS + 1) + hidden + hidden + 1
    return Cost(
        matrix=2 * rows * hidden * WINDOW_LENGTH,
        gates=GATE_OPERATIONS * hidden * WINDOW_LENGTH,
        projection=2 * rows * NUM_INPUTS,
        output=2 * hidden,
        states=2 * _FLOAT * hidden * WINDOW_LENGTH,
        weights=_FLOAT * numbers,
    )


def operations(cost: Cost) -> int:
    """All floating-point operations."""
    return cost.matrix + cost.gates + cost.projection + cost.output


def moved(cost: Cost) -> int:
    """All bytes that must move between the caches and the core."""
    return cost.states + cost.weights


def intensity(cost: Cost) -> float:
    """Operations per byte."""
    return operations(cost) / moved(cost)
