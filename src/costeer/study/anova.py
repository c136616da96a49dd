"""Analysis of variance of pooled values: each counts as independent of the others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import NDArray

from costeer.study.contrasts import Effect


class FTest(NamedTuple):
    """Outcome of an F test before its p value; NaN where a reason forbids it.

    Attributes:
        statistic: F [-].
        df1: Degrees of freedom of the effect [-].
        df2: Degrees of freedom of the error [-].
        epsilon: Factor on both for lack of sphericity [-]; 1 where it has no place.
        note: Why there is no outcome, or what to know about it; empty if nothing.
        huynh_feldt: A less strict factor than `epsilon` [-]; 1 where it has no place.
        error_share: The effect's own error over the errors of all effects and the
            differences between participants, as sums of squares [-]; NaN in a mixed
            model, which does not divide them.
    """

    statistic: float
    df1: float
    df2: float
    epsilon: float = 1.0
    note: str = ""
    huynh_feldt: float = 1.0
    error_share: float = 1.0


ONE_LEVEL = "fewer than two levels to compare"


def no_f_test(reason: str) -> FTest:
    """Return the outcome of a test that cannot be made."""
    nan = math.nan
    return FTest(nan, nan, nan, nan, reason, nan, nan)


def pooled_f_tests(
    values: Float[NDArray[np.float64], " observation"],
    cells: Int[NDArray[np.intp], " observation"],
    effects: Sequence[Effect],
) -> tuple[FTest, ...]:
    """Type III F tests of the effects of a fully crossed design, balanced or not.

    Args:
        values: One per observation, shape (observations,).
        cells: Cell of each observation, shape (observations,).
        effects: Effects to test, over the same cells.

    Returns:
        One test per effect, in their order.
    """
    num_cells = effects[0].contrasts.shape[0]
    reason = _obstacle(values, cells, num_cells)
    if reason:
        return tuple(no_f_test(reason) for _ in effects)
    return tuple(_pooled_f_test(values, cells, effect) for effect in effects)


def vanishes(residuals: NDArray[np.float64], values: NDArray[np.float64]) -> bool:
    """Whether residuals of these values are zero but for rounding."""
    # Means of some hundred values are exact to about 1e-15 of the largest; no sensor
    # resolves 1e-12 of its range, so nothing real is lost below.
    return bool(np.all(np.abs(residuals) <= 1e-12 * np.max(np.abs(values))))


def _obstacle(
    values: NDArray[np.float64], cells: NDArray[np.intp], num_cells: int
) -> str:
    counts = np.bincount(cells, minlength=num_cells)
    if num_cells < 2:
        return ONE_LEVEL
    if not np.all(counts):
        return "a cell is empty"
    if values.size <= num_cells:
        return "one value per cell: no variance to compare with"
    if vanishes(values - _cell_means(values, cells, num_cells)[cells], values):
        return "no variance within the cells"
    return ""


def _pooled_f_test(
    values: NDArray[np.float64], cells: NDArray[np.intp], effect: Effect
) -> FTest:
    """Compare the variance of contrasts of cell means with that within cells."""
    num_cells, df1 = effect.contrasts.shape
    if df1 == 0:
        return no_f_test(ONE_LEVEL)
    means = _cell_means(values, cells, num_cells)
    df2 = values.size - num_cells
    error = float(np.sum((values - means[cells]) ** 2)) / df2
    estimates = effect.contrasts.T @ means
    counts = np.bincount(cells, minlength=num_cells)
    covariance = effect.contrasts.T @ (effect.contrasts / counts[:, None])
    explained = float(estimates @ np.linalg.solve(covariance, estimates)) / df1
    return FTest(explained / error, float(df1), float(df2))


def _cell_means(
    values: NDArray[np.float64], cells: NDArray[np.intp], num_cells: int
) -> NDArray[np.float64]:
    counts = np.bincount(cells, minlength=num_cells)
    sums = np.bincount(cells, weights=values, minlength=num_cells)
    return np.asarray(sums / np.maximum(counts, 1), dtype=np.float64)
