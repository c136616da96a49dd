"""Conditions that people drove more than once: each later trial beside the first."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from costeer.study.cells import CONDITION, observations
from costeer.study.outcome import PairRow
from costeer.study.people import People, natural
from costeer.study.statistics import Measure
from costeer.study.within import within_pairs


def again_pairs(
    people: People,
    trials: pd.DataFrame,
    lane_changes: pd.DataFrame,
    measures: Sequence[Measure],
) -> tuple[PairRow, ...]:
    """Paired t tests of trials that were driven again against the first of each.

    Corrected over the comparisons of a measure. Levels are labels of trials.

    Args:
        people: Who drove.
        trials: All rows of `trials.csv`.
        lane_changes: All rows of `lane_changes.csv`.
        measures: That are compared.
    """
    firsts = {each.condition: each.label for each in people.drives}
    later = sorted({(e.occasion, e.condition, e.label) for e in people.again})
    pairs = [(label, firsts[name]) for _, name, label in later if name in firsts]
    if not pairs:
        return ()
    names = {each.participant for each in (*people.drives, *people.again)}
    participants = sorted(names, key=natural)
    labels = {each.label for each in (*people.drives, *people.again)}
    found: list[PairRow] = []
    for measure in measures:
        table = lane_changes if measure.per_lane_change else trials
        if table.empty or measure.name not in table:
            continue
        own = table[table["label"].isin(labels)]
        observed = observations(own.assign(condition=own["label"]), measure.name)
        found += within_pairs(measure.name, observed, CONDITION, pairs, participants)
    return tuple(found)
