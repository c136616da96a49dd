"""Who is best at what, and where that is a tie.

The best mean is a winner only if it is shown to be better than every other method;
methods that it is not shown to be better than tie with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from costeer.comparison.criteria import RANKED, Criterion, criterion
from costeer.comparison.effects import METHODS, NO_EVENTS, EffectRow
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results

WINNER, TIE, NOBODY = "winner", "tie", "not compared"

LEAST_SHARE = 0.5
"""A method with values of fewer drivers is not ranked. Source: assumed."""


class WinnerRow(NamedTuple):
    """A row of `winners.csv`.

    Attributes:
        aim: For which.
        measure: Column of `trials.csv`.
        scenario: Where.
        mistake: With what mistake.
        verdict: "winner", "tie" or "not compared" (fewer than two methods).
        best: The method with the best mean.
        mean: Of it, SI unit.
        tied: Methods that it is not shown to be better than, separated by "; ".
        second: The method with the next best mean.
        difference: Best minus second, paired by driver, SI unit.
        low: Lower end of its 95 % interval.
        high: Upper end of it.
        num_ranked: Methods that were compared.
        not_ranked: Those that were not, separated by "; ": trials of theirs failed, or
            half of the drivers have no value.
        note: "no events" if what is counted happened to nobody.
    """

    aim: str
    measure: str
    scenario: str
    mistake: str
    verdict: str
    best: str
    mean: float
    tied: str
    second: str
    difference: float
    low: float
    high: float
    num_ranked: int
    not_ranked: str
    note: str = ""


class Loss(NamedTuple):
    """A method that is shown to be better than another in a measure on a road."""

    aim: str
    measure: str
    scenario: str
    winner: str
    difference: float
    low: float
    high: float


def winner_rows(results: Results, effects: Sequence[EffectRow]) -> list[WinnerRow]:
    """The winner or the tie of every measure, road and mistake."""
    pairs = {
        (row.measure, row.scenario, row.mistake, *names): turned
        for row in effects
        if row.kind == METHODS
        for names, turned in _both_ways(row)
    }
    return [
        _winner(results, pairs, each, scenario, mistake)
        for each in RANKED
        for scenario in results.scenarios
        for mistake in results.mistakes
    ]


def _both_ways(row: EffectRow) -> list[tuple[tuple[str, str], EffectRow]]:
    """A comparison as first minus second, and as second minus first."""
    return [((row.first, row.second), row), ((row.second, row.first), turned(row))]


def turned(row: EffectRow) -> EffectRow:
    """The same comparison as second minus first."""
    return row._replace(
        first=row.second,
        second=row.first,
        mean_first=row.mean_second,
        mean_second=row.mean_first,
        difference=-row.difference,
        low=-row.high,
        high=-row.low,
        statistic=-row.statistic,
    )


def _winner(
    results: Results,
    pairs: dict[tuple[str, str, str, str, str], EffectRow],
    measure: Criterion,
    scenario: str,
    mistake: str,
) -> WinnerRow:
    means = _ranked(results, measure.name, scenario, mistake)
    there = [m for m in results.methods if (scenario, mistake, m) in results.values]
    out = "; ".join(name for name in there if name not in means)
    row = WinnerRow(
        *(measure.aim, measure.name, scenario, mistake, NOBODY, "", math.nan, "", ""),
        *(math.nan, math.nan, math.nan, len(means), out),
    )
    if len(means) < 2:
        return row
    ordered = sorted(means, key=lambda name: -measure.better * means[name])
    best, second = ordered[:2]
    own = {n: pairs[measure.name, scenario, mistake, best, n] for n in ordered[1:]}
    tied = [name for name in means if name in own and own[name].better != best]
    nothing = all(each.note == NO_EVENTS for each in own.values())
    return row._replace(
        verdict=TIE if tied else WINNER,
        best=best,
        mean=means[best],
        tied="; ".join(tied),
        second=second,
        difference=own[second].difference,
        low=own[second].low,
        high=own[second].high,
        note=NO_EVENTS if nothing else "",
    )


def _ranked(
    results: Results, measure: str, scenario: str, mistake: str
) -> dict[str, float]:
    """Means of the methods that can be compared, in the order of the tables."""
    broken = {
        each.method
        for each in results.failures
        if (each.scenario, each.mistake) == (scenario, mistake)
    }
    found = {}
    for name in results.methods:
        column = results.column((scenario, mistake, name), measure)
        known = column[np.isfinite(column)]
        enough = known.size >= max(2.0, LEAST_SHARE * column.size)
        if enough and name not in broken:
            found[name] = float(known.mean())
    return found


def losses(effects: Sequence[EffectRow], method: str) -> list[Loss]:
    """Where a method is shown to be worse than another, without a mistake.

    Only in the measures that speak for an aim. The difference is that of the method
    minus the other.
    """
    found = []
    for row in effects:
        measure = criterion(row.measure)
        names = row.first, row.second
        if row.kind != METHODS or row.mistake != NONE or not measure.speaks:
            continue
        if method not in names or row.better in ("", method):
            continue
        sign = 1.0 if row.first == method else -1.0
        ends = sorted((sign * row.low, sign * row.high))
        found.append(
            Loss(
                measure.aim,
                row.measure,
                row.scenario,
                row.better,
                sign * row.difference,
                *ends,
            )
        )
    return found
