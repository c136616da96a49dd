"""The tests as the paper prints them: values pooled, each counted as independent."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from costeer.study.anova import pooled_f_tests
from costeer.study.cells import Observations, level_indices
from costeer.study.factorial import Design
from costeer.study.outcome import PUBLISHED, EffectRow, PairRow
from costeer.study.rows import About, PairTest, effect_row, joined, pair_rows
from costeer.study.ttests import independent_t_test


def published_effects(
    measure: str, observed: Observations, design: Design
) -> Iterator[EffectRow]:
    """Yield a row per effect of a design.

    Args:
        measure: Name of the measure.
        observed: Its values.
        design: Cells and effects.
    """
    cells = level_indices(observed, design.factor, design.cells)
    kept = cells >= 0
    tests = pooled_f_tests(observed.values[kept], cells[kept], design.effects)
    counts = np.bincount(cells[kept], minlength=len(design.cells))
    empty = [name for name, n in zip(design.cells, counts, strict=True) if n == 0]
    note = joined(
        design.note,
        "type III sums of squares" if len(design.effects) > 1 else "",
        f"no value in {', '.join(empty)}" if empty else "",
    )
    about = About(measure, PUBLISHED, int(counts.sum()), note)
    for effect, test in zip(design.effects, tests, strict=True):
        yield effect_row(about, effect.name, test)


def published_pairs(
    measure: str,
    observed: Observations,
    factor: str,
    pairs: Sequence[tuple[str, str]],
) -> tuple[PairRow, ...]:
    """Return independent t tests, corrected over the pairs of the measure.

    Args:
        measure: Name of the measure.
        observed: Its values.
        factor: `condition` or `strength`.
        pairs: Levels of the factor to compare, each first minus second.
    """
    comparisons = []
    for pair in pairs:
        cells = level_indices(observed, factor, pair)
        first, second = observed.values[cells == 0], observed.values[cells == 1]
        test = independent_t_test(first, second)
        comparisons.append(PairTest(*pair, test, first.size, second.size))
    return pair_rows(measure, PUBLISHED, comparisons)
