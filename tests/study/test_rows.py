from __future__ import annotations

import math

import pytest
from scipy import stats

from costeer.study.anova import FTest, no_f_test
from costeer.study.effects import EffectSize, partial_eta_squared
from costeer.study.rows import About, PairTest, effect_row, joined, pair_rows
from costeer.study.ttests import TTest

ABOUT = About("overshoot", "within", 12, "left out: 3 (no manual)")


def test_row_is_judged_by_the_p_value_after_the_correction() -> None:
    row = effect_row(ABOUT, "condition", FTest(2.6, 6.0, 66.0, epsilon=0.5))
    assert row.p == pytest.approx(stats.f.sf(2.6, 6.0, 66.0))
    assert row.p_corrected == pytest.approx(stats.f.sf(2.6, 3.0, 33.0))
    assert row.p < 0.05 < row.p_corrected
    assert row.mark == ""
    assert (row.df1, row.df2) == (6.0, 66.0)


def test_interval_of_the_effect_size_takes_the_corrected_degrees_of_freedom() -> None:
    row = effect_row(ABOUT, "condition", FTest(2.6, 6.0, 66.0, epsilon=0.5))
    expected = partial_eta_squared(2.6, 3.0, 33.0)
    assert row[10:14] == tuple(expected)
    # The estimate itself is the same whatever the correction.
    assert row.effect_size == pytest.approx(partial_eta_squared(2.6, 6.0, 66.0).value)


def test_reason_stands_before_what_else_is_to_be_known() -> None:
    row = effect_row(ABOUT, "condition", no_f_test("a cell is empty"))
    assert row.note == "a cell is empty; left out: 3 (no manual)"
    assert all(math.isnan(value) for value in (row.p, row.p_corrected, row.effect_size))
    assert (row.mark, row.effect_size_kind) == ("", "")


def test_pair_is_marked_by_the_p_value_after_the_correction() -> None:
    tests = [
        TTest(2.0, 1.0, 0.5, 1.5, 4.0, 11.0, p, EffectSize(1.0, 0.5, 1.5, "d"))
        for p in (0.04, 0.5, 0.0001)
    ]
    names = ("strong", "weak", "gentle")
    pairs = [
        PairTest(name, "manual", test, 12, 12)
        for name, test in zip(names, tests, strict=True)
    ]
    rows = pair_rows("overshoot", "within", pairs)
    assert [row.p_corrected for row in rows] == pytest.approx([0.06, 0.5, 0.0003])
    assert [row.mark for row in rows] == ["", "", "***"]
    assert [row.mean_difference for row in rows] == [1.0, 1.0, 1.0]


def test_empty_notes_leave_no_trace() -> None:
    assert joined("", "one", "", "two") == "one; two"
    assert joined("", "") == ""
