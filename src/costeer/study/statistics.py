"""All statistics of a study: two sets of tests side by side, Sec. III-F.

*As published* pools all values and counts each as independent; *within subjects*
compares each participant with himself or herself. `docs/statistics.md` explains both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from costeer.study.cells import (
    CONDITION,
    STRENGTH,
    Observations,
    Roster,
    Table,
    labels,
    levels,
    observations,
    roster,
)
from costeer.study.dropped import dropped_cells, dropped_lane_changes
from costeer.study.factorial import (
    Design,
    compared_pairs,
    one_way_design,
    two_way_design,
)
from costeer.study.outcome import (
    DroppedRow,
    EffectRow,
    PairRow,
    StudyTests,
    SummaryRow,
)
from costeer.study.published import published_effects, published_pairs
from costeer.study.summaries import summaries
from costeer.study.within import within_effects, within_pairs


class Measure(NamedTuple):
    """A measure to test.

    Attributes:
        name: Its column.
        per_lane_change: Whether it is in `lane_changes.csv`; else in `trials.csv`.
        by_strength: Whether it is of lane keeping, in which the duration of a lane
            change has no part: then the strengths are compared with manual and each
            other, in place of strength x change duration.
    """

    name: str
    per_lane_change: bool = False
    by_strength: bool = False


MEASURES: tuple[Measure, ...] = (
    Measure("sdlp", by_strength=True),
    Measure("swrr", by_strength=True),
    Measure("driver_torque_rms"),
    Measure("overshoot", per_lane_change=True),
    Measure("steering_velocity_rms", per_lane_change=True),
    Measure("peak_steering_angle", per_lane_change=True),
    Measure("duration", per_lane_change=True),
)


def study_tests(
    trials: Table, lane_changes: Table, measures: Sequence[Measure] = MEASURES
) -> StudyTests:
    """Return all tests, pairs, summaries and dropped data of a study.

    Args:
        trials: Columns of `trials.csv`: `participant`, `condition` and measures; one
            row per participant and condition.
        lane_changes: Columns of `lane_changes.csv`: `participant`, `condition`,
            `index` and measures; may be without columns if there are none.
        measures: What to test. A measure that has no column or no value gives rows
            that say so.

    Raises:
        ValueError: If there is no trial, a trial comes twice, a condition is unknown,
            or a column that names rows is missing.
    """
    everyone = roster((trials, lane_changes))
    _check_trials(trials)
    tests: list[EffectRow] = []
    pairs: list[PairRow] = []
    means: list[SummaryRow] = []
    dropped: list[DroppedRow] = []
    for measure in measures:
        table = lane_changes if measure.per_lane_change else trials
        observed = observations(table, measure.name)
        tests += _effects(measure, observed, everyone)
        pairs += _pairs(measure, observed, everyone)
        means += summaries(measure.name, observed, everyone)
        if measure.per_lane_change:
            dropped += dropped_lane_changes(table, measure.name)
        dropped += dropped_cells(measure.name, measure.by_strength, observed, everyone)
    return StudyTests(tuple(tests), tuple(pairs), tuple(means), tuple(dropped))


def _effects(
    measure: Measure, observed: Observations, everyone: Roster
) -> Iterator[EffectRow]:
    for design in _designs(measure, observed, everyone):
        yield from published_effects(measure.name, observed, design)
        yield from within_effects(measure.name, observed, design, everyone.participants)


def _designs(
    measure: Measure, observed: Observations, everyone: Roster
) -> Iterator[Design]:
    """Yield the conditions that have values; then strengths, or both factors."""
    seen = set(np.unique(observed.conditions).tolist())
    with_values = tuple(name for name in everyone.conditions if name in seen)
    without = tuple(name for name in everyone.conditions if name not in seen)
    note = f"no value in {', '.join(without)}" if without else ""
    yield one_way_design(CONDITION, with_values, note)
    if measure.by_strength:
        yield one_way_design(STRENGTH, levels(with_values, STRENGTH), note)
    else:
        yield two_way_design(everyone.conditions)


def _pairs(
    measure: Measure, observed: Observations, everyone: Roster
) -> Iterator[PairRow]:
    factors = (CONDITION, STRENGTH) if measure.by_strength else (CONDITION,)
    for factor in factors:
        pairs = compared_pairs(factor, levels(everyone.conditions, factor))
        yield from published_pairs(measure.name, observed, factor, pairs)
        yield from within_pairs(
            measure.name, observed, factor, pairs, everyone.participants
        )


def _check_trials(trials: Table) -> None:
    who, where = labels(trials, "participant"), labels(trials, CONDITION)
    if who.size == 0:
        raise ValueError("no trial; a study needs at least one row in trials.csv")
    cells = list(zip(who.tolist(), where.tolist(), strict=True))
    twice = sorted({cell for cell in cells if cells.count(cell) > 1})
    if twice:
        participant, condition = twice[0]
        raise ValueError(
            f"participant {participant} has {condition} twice in the trials; "
            "keep one row per participant and condition"
        )
