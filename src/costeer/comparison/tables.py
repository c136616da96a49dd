"""Tables of the report on a comparison."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from costeer.comparison.criteria import RANKED, SPEAKING, Criterion, criterion
from costeer.comparison.effects import MISTAKES, NO_EVENTS, EffectRow, MeanRow
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results
from costeer.comparison.winners import NOBODY, TIE, Loss, WinnerRow
from costeer.comparison.words import speaking_title
from costeer.comparison.worst import WorstCase
from costeer.pages.numerals import NOTHING, interval, number, signed
from costeer.pages.tables import Table

NO_BREAK = "\u00a0"
MOST_NAMED = 3
"""Methods of a tie that are named in a cell; more are counted [-]."""


WINNERS_NOTE = (
    "Without mistakes. Below a winner: its difference to the method with the next best "
    "mean, with the 95 % interval of Student's t of paired differences. A tie names "
    "the method with the best mean first; no events: it happened to nobody."
)


def winners_table(results: Results, rows: Sequence[WinnerRow], speaking: bool) -> Table:
    """Winner or tie by measure and scenario, without a mistake.

    Args:
        results: For the order of scenarios.
        rows: All.
        speaking: Whether only measures that speak for an aim are told.
    """
    shown = SPEAKING if speaking else RANKED
    by_place = {(row.measure, row.scenario): row for row in rows if row.mistake == NONE}
    cells = [
        (
            f"{speaking_title(each.name) if speaking else each.title} [{each.unit}]",
            *(winner_text(by_place[each.name, s]) for s in results.scenarios),
        )
        for each in shown
    ]
    return Table(
        name="winners",
        title="Winners and ties in every measure",
        note=WINNERS_NOTE,
        header=("Aim" if speaking else "Measure", *results.scenarios),
        rows=tuple(cells),
        num_labels=1 + len(results.scenarios),
        prose=True,
    )


def winner_text(row: WinnerRow) -> str:
    """A winner and by how much, or who ties.

    As `tie: a, b`, `tie of 7: a first`, `tie of all 11`, `tie (no events)`.
    """
    if row.verdict == NOBODY:
        return NOTHING
    if row.note == NO_EVENTS:
        return f"tie ({NO_EVENTS})"
    if row.verdict != TIE:
        return f"{row.best} wins\n{_lead(row)}"
    names = [row.best, *row.tied.split("; ")]
    if len(names) == row.num_ranked > 2:
        return f"tie of all {len(names)}"
    if len(names) <= MOST_NAMED:
        return "tie: " + ",\n".join(names)
    return f"tie of {len(names)}:\n{row.best} first"


def _lead(row: WinnerRow) -> str:
    """By how much a winner is ahead of the next: difference, interval, of whom."""
    shown = criterion(row.measure)
    low, high = shown.factor * row.low, shown.factor * row.high
    by = signed(shown.factor * row.difference, shown.digits)
    between = interval(low, high, shown.digits).replace(" ", NO_BREAK)
    return f"{by}\n{between}\nto {row.second}"


def losses_table(found: Sequence[Loss]) -> Table:
    """Where the paper's method is shown to be worse, difference by difference."""
    cells = []
    for loss in found:
        shown = criterion(loss.measure)
        low, high = shown.factor * loss.low, shown.factor * loss.high
        cells.append(
            (
                speaking_title(loss.measure),
                loss.scenario,
                loss.winner,
                signed(shown.factor * loss.difference, shown.digits),
                interval(low, high, shown.digits),
                shown.unit,
            )
        )
    return Table(
        name="losses",
        title="Where the paper's method loses",
        note="Difference: ibhs minus the other, with its 95 % interval.",
        header=("Aim", "Scenario", "Loses to", "Difference", "95 % interval", "Unit"),
        rows=tuple(cells),
        num_labels=3,
        num_words=1,
    )


def means_table(results: Results, means: Sequence[MeanRow]) -> Table:
    """Means of the measures that speak for an aim, by scenario and method."""
    by_place = {(m.measure, m.scenario, m.mistake, m.method): m for m in means}
    cells = [
        (
            scenario,
            method,
            *(
                _mean_text(each, by_place[each.name, scenario, NONE, method])
                for each in SPEAKING
            ),
        )
        for scenario in results.scenarios
        for method in results.methods
        if (scenario, NONE, method) in results.values
    ]
    return Table(
        name="means",
        title="Means over drivers",
        note="With the half width of their 95 % intervals; a dash where no driver has "
        "a value, no events where nothing happened in any drive. means.csv has all "
        "measures.",
        header=(
            "Scenario",
            "Method",
            *(f"{each.title} [{each.unit}]" for each in SPEAKING),
        ),
        rows=tuple(cells),
        num_labels=2,
    )


