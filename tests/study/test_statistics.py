from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.outcome import EffectRow, PairRow, StudyTests
from costeer.study.statistics import MEASURES, study_tests
from tests.study.made_up_study import (
    CHANGE_MEASURES,
    TRIAL_MEASURES,
    Columns,
    made_up_study,
    usual_outcome,
    without,
)


def only(
    measure: str, conditions: Sequence[str] = CONDITION_NAMES
) -> tuple[Columns, Columns]:
    """The usual study with one measure alone, which takes a fifth of the time."""
    others = {*TRIAL_MEASURES, *CHANGE_MEASURES} - {measure}
    trials, changes = (
        {name: column for name, column in table.items() if name not in others}
        for table in made_up_study(conditions=conditions)
    )
    return trials, changes


def effect(
    found: StudyTests, measure: str, analysis: str, name: str = "condition"
) -> EffectRow:
    (row,) = (row for row in found.tests if row[:3] == (measure, analysis, name))
    return row


def pair(
    found: StudyTests, measure: str, analysis: str, first: str, second: str = "manual"
) -> PairRow:
    (row,) = (
        row for row in found.pairs if row[:4] == (measure, analysis, first, second)
    )
    return row


def silent_gaps(found: StudyTests) -> list[object]:
    """Rows with an undefined number and no word on it."""
    rows: Iterable[EffectRow | PairRow] = (*found.tests, *found.pairs)
    tables = [*rows, *found.summaries]
    return [
        row
        for row in tables
        if any(isinstance(cell, float) and math.isnan(cell) for cell in row)
        and not row.note
    ]


@pytest.mark.slow
def test_degrees_of_freedom_are_those_of_the_paper() -> None:
    trials, changes = made_up_study()
    everything = usual_outcome()
    torque = effect(everything, "driver_torque_rms", "published")
    assert (torque.df1, torque.df2, torque.n) == (6.0, 77.0, 84)
    # 672 planned, 13 short: F(6, 652); 11 of them with guidance: F(2, 559).
    lost = np.zeros(672, dtype=bool)
    lost[[0, 1]] = True
    lost[np.flatnonzero(changes["condition"] == "weak-gentle")[:88:8]] = True
    found = study_tests(trials, without(changes, lost))
    condition = effect(found, "overshoot", "published")
    duration = effect(found, "overshoot", "published", "change_duration")
    assert (condition.df1, condition.df2, condition.n) == (6.0, 652.0, 659)
    assert (duration.df1, duration.df2, duration.n) == (2.0, 559.0, 565)
    within = effect(found, "overshoot", "within")
    assert (within.df1, within.df2, within.n) == (6.0, 66.0, 12)


def test_every_measure_has_both_sets_of_tests() -> None:
    found = usual_outcome()
    keys = [row[:3] for row in found.tests]
    assert len(keys) == len(set(keys))
    for measure in MEASURES:
        second = ["strength"]
        if not measure.by_strength:
            second += ["change_duration", "strength:change_duration"]
        for analysis in ("published", "within"):
            expected = {(measure.name, analysis, n) for n in ["condition", *second]}
            assert expected == {
                key for key in keys if key[:2] == (measure[0], analysis)
            }
    num_pairs = {
        measure.name: sum(row.measure == measure.name for row in found.pairs)
        for measure in MEASURES
    }
    # Six against manual in both sets; of lane keeping also three pairs of strengths.
    assert num_pairs == {m.name: 18 if m.by_strength else 12 for m in MEASURES}
    assert not found.dropped
    assert not silent_gaps(found)


