"""Means with t intervals per condition and strength, for tables and bar charts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from costeer.study.cells import (
    CONDITION,
    STRENGTH,
    Observations,
    Roster,
    level_indices,
    levels,
    participant_means,
)
from costeer.study.effects import CONFIDENCE
from costeer.study.outcome import PUBLISHED, WITHIN, SummaryRow
from costeer.study.ttests import mean_or_nan


def summaries(
    measure: str,
    observed: Observations,
    everyone: Roster,
    factors: Sequence[str] = (CONDITION, STRENGTH),
) -> Iterator[SummaryRow]:
    """Yield a row per level of each factor, pooled and by participant.

    Args:
        measure: Name of the measure.
        observed: Its values.
        everyone: Participants and conditions of the study.
        factors: `condition`, `strength` or both.
    """
    for factor in factors:
        names = levels(everyone.conditions, factor)
        pooled = _pooled(observed, factor, names)
        means = participant_means(observed, everyone.participants, factor, names)
        by_participant = [column[np.isfinite(column)] for column in means.T]
        for analysis, groups in ((PUBLISHED, pooled), (WITHIN, by_participant)):
            for level, values in zip(names, groups, strict=True):
                yield _summary((measure, analysis, factor, level), values)


def _pooled(
    observed: Observations, factor: str, names: Sequence[str]
) -> list[NDArray[np.float64]]:
    cells = level_indices(observed, factor, names)
    return [observed.values[cells == column] for column in range(len(names))]


def _summary(
    names: tuple[str, str, str, str], values: NDArray[np.float64]
) -> SummaryRow:
    from scipy import stats

    n = values.size
    note = {0: "no value", 1: "one value: no interval"}.get(n, "")
    mean = mean_or_nan(values)
    sd = float(values.std(ddof=1)) if n > 1 else math.nan
    half = math.nan
    if n > 1:
        quantile = float(stats.t.ppf((1.0 + CONFIDENCE) / 2.0, n - 1))
        half = quantile * sd / math.sqrt(n)
    return SummaryRow(*names, n, mean, sd, mean - half, mean + half, note)
