from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.answers import answer_tests
from costeer.study.outcome import StudyTests
from tests.study.made_up_study import Columns

ITEMS = ("mental", "effort", "frustration")


def made_up_answers(num_participants: int = 12) -> Columns:
    """Answers from 0 to 100 in steps of 5; each condition is harder than the last."""
    rng = np.random.default_rng(1)
    who, where, item = (
        each.ravel() for each in np.indices((num_participants, 7, len(ITEMS)))
    )
    person = rng.normal(0.0, 10.0, num_participants)[who]
    values = 40.0 + person + 5.0 * where + rng.normal(0.0, 10.0, who.size)
    return {
        "participant": who + 1,
        "condition": np.array(CONDITION_NAMES)[where],
        "item": np.array(ITEMS)[item],
        "value": np.clip(5.0 * np.round(values / 5.0), 0.0, 100.0),
    }


def rows(found: StudyTests, item: str, analysis: str) -> list[Any]:
    """Rows of tests and pairs of an item in an analysis."""
    return [row for row in (*found.tests, *found.pairs) if row[:2] == (item, analysis)]


def test_every_item_has_both_kinds_of_tests_and_six_pairs() -> None:
    found = answer_tests(made_up_answers(), total="tlx_raw")
    for item in (*ITEMS, "tlx_raw"):
        (within,) = (row for row in found.tests if row[:2] == (item, "within"))
        (friedman,) = (row for row in found.tests if row[:2] == (item, "friedman"))
        assert (within.df1, within.df2, within.n) == (6.0, 66.0, 12)
        assert (friedman.df1, friedman.n) == (6.0, 12)
        assert max(within.p_corrected, friedman.p_corrected) < 0.001
        for analysis in ("within", "wilcoxon"):
            pairs = [row for row in found.pairs if row[:2] == (item, analysis)]
            compared = [(pair.first, pair.second) for pair in pairs]
            assert compared == [(name, "manual") for name in CONDITION_NAMES[1:]]
            assert all(pair.p_corrected >= pair.p for pair in pairs)
            assert pairs[-1].mean_difference > 0.0
            assert pairs[-1].effect_size > 0.5
    assert not found.dropped
    assert all(row.note for row in found.tests if math.isnan(row.df2))


def test_total_is_the_mean_of_the_items() -> None:
    answers = made_up_answers()
    found = answer_tests(answers, total="tlx_raw")
    manual = answers["condition"] == "manual"
    (row,) = (
        row
        for row in found.summaries
        if row[:4] == ("tlx_raw", "within", "condition", "manual")
    )
    mean = answers["value"][manual].astype(float).mean()
    assert row.mean == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize("how", ["no row", "no value"])
def test_missing_answer_is_named_with_its_total(how: str) -> None:
    answers = made_up_answers()
    gone = (
        (answers["participant"] == 3)
        & (answers["condition"] == "weak-rapid")
        & (answers["item"] == "effort")
    )
    if how == "no row":
        answers = {name: column[~gone] for name, column in answers.items()}
    else:
        values = answers["value"].astype(float)
        answers["value"] = np.where(gone, np.nan, values)
    found = answer_tests(answers, total="tlx_raw")
    named = [row[:3] for row in found.dropped]
    assert named == [("effort", "3", "weak-rapid"), ("tlx_raw", "3", "weak-rapid")]
    for item in ("effort", "tlx_raw"):
        for analysis in ("within", "friedman"):
            row = rows(found, item, analysis)[0]
            assert row.n == 11
            assert "left out: 3 (no weak-rapid)" in row.note
        (mixed,) = rows(found, item, "mixed")
        assert (mixed.n, mixed.df2) == (12, 65.0)
        lacking = [
            row
            for analysis in ("within", "wilcoxon")
            for row in rows(found, item, analysis)
            if row[2] == "weak-rapid"
        ]
        assert [row.n_first for row in lacking] == [11, 11]
        assert all("left out: 3" in row.note for row in lacking)
    assert rows(found, "mental", "friedman")[0].n == 12


def test_condition_without_any_answer_to_an_item_is_named() -> None:
    answers = made_up_answers()
    asked = (answers["condition"] != "manual") | (answers["item"] != "effort")
    answers = {name: column[asked] for name, column in answers.items()}
    found = answer_tests(answers)
    (friedman,) = rows(found, "effort", "friedman")
    assert (friedman.df1, friedman.n) == (5.0, 12)
    assert "no value in manual" in friedman.note
    assert all(
        math.isnan(row.p) and row.note for row in rows(found, "effort", "wilcoxon")
    )
    assert ("effort", "all", "manual") in [row[:3] for row in found.dropped]


@pytest.mark.slow
def test_names_of_conditions_may_be_others_and_all_pairs_compared() -> None:
    answers = made_up_answers(5)
    names = {name: str(number) for number, name in enumerate(CONDITION_NAMES)}
    answers["condition"] = np.array([names[one] for one in answers["condition"]])
    found = answer_tests(answers, conditions=tuple("0123456789"), reference=None)
    assert len(rows(found, "mental", "wilcoxon")) == 21
    usual = answer_tests(made_up_answers(5), reference=None)
    assert [row.p for row in found.tests] == [row.p for row in usual.tests]


def test_first_answers_of_a_study_are_tested_as_far_as_they_go() -> None:
    answers = made_up_answers(1)
    first = {name: column[: len(ITEMS)] for name, column in answers.items()}
    for table in (answers, first):
        found = answer_tests(table)
        assert all(math.isnan(row.p) and row.note for row in found.tests)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"condition": "weak"}, "unknown condition 'weak'; choose manual"),
        ({"value": "much"}, "holds no numbers"),
        ({"participant": "2"}, "participant 2 has two answers to mental in manual"),
    ],
)
def test_wrong_answer_is_refused(change: dict[str, str], reason: str) -> None:
    answers = {
        name: column.astype(object) for name, column in made_up_answers().items()
    }
    for name, value in change.items():
        answers[name][0] = value
    with pytest.raises(ValueError, match=reason):
        answer_tests(answers)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ({"reference": "by hand"}, "unknown reference 'by hand'"),
        ({"total": "effort"}, "there is an item 'effort'"),
    ],
)
def test_wrong_wish_is_refused(words: dict[str, str], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        answer_tests(made_up_answers(), **words)  # type: ignore[arg-type]  # names by text


@pytest.mark.parametrize("name", ["participant", "item", "value"])
def test_missing_column_is_named(name: str) -> None:
    answers = made_up_answers()
    del answers[name]
    with pytest.raises(ValueError, match=f"no column '{name}'"):
        answer_tests(answers)
    with pytest.raises(ValueError, match="no answer"):
        answer_tests({})
