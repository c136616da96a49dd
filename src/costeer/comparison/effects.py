"""Paired effects: method against method, and mistake against none.

Every difference is within the driver: the same person, road and noise. Intervals are
Student's; p values are corrected after Benjamini and Hochberg over all comparisons of a
measure, so that the best of many is not called better for being picked.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.comparison.criteria import CRITERIA, Criterion, criterion
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Key, Results
from costeer.study.quantities import half_width
from costeer.study.ttests import TTest, benjamini_hochberg, paired_t_test

LEVEL = 0.05
"""Corrected p values below it are a difference. Source: the paper, Sec. III-F."""

METHODS, MISTAKES = "methods", "mistakes"
"""Kinds of comparisons: two methods, or a method with a mistake and without."""

NO_EVENTS = "no events"
"""Of a row in which what is counted happened to nobody."""

Values = NDArray[np.float64]


class EffectRow(NamedTuple):
    """A row of `effects.csv`: a paired difference, first minus second.

    Attributes:
        kind: "methods" or "mistakes".
        measure: Column of `trials.csv`.
        scenario: Where.
        method: Of a comparison of mistakes; empty between methods.
        mistake: Of both methods; empty in a comparison of mistakes.
        first: Method, or mistake.
        second: Method, or "none".
        n: Drivers with both values.
        mean_first: Mean of the first over them, SI unit.
        mean_second: Mean of the second.
        difference: First minus second.
        low: Lower end of its 95 % interval.
        high: Upper end of it.
        statistic: t [-]; empty where every driver has the same difference.
        p: Two-sided.
        p_corrected: After Benjamini and Hochberg over all rows of kind and measure.
        better: The better one; empty if neither is shown to be.
        note: What to know of the row.
    """

    kind: str
    measure: str
    scenario: str
    method: str
    mistake: str
    first: str
    second: str
    n: int
    mean_first: float
    mean_second: float
    difference: float
    low: float
    high: float
    statistic: float
    p: float
    p_corrected: float = math.nan
    better: str = ""
    note: str = ""


class MeanRow(NamedTuple):
    """A row of `means.csv`: one measure of a method on a road with a mistake.

    Attributes:
        measure: Column of `trials.csv`.
        scenario: Where.
        mistake: With what mistake.
        method: Whose.
        n: Drivers with a value.
        mean: Over them, SI unit.
        sd: Between them.
        low: Lower end of the mean's 95 % interval.
        high: Upper end of it.
    """

    measure: str
    scenario: str
    mistake: str
    method: str
    n: int
    mean: float
    sd: float
    low: float
    high: float


def mean_rows(results: Results) -> list[MeanRow]:
    """Means with intervals of every measure and cell, in the order of the tables."""
    return [
        _mean_row(each.name, key, results.column(key, each.name))
        for each in CRITERIA
        for key in results.values
    ]


def _mean_row(measure: str, key: Key, column: Values) -> MeanRow:
    values = column[np.isfinite(column)]
    mean = float(values.mean()) if values.size else math.nan
    sd = float(values.std(ddof=1)) if values.size > 1 else math.nan
    half = half_width(values)
    return MeanRow(measure, *key, values.size, mean, sd, mean - half, mean + half)


def effect_rows(results: Results) -> list[EffectRow]:
    """All paired comparisons, corrected over each measure."""
    rows = []
    for each in CRITERIA:
        rows += corrected(_between_methods(results, each.name))
        rows += corrected(_of_mistakes(results, each.name))
    return rows


def _between_methods(results: Results, measure: str) -> Iterator[EffectRow]:
    for scenario in results.scenarios:
        for mistake in results.mistakes:
            there = [
                name
                for name in results.methods
                if np.isfinite(results.column((scenario, mistake, name), measure)).any()
            ]
            for first, second in itertools.combinations(there, 2):
                values = (
                    results.column((scenario, mistake, name), measure)
                    for name in (first, second)
                )
                names = METHODS, measure, scenario, "", mistake, first, second
                yield paired_effect(names, *values)


def _of_mistakes(results: Results, measure: str) -> Iterator[EffectRow]:
    for scenario, mistake, method in results.values:
        without = results.column((scenario, NONE, method), measure)
        given = results.column((scenario, mistake, method), measure)
        if mistake != NONE and np.isfinite(given).any() and np.isfinite(without).any():
            names = MISTAKES, measure, scenario, method, "", mistake, NONE
            yield paired_effect(names, given, without)


def paired_effect(
    names: tuple[str, str, str, str, str, str, str], first: Values, second: Values
) -> EffectRow:
    """One paired comparison, not yet corrected.

    Where all drivers have the same difference there is no variance to test it by: no
    difference at all has a p of 1, another one that of an exact sign test.

    Args:
        names: The first seven columns of the row.
        first: Of every driver, shape `(participant,)`; NaN where there is none.
        second: The same.
    """
    both = np.isfinite(first) & np.isfinite(second)
    test = paired_t_test(first[both], second[both], sizes=False)
    n = int(both.sum())
    difference = test.mean_first - test.mean_second
    if not math.isfinite(test.p) and n >= 2:
        test = _without_variance(test, difference, n)
        events = first[both].any() or second[both].any()
        if criterion(names[1]).is_count and not events:
            test = test._replace(note=NO_EVENTS)
    return EffectRow(
        *names,
        n=n,
        mean_first=test.mean_first,
        mean_second=test.mean_second,
        difference=difference,
        low=test.low,
        high=test.high,
        statistic=test.statistic,
        p=test.p,
        note=test.note,
    )


def _without_variance(test: TTest, difference: float, n: int) -> TTest:
    size = max(abs(test.mean_first), abs(test.mean_second))
    same = abs(difference) <= 1e-12 * size
    return test._replace(
        low=difference,
        high=difference,
        p=1.0 if same else 2.0 ** (1 - n),
        note="no difference" if same else "one difference for all: sign test",
    )


def corrected(rows: Iterable[EffectRow]) -> list[EffectRow]:
    """Rows of one family with corrected p values and the better one of each."""
    family = list(rows)
    p_values = benjamini_hochberg([row.p for row in family])
    return [
        row._replace(p_corrected=p, better=_better(criterion(row.measure), row, p))
        for row, p in zip(family, p_values, strict=True)
    ]


def _better(measure: Criterion, row: EffectRow, p: float) -> str:
    if not p < LEVEL or not measure.better:
        return ""
    return row.first if row.difference * measure.better > 0.0 else row.second
