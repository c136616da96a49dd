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
from costeer.comparison.effects import METHODS, EffectRow
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
        num_ranked: Methods that were compared.
        not_ranked: Those that were not, separated by "; ": trials of theirs failed, or
            half of the drivers have no value.
    """

    aim: str
    measure: str
    scenario: str
    mistake: str
    verdict: str
    best: str
    mean: float
    tied: str
    num_ranked: int
    not_ranked: str


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
    better = {
        (row.measure, row.scenario, row.mistake, row.first, row.second): row.better
        for row in effects
        if row.kind == METHODS
    }
    return [
        _winner(results, better, each, scenario, mistake)
        for each in RANKED
        for scenario in results.scenarios
        for mistake in results.mistakes
    ]


def _winner(
    results: Results,
    better: dict[tuple[str, str, str, str, str], str],
    measure: Criterion,
    scenario: str,
    mistake: str,
) -> WinnerRow:
    means = _ranked(results, measure.name, scenario, mistake)
    there = [m for m in results.methods if (scenario, mistake, m) in results.values]
    named = measure.aim, measure.name, scenario, mistake
    out = "; ".join(name for name in there if name not in means)
    if len(means) < 2:
        return WinnerRow(*named, NOBODY, "", math.nan, "", len(means), out)
    best = max(means, key=lambda name: measure.better * means[name])
    where = measure.name, scenario, mistake
    tied = [
        name
        for name in means
        if name != best
        and best
        not in (better.get((*where, best, name)), better.get((*where, name, best)))
    ]
    return WinnerRow(
        *named,
        verdict=TIE if tied else WINNER,
        best=best,
        mean=means[best],
        tied="; ".join(tied),
        num_ranked=len(means),
        not_ranked=out,
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
