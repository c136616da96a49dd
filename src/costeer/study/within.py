"""The tests within subjects: each participant is compared with himself or herself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from costeer.study.cells import Observations, participant_means
from costeer.study.factorial import Design
from costeer.study.mixed import mixed_f_tests
from costeer.study.outcome import MIXED, WITHIN, EffectRow, PairRow
from costeer.study.repeated import repeated_f_test
from costeer.study.rows import About, PairTest, effect_row, joined, pair_rows
from costeer.study.ttests import paired_t_test

_MOST_NAMED = 6  # names that a note can hold; all are in `dropped.csv`


def within_effects(
    measure: str, observed: Observations, design: Design, participants: Sequence[str]
) -> Iterator[EffectRow]:
    """Yield a row per effect, and one more by a mixed model where cells are missing.

    Args:
        measure: Name of the measure.
        observed: Its values.
        design: Cells and effects.
        participants: Everyone who took part.
    """
    means = participant_means(observed, participants, design.factor, design.cells)
    complete = np.isfinite(means).all(axis=1)
    note = joined(design.note, left_out(means, participants, design.cells))
    about = About(measure, WITHIN, int(complete.sum()), note)
    for effect in design.effects:
        yield effect_row(about, effect.name, repeated_f_test(means[complete], effect))
    if complete.all() or not design.cells:
        return
    present = np.isfinite(means)
    note = joined(design.note, f"{present.sum()} of {present.size} cells")
    about = About(measure, MIXED, int(present.any(axis=1).sum()), note)
    tests = mixed_f_tests(means, design.effects)
    for effect, test in zip(design.effects, tests, strict=True):
        yield effect_row(about, effect.name, test)


def within_pairs(
    measure: str,
    observed: Observations,
    factor: str,
    pairs: Sequence[tuple[str, str]],
    participants: Sequence[str],
) -> tuple[PairRow, ...]:
    """Return paired t tests on participants' means, corrected over the pairs.

    Args:
        measure: Name of the measure.
        observed: Its values.
        factor: `condition` or `strength`.
        pairs: Levels of the factor to compare, each first minus second.
        participants: Everyone who took part.
    """
    comparisons = []
    for pair in pairs:
        means = participant_means(observed, participants, factor, pair)
        both = np.isfinite(means).all(axis=1)
        test = paired_t_test(means[both, 0], means[both, 1])
        num_pairs, note = int(both.sum()), left_out(means, participants, pair)
        comparisons.append(PairTest(*pair, test, num_pairs, num_pairs, note))
    return pair_rows(measure, WITHIN, comparisons)


def left_out(
    means: NDArray[np.float64], participants: Sequence[str], cells: Sequence[str]
) -> str:
    """Name the participants who lack a cell, and which they lack."""
    missing = ~np.isfinite(means)
    lacking = np.flatnonzero(missing.any(axis=1)).tolist()
    if not lacking:
        return ""
    if len(lacking) > _MOST_NAMED:
        return f"{len(lacking)} participants left out, named in dropped.csv"
    return "left out: " + ", ".join(
        f"{participants[row]} ({_named(missing[row], cells)})" for row in lacking
    )


def _named(missing: NDArray[np.bool_], cells: Sequence[str]) -> str:
    if missing.all():
        return "no cell at all"
    return "no " + ", ".join(
        cells[column] for column in np.flatnonzero(missing).tolist()
    )