def test_published_comparison_is_that_of_scipy_on_all_values() -> None:
    _, changes = made_up_study()
    found = usual_outcome()
    values = {
        name: changes["overshoot"][changes["condition"] == name].astype(float)
        for name in CONDITION_NAMES
    }
    row = effect(found, "overshoot", "published")
    expected = stats.f_oneway(*values.values())
    assert row.statistic == pytest.approx(expected.statistic, rel=1e-12)
    assert row.p_corrected == row.p == pytest.approx(expected.pvalue, rel=1e-9)
    p = [
        stats.ttest_ind(values[n], values["manual"]).pvalue for n in CONDITION_NAMES[1:]
    ]
    corrected = stats.false_discovery_control(p)
    rows = [pair(found, "overshoot", "published", n) for n in CONDITION_NAMES[1:]]
    np.testing.assert_allclose([row.p_corrected for row in rows], corrected, rtol=1e-9)
    difference = values["weak-gentle"].mean() - values["manual"].mean()
    assert rows[-1].mean_difference == pytest.approx(difference, rel=1e-12)
    assert rows[-1].low < difference < rows[-1].high
    assert (rows[-1].n_first, rows[-1].n_second) == (96, 96)


def test_within_comparison_is_that_of_scipy_on_participants_means() -> None:
    _, changes = made_up_study()
    found = usual_outcome()
    means = (
        pd.DataFrame(changes).groupby(["condition", "participant"])["overshoot"].mean()
    )
    p = [stats.ttest_rel(means[n], means["manual"]).pvalue for n in CONDITION_NAMES[1:]]
    rows = [pair(found, "overshoot", "within", name) for name in CONDITION_NAMES[1:]]
    np.testing.assert_allclose([row.p for row in rows], p, rtol=1e-9)
    corrected = stats.false_discovery_control(p)
    np.testing.assert_allclose([row.p_corrected for row in rows], corrected, rtol=1e-9)
    assert {row.n_first for row in rows} == {12}


def test_strength_of_lane_keeping_is_compared_in_three_pairs() -> None:
    trials, _ = made_up_study()
    found = usual_outcome()
    strong = np.char.startswith(trials["condition"].astype(str), "strong")
    manual = trials["condition"] == "manual"
    expected = stats.ttest_ind(
        trials["sdlp"][strong].astype(float), trials["sdlp"][manual].astype(float)
    )
    row = pair(found, "sdlp", "published", "strong")
    assert row.p == pytest.approx(expected.pvalue, rel=1e-9)
    assert (row.n_first, row.n_second) == (36, 12)
    assert pair(found, "sdlp", "within", "strong", "weak").n_first == 12
    test = effect(found, "sdlp", "published", "strength")
    assert (test.df1, test.df2) == (2.0, 81.0)
    assert effect(found, "sdlp", "within", "strength").df2 == 22.0


def numbers(found: StudyTests) -> list[float]:
    tables = (found.tests, found.pairs, found.summaries)
    cells = (cell for table in tables for row in table for cell in row)
    return [float(cell) for cell in cells if isinstance(cell, int | float)]


@pytest.mark.slow
def test_order_of_rows_and_names_of_participants_change_nothing() -> None:
    rng = np.random.default_rng(1)
    changed = []
    for table in made_up_study():
        order = rng.permutation(table["participant"].size)
        shuffled = {name: column[order] for name, column in table.items()}
        names = [f"P{97 * int(n) % 13}" for n in shuffled["participant"]]
        changed.append({**shuffled, "participant": np.array(names)})
    # Sums in another order differ in the last digits; limits come from a root search.
    np.testing.assert_allclose(
        numbers(study_tests(*changed)), numbers(usual_outcome()), rtol=1e-8, atol=1e-12
    )


