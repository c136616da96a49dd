"""Contrasts: what an effect says about the means of the cells of a design.

An effect is a matrix whose columns are orthonormal, each summing to zero over the
cells. With cell means as the model (every cell its own mean), testing such columns
is a test with type III sums of squares: cells count alike, however full they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Effect(NamedTuple):
    """One effect of a design.

    Attributes:
        name: As in the column `effect` of `tests.csv`.
        contrasts: Shape (cells, degrees of freedom), orthonormal columns [-].
    """

    name: str
    contrasts: NDArray[np.float64]


def one_way(name: str, num_levels: int) -> tuple[Effect]:
    """Return the effect of a single factor, whose levels are the cells."""
    return (Effect(name, _sum_to_zero(num_levels)),)


def two_way(
    first: str, num_first: int, second: str, num_second: int
) -> tuple[Effect, Effect, Effect]:
    """Return both main effects and their interaction.

    Cell `i * num_second + j` is level i of the first and level j of the second factor.
    """
    contrast_first, mean_first = _sum_to_zero(num_first), _average(num_first)
    contrast_second, mean_second = _sum_to_zero(num_second), _average(num_second)
    return (
        Effect(first, _crossed(contrast_first, mean_second)),
        Effect(second, _crossed(mean_first, contrast_second)),
        Effect(f"{first}:{second}", _crossed(contrast_first, contrast_second)),
    )


def _crossed(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.asarray(np.kron(first, second), dtype=np.float64)


def _sum_to_zero(num_levels: int) -> NDArray[np.float64]:
    """Orthonormal contrasts between levels, shape (levels, levels - 1)."""
    from scipy import linalg

    if num_levels < 2:
        return np.zeros((num_levels, 0))
    return np.asarray(linalg.helmert(num_levels).T, dtype=np.float64)


def _average(num_levels: int) -> NDArray[np.float64]:
    """Shape (levels, 1): the sum over levels, of unit length."""
    return np.full((num_levels, 1), max(num_levels, 1) ** -0.5)