def _mean_text(shown: Criterion, row: MeanRow) -> str:
    if shown.is_count and row.mean == 0.0:
        return NO_EVENTS  # none is negative
    mean = number(shown.factor * row.mean, shown.digits)
    half = shown.factor * (row.high - row.mean)
    return f"{mean} ± {number(half, shown.digits)}" if np.isfinite(half) else mean


def mistakes_table(results: Results, effects: Sequence[EffectRow]) -> Table:
    """What each mistake changes of each method, over all scenarios."""
    own = [row for row in effects if row.kind == MISTAKES]
    cells = []
    for mistake in results.mistakes:
        for method in results.methods:
            rows = [r for r in own if (r.first, r.method) == (mistake, method)]
            if rows:
                texts = (_change_text(each, rows) for each in SPEAKING)
                cells.append((mistake, method, *texts))
    return Table(
        name="mistakes-table",
        title="What mistakes change",
        note="With the mistake minus without, paired by driver: mean over scenarios; "
        "below, in how many scenarios that is shown to be worse or better. "
        "effects.csv has every scenario and measure with intervals.",
        header=(
            "Mistake",
            "Method",
            *(f"{each.title} [{each.unit}]" for each in SPEAKING),
        ),
        rows=tuple(cells),
        num_labels=2,
    )


def _change_text(shown: Criterion, rows: Sequence[EffectRow]) -> str:
    of_it = [row for row in rows if row.measure == shown.name]
    known = [row.difference for row in of_it if np.isfinite(row.difference)]
    if not known:
        return NOTHING
    if all(row.note == NO_EVENTS for row in of_it):
        return NO_EVENTS
    if not any(known):
        return "unchanged"
    worse = sum(row.better == NONE for row in of_it)
    better = sum(row.better == row.first for row in of_it)
    told = [f"worse in {worse}"] if worse else []
    told += [f"better in {better}"] if better else []
    mean = signed(shown.factor * float(np.mean(known)), shown.digits)
    return "\n".join([mean, *told])


def worst_table(cases: Sequence[WorstCase]) -> Table:
    """Records of the worst cases."""
    cells = [
        (
            each.method,
            each.scenario,
            each.mistake,
            str(each.participant),
            str(each.num_collisions),
            str(each.num_lane_departures),
            each.what,
            f"{each.time:.1f}",
            each.record,
        )
        for each in cases
    ]
    return Table(
        name="worst-table",
        title="Records of the worst cases",
        note="",
        header=(
            "Method",
            "Scenario",
            "Mistake",
            "Driver",
            "Collisions",
            "Departures",
            "First",
            "At [s]",
            "Record in worst/",
        ),
        rows=tuple(cells),
        num_labels=3,
        num_words=1,
    )


def compared_table(results: Results) -> Table:
    """The methods, their publications, and faults of their torque."""
    cells = [
        (
            name,
            str(each["version"]),
            str(results.faults.get(name, 0)),
            str(each["publication"]),
        )
        for name, each in results.configuration["methods"].items()
    ]
    return Table(
        name="compared",
        title="The methods",
        note="Torque faults: samples in which a method asked for a torque that is not "
        "finite or over the limit; the loop gives none, or the limit.",
        header=("Method", "Version", "Torque faults", "Source"),
        rows=tuple(cells),
        num_labels=2,
        num_words=1,
        prose=True,
    )


def exclusions_table(results: Results) -> Table:
    """Failed trials by reason, and combinations that contradict themselves."""
    reasons: dict[tuple[str, str, str, str], int] = {}
    for each in results.failures:
        key = each.method, each.scenario, each.mistake, each.reason
        reasons[key] = reasons.get(key, 0) + 1
    cells = [
        (method, scenario, mistake, f"{count} failed", reason)
        for (method, scenario, mistake, reason), count in reasons.items()
    ]
    cells += [
        (each.method, "all", each.mistake, "left out", each.reason)
        for each in results.left_out
    ]
    return Table(
        name="exclusions-table",
        title="Trials that failed, and combinations that were left out",
        note="exclusions.csv names every trial.",
        header=("Method", "Scenario", "Mistake", "What", "Reason"),
        rows=tuple(cells),
        num_labels=5,
        prose=True,
    )