@pytest.mark.slow
@pytest.mark.parametrize("scale", [math.pi / 180.0, 1e3])
def test_unit_of_a_measure_does_not_change_its_tests(scale: float) -> None:
    trials, changes = made_up_study()
    scaled = {**changes, "overshoot": changes["overshoot"].astype(float) * scale}
    one, other = usual_outcome(), study_tests(trials, scaled)
    for name in ("condition", "strength", "strength:change_duration"):
        for analysis in ("published", "within"):
            before = effect(one, "overshoot", analysis, name)
            after = effect(other, "overshoot", analysis, name)
            assert after[3:9] == pytest.approx(before[3:9], rel=1e-8)
    before_pair = pair(one, "overshoot", "within", "weak-rapid")
    after_pair = pair(other, "overshoot", "within", "weak-rapid")
    assert after_pair.p == pytest.approx(before_pair.p, rel=1e-8)
    assert after_pair.low == pytest.approx(before_pair.low * scale, rel=1e-8)


def test_missing_trial_is_named_and_left_out_where_it_is_needed() -> None:
    trials, changes = only("sdlp")
    gone = (trials["participant"] == 3) & (trials["condition"] == "strong-rapid")
    trials["sdlp"] = np.where(gone, np.nan, trials["sdlp"].astype(float))
    found = study_tests(trials, changes)
    (row,) = (row for row in found.dropped if row.measure == "sdlp")
    assert row[:3] == ("sdlp", "3", "strong-rapid")
    within = effect(found, "sdlp", "within")
    assert (within.n, within.df2) == (11, 60.0)
    assert within.note == "left out: 3 (no strong-rapid)"
    mixed = effect(found, "sdlp", "mixed")
    assert (mixed.n, mixed.df2, mixed.note) == (12, 65.0, "83 of 84 cells")
    assert pair(found, "sdlp", "within", "strong-rapid").n_first == 11
    assert pair(found, "sdlp", "within", "strong-rapid").note.startswith("left out: 3 ")
    assert pair(found, "sdlp", "within", "weak-rapid").n_first == 12
    # Two other trials of that strength are there, and the reason says so.
    assert effect(found, "sdlp", "within", "strength").n == 12
    assert "mean of this strength" in row.reason


def test_lane_change_without_a_value_is_named() -> None:
    trials, changes = only("overshoot")
    overshoot = changes["overshoot"].astype(float)
    overshoot[9] = np.nan
    found = study_tests(trials, {**changes, "overshoot": overshoot})
    (row,) = (row for row in found.dropped if row.measure == "overshoot")
    assert row[:3] == ("overshoot", "1", "strong-rapid lane change 1")
    assert effect(found, "overshoot", "published").n == 671
    assert effect(found, "overshoot", "within").n == 12


def test_condition_that_nobody_drove_to_the_end_is_left_out_and_named() -> None:
    trials, changes = only("overshoot")
    kept = without(changes, changes["condition"] == "weak-gentle")
    found = study_tests(trials, kept)
    condition = effect(found, "overshoot", "within")
    assert (condition.df1, condition.n) == (5.0, 12)
    assert condition.note == "no value in weak-gentle"
    both = effect(found, "overshoot", "published", "strength")
    assert math.isnan(both.statistic)
    assert "a cell is empty" in both.note
    assert "no value in weak-gentle" in both.note
    assert any(row.cell == "weak-gentle" for row in found.dropped)
    assert not silent_gaps(found)


def test_column_that_is_not_there_gives_a_reason() -> None:
    trials, changes = made_up_study(3)
    del trials["swrr"]
    found = study_tests(trials, changes)
    assert math.isnan(effect(found, "swrr", "published").statistic)
    assert [row[:3] for row in found.dropped] == [("swrr", "all", "all")]
    assert not silent_gaps(found)


def test_study_without_lane_changes_still_has_its_trials_tested() -> None:
    trials, _ = made_up_study()
    found = study_tests(trials, {})
    assert math.isfinite(effect(found, "sdlp", "published").p)
    assert math.isnan(effect(found, "overshoot", "published").p)
    assert not silent_gaps(found)


