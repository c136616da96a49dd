"""Tests of what people answer: one questionnaire after each condition, in long form."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from costeer.methods.conditions import CONDITION_NAMES, MANUAL
from costeer.study.cells import (
    CONDITION,
    Labels,
    Observations,
    Roster,
    Table,
    labels,
    numbers,
    numbers_first,
    participant_means,
)
from costeer.study.dropped import dropped_cells
from costeer.study.factorial import one_way_design
from costeer.study.outcome import (
    FRIEDMAN,
    WILCOXON,
    EffectRow,
    PairRow,
    StudyTests,
)
from costeer.study.ranks import friedman_test, wilcoxon_test
from costeer.study.rows import About, PairTest, friedman_row, joined, pair_rows
from costeer.study.summaries import summaries
from costeer.study.ttests import TTest, mean_or_nan
from costeer.study.within import left_out, within_effects, within_pairs

COLUMNS = ("participant", CONDITION, "item", "value")


def answer_tests(
    answers: Table,
    conditions: Sequence[str] = CONDITION_NAMES,
    reference: str | None = MANUAL,
    total: str = "",
) -> StudyTests:
    """Compare conditions by every item: analysis of variance, and Friedman's test.

    Each item gets a repeated-measures analysis of variance, a mixed model where a cell
    is missing, paired t tests, Friedman's test and signed-rank tests; pairs are
    corrected by Benjamini-Hochberg over the pairs of an item and analysis. Single items
    are ordinal: read their ranks (`friedman`, `wilcoxon`). A total of several items is
    a number: read `within`.

    Args:
        answers: Columns `participant`, `condition`, `item` and `value`, one row per
            answer. An answer without a row or without a value is missing, and named.
        conditions: All there may be, in their order; those with no row are left out.
        reference: What every other condition is compared with; None compares all pairs.
        total: Name of one more item, the mean of all others where all are answered (raw
            NASA-TLX); empty for none.

    Raises:
        ValueError: If there is no answer, a column is missing, a value is no number, a
            condition or the reference is unknown, an answer is given twice, or an item
            bears the name of the total.
    """
    if reference is not None and reference not in conditions:
        raise ValueError(
            f"unknown reference {reference!r}; choose {', '.join(conditions)}, or None "
            "for all pairs"
        )
    given = _given(answers)
    everyone = _everyone(given, conditions)
    values = _by_item(given, everyone, total)
    pairs = _pairs(everyone.conditions, reference)
    found = StudyTests((), (), (), ())
    for item, observed in values.items():
        found = StudyTests(
            (*found.tests, *_effects(item, observed, everyone)),
            (*found.pairs, *_item_pairs(item, observed, everyone, pairs)),
            (*found.summaries, *summaries(item, observed, everyone, (CONDITION,))),
            (*found.dropped, *dropped_cells(item, False, observed, everyone)),
        )
    return found


Given = tuple[Labels, Labels, Labels, NDArray[np.float64]]
"""Participant, condition, item and value of every answer."""


def _given(answers: Table) -> Given:
    who, where, item = (labels(answers, name) for name in COLUMNS[:3])
    if who.size == 0:
        raise ValueError("no answer; give at least one row")
    if "value" not in answers:
        raise ValueError(f"no column 'value'; there are {', '.join(answers)}")
    values = numbers(answers, "value")
    lengths = {each.size for each in (who, where, item, values)}
    if len(lengths) > 1:
        raise ValueError(f"columns differ in length: {sorted(lengths)}")
    cells = list(zip(who.tolist(), where.tolist(), item.tolist(), strict=True))
    once: set[tuple[str, str, str]] = set()
    for cell in cells:
        if cell in once:
            raise ValueError(
                f"participant {cell[0]} has two answers to {cell[2]} in {cell[1]}; "
                "keep one row per participant, condition and item"
            )
        once.add(cell)
    return who, where, item, values


def _everyone(given: Given, conditions: Sequence[str]) -> Roster:
    present = set(given[1].tolist())
    for name in sorted(present - set(conditions)):
        raise ValueError(f"unknown condition {name!r}; choose {', '.join(conditions)}")
    return Roster(
        participants=tuple(sorted(set(given[0].tolist()), key=numbers_first)),
        conditions=tuple(name for name in conditions if name in present),
    )


def _by_item(given: Given, everyone: Roster, total: str) -> dict[str, Observations]:
    """Finite values of each item in the order of the table, and of the total."""
    who, where, item, values = given
    found = {}
    for name in dict.fromkeys(item.tolist()):
        kept = (item == name) & np.isfinite(values)
        found[name] = Observations(who[kept], where[kept], values[kept])
    if total in found:
        raise ValueError(f"there is an item {total!r}; give the total another name")
    if total:
        found[total] = _total(list(found.values()), everyone)
    return found


def _total(items: Sequence[Observations], everyone: Roster) -> Observations:
    """Mean of the items in each cell where all of them are answered."""
    people, names = everyone
    means = np.mean(
        [participant_means(each, people, CONDITION, names) for each in items], axis=0
    )
    rows, columns = np.nonzero(np.isfinite(means))
    return Observations(
        np.array(people)[rows], np.array(names)[columns], means[rows, columns]
    )


def _pairs(names: Sequence[str], reference: str | None) -> tuple[tuple[str, str], ...]:
    if reference is None:
        return tuple(combinations(names, 2))
    return tuple((name, reference) for name in names if name != reference)


def _effects(
    item: str, observed: Observations, everyone: Roster
) -> Iterator[EffectRow]:
    people, names = everyone
    means = participant_means(observed, people, CONDITION, names)
    answered = np.isfinite(means).any(axis=0)
    cells = [names[column] for column in np.flatnonzero(answered).tolist()]
    without = [name for name in names if name not in cells]
    note = f"no value in {', '.join(without)}" if without else ""
    design = one_way_design(CONDITION, cells, note)
    yield from within_effects(item, observed, design, people)
    scores = means[:, answered]
    complete = np.isfinite(scores).all(axis=1)
    note = joined(note, left_out(scores, people, cells))
    about = About(item, FRIEDMAN, int(complete.sum()), note)
    yield friedman_row(about, CONDITION, friedman_test(scores[complete]))


def _item_pairs(
    item: str,
    observed: Observations,
    everyone: Roster,
    pairs: Sequence[tuple[str, str]],
) -> Iterator[PairRow]:
    people = everyone.participants
    yield from within_pairs(item, observed, CONDITION, pairs, people)
    comparisons = []
    for pair in pairs:
        means = participant_means(observed, people, CONDITION, pair)
        both = np.isfinite(means).all(axis=1)
        test = _signed_ranks(means[both, 0], means[both, 1])
        note = left_out(means, people, pair)
        num_pairs = int(both.sum())
        comparisons.append(PairTest(*pair, test, num_pairs, num_pairs, note))
    yield from pair_rows(item, WILCOXON, comparisons)


def _signed_ranks(first: NDArray[np.float64], second: NDArray[np.float64]) -> TTest:
    """Wilcoxon's test as the outcome of a comparison; it has no interval and no df."""
    test = wilcoxon_test(first, second)
    return TTest(
        mean_first=mean_or_nan(first),
        mean_second=mean_or_nan(second),
        statistic=test.statistic,
        p=test.p,
        effect_size=test.effect_size,
        note=joined("signed ranks, exact p", test.note),
    )
