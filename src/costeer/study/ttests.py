"""Comparisons of two conditions: t tests, their correction for many, and marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import NDArray

from costeer.study.anova import vanishes
from costeer.study.effects import (
    CONFIDENCE,
    EffectSize,
    cohens_d,
    cohens_d_av,
    cohens_d_z,
)

MARKS = ((0.001, "***"), (0.01, "**"), (0.05, "*"))
"""Mark of a p value below each level. Source: Sec. III-F and its figures."""


class TTest(NamedTuple):
    """Outcome of comparing two conditions; NaN where a reason forbids it.

    Attributes:
        mean_first: Mean of the values compared in the first condition.
        mean_second: The same in the second.
        low: Lower end of the interval of first minus second.
        high: Upper end of it.
        statistic: t, positive if the first is larger [-].
        df: Degrees of freedom [-].
        p: Two-sided p value [-].
        effect_size: Cohen's d or d_z, positive if the first is larger.
        note: Why there is no outcome; empty if there is one.
        d_av: The difference in standard deviations that both kinds of test share.
    """

    mean_first: float
    mean_second: float
    low: float = math.nan
    high: float = math.nan
    statistic: float = math.nan
    df: float = math.nan
    p: float = math.nan
    effect_size: EffectSize = EffectSize()
    note: str = ""
    d_av: EffectSize = EffectSize()


def independent_t_test(
    first: Float[NDArray[np.float64], " first"],
    second: Float[NDArray[np.float64], " second"],
) -> TTest:
    """Student's t test of two independent groups with one variance.

    Args:
        first: Values of the first condition, shape (first,).
        second: Values of the second condition, shape (second,).
    """
    means = mean_or_nan(first), mean_or_nan(second)
    if min(first.size, second.size) < 2:
        return TTest(
            *means, note=f"{first.size} and {second.size} values, 2 each needed"
        )
    residuals = np.concatenate([first - means[0], second - means[1]])
    if vanishes(residuals, np.concatenate([first, second])):
        return TTest(*means, note="no variance within the conditions")
    df = first.size + second.size - 2
    variance = float(residuals @ residuals) / df
    error = math.sqrt(variance * (1.0 / first.size + 1.0 / second.size))
    statistic = (means[0] - means[1]) / error
    size = cohens_d(statistic, first.size, second.size)
    d_av = cohens_d_av(size, math.sqrt(variance) / _average_sd(first, second))
    return _student(means, error, df, statistic, (size, d_av))


def paired_t_test(
    first: Float[NDArray[np.float64], " participant"],
    second: Float[NDArray[np.float64], " participant"],
    sizes: bool = True,
) -> TTest:
    """Student's t test of paired differences.

    Args:
        first: Values of the first condition, shape (participants,).
        second: Those of the second, of the same participants in the same order.
        sizes: Whether effect sizes are wanted: their exact intervals take most of the
            time.
    """
    means = mean_or_nan(first), mean_or_nan(second)
    if first.size < 2:
        return TTest(*means, note=f"{first.size} participant(s) with both, 2 needed")
    differences = first - second
    residuals = differences - differences.mean()
    if vanishes(residuals, np.concatenate([first, second])):
        return TTest(*means, note="no variance of the difference")
    df = first.size - 1
    error = math.sqrt(float(residuals @ residuals) / df / first.size)
    statistic = float(differences.mean()) / error
    if not sizes:
        return _student(means, error, df, statistic, (EffectSize(), EffectSize()))
    size = cohens_d_z(statistic, first.size)
    sd = error * math.sqrt(first.size)
    d_av = cohens_d_av(size, sd / _average_sd(first, second))
    return _student(means, error, df, statistic, (size, d_av))


def _average_sd(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Root of the mean of two variances, in the unit of the values."""
    return math.sqrt((float(first.var(ddof=1)) + float(second.var(ddof=1))) / 2.0)


def _student(
    means: tuple[float, float],
    error: float,
    df: int,
    statistic: float,
    sizes: tuple[EffectSize, EffectSize],
) -> TTest:
    """Student's test of a difference with its standard error.

    We do not call `scipy.stats.ttest_ind`: it warns where one group has a single value
    many times, although the test is sound.
    """
    from scipy import stats

    quantile = float(stats.t.ppf((1.0 + CONFIDENCE) / 2.0, df))
    return TTest(
        *means,
        low=(statistic - quantile) * error,
        high=(statistic + quantile) * error,
        statistic=statistic,
        df=float(df),
        p=2.0 * float(stats.t.sf(abs(statistic), df)),
        effect_size=sizes[0],
        d_av=sizes[1],
    )


def benjamini_hochberg(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct p values for the false discovery rate; NaN stays and does not count."""
    from scipy import stats

    p = np.asarray(p_values, dtype=np.float64)
    corrected = np.full(p.shape, np.nan)
    known = np.isfinite(p)
    if known.any():
        corrected[known] = stats.false_discovery_control(p[known], method="bh")
    return tuple(corrected.tolist())


def significance_mark(p: float) -> str:
    """Return `***`, `**` or `*` for p below 0.001, 0.01 or 0.05, else nothing."""
    return next((mark for level, mark in MARKS if p < level), "")


def mean_or_nan(values: NDArray[np.float64]) -> float:
    """Return the mean, NaN if there is no value."""
    return float(values.mean()) if values.size else math.nan