@pytest.mark.parametrize(
    "conditions",
    [
        ("manual",),
        ("strong-normal",),
        ("manual", "strong-normal"),
        ("strong-rapid", "strong-normal", "strong-gentle"),
        ("manual", "strong-rapid", "weak-normal"),
    ],
)
@pytest.mark.parametrize(
    "num_participants", [1, 2, pytest.param(3, marks=pytest.mark.slow)]
)
def test_small_studies_work_with_what_they_have(
    conditions: tuple[str, ...], num_participants: int
) -> None:
    found = study_tests(*made_up_study(num_participants, conditions))
    assert not silent_gaps(found)
    enough = num_participants > 1 and len(conditions) > 1
    assert math.isfinite(effect(found, "overshoot", "within").p) == enough


def test_missing_cell_of_one_strength_leaves_durations_to_the_mixed_model() -> None:
    trials, changes = only("overshoot", CONDITION_NAMES[:4])
    gone = (changes["participant"] == 3) & (changes["condition"] == "strong-rapid")
    found = study_tests(trials, without(changes, gone))
    assert effect(found, "overshoot", "mixed", "change_duration").df1 == 2.0
    strength = effect(found, "overshoot", "mixed", "strength")
    assert strength.note.startswith("fewer than two levels")


def test_one_strength_still_has_its_durations_compared() -> None:
    found = study_tests(*only("overshoot", CONDITION_NAMES[:4]))
    assert effect(found, "overshoot", "within", "change_duration").df1 == 2.0
    strength = effect(found, "overshoot", "within", "strength")
    assert strength.note.startswith("fewer than two levels")


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0), st.sampled_from([0.0, 0.1, 1e6]))
@settings(max_examples=15)
def test_no_gap_is_silent_whatever_is_missing(
    seed: int, share: float, spread: float
) -> None:
    rng = np.random.default_rng(seed)
    trials, changes = made_up_study(4, num_changes=2, seed=seed)
    tables: list[Columns] = []
    for table in (trials, changes):
        rows = table["participant"].size
        for measure in set(table) & {m.name for m in MEASURES}:
            values = 0.3 + spread * rng.normal(size=rows).round(1)
            values[rng.random(rows) < share] = rng.choice([np.nan, np.inf])
            table[measure] = values
        tables.append(without(table, rng.random(rows) < share / 2.0))
    if tables[0]["participant"].size == 0:
        return
    found = study_tests(*tables)
    assert not silent_gaps(found)
    assert not any(math.isinf(number) for number in numbers(found))


def test_masked_entry_is_a_missing_one() -> None:
    trials, changes = only("sdlp")
    values = np.ma.masked_array(trials["sdlp"].astype(float))
    values[0] = np.ma.masked
    found = study_tests({**trials, "sdlp": values}, changes)
    assert effect(found, "sdlp", "published").n == 83


@pytest.mark.slow
def test_data_frames_and_lists_give_the_same_as_arrays() -> None:
    tables = made_up_study(3)
    trials = pd.DataFrame(tables[0])
    changes = {name: column.tolist() for name, column in tables[1].items()}
    found = study_tests(trials, changes)  # type: ignore[arg-type]  # pandas has no stubs
    assert repr(found) == repr(study_tests(*tables))


def twice(trials: Columns) -> Columns:
    return {name: np.append(column, column[-1:]) for name, column in trials.items()}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: {**t, "condition": np.full(84, "sporty")}, "unknown condition"),
        (lambda t: {k: v for k, v in t.items() if k != "participant"}, "no column"),
        (lambda t: {**t, "sdlp": np.full(84, "wide")}, "holds no numbers"),
        (lambda t: {**t, "sdlp": np.ones(3)}, "differ in length"),
        (lambda t: {k: v[:0] for k, v in t.items()}, "no trial"),
        (twice, "participant 12 has weak-gentle twice"),
    ],
)
def test_tables_that_make_no_sense_are_refused(
    change: Callable[[Columns], Columns], message: str
) -> None:
    trials, changes = made_up_study()
    with pytest.raises(ValueError, match=message):
        study_tests(change(trials), changes)
