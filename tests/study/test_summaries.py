from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from costeer.study.outcome import StudyTests, SummaryRow
from costeer.study.statistics import study_tests
from tests.study.made_up_study import made_up_study, usual_outcome


def summary(found: StudyTests, measure: str, analysis: str, level: str) -> SummaryRow:
    (row,) = (
        row
        for row in found.summaries
        if (row.measure, row.analysis, row.level) == (measure, analysis, level)
        and (row.factor == "strength") == (level in ("strong", "weak"))
    )
    return row


def test_interval_is_students_interval_of_the_mean() -> None:
    _, changes = made_up_study()
    row = summary(usual_outcome(), "overshoot", "published", "weak-rapid")
    values = changes["overshoot"][changes["condition"] == "weak-rapid"].astype(float)
    expected = stats.ttest_1samp(values, 0.0).confidence_interval(0.95)
    assert row.n == 96
    assert (row.mean, row.sd) == pytest.approx((values.mean(), values.std(ddof=1)))
    assert (row.low, row.high) == pytest.approx((expected.low, expected.high))


def test_participants_mean_takes_all_values_of_a_strength() -> None:
    trials, _ = made_up_study()
    row = summary(usual_outcome(), "sdlp", "within", "strong")
    strong = np.char.startswith(trials["condition"].astype(str), "strong")
    means = trials["sdlp"][strong].astype(float).reshape(12, 3).mean(axis=1)
    assert (row.n, row.mean, row.sd) == pytest.approx(
        (12, means.mean(), means.std(ddof=1))
    )


def test_single_value_has_no_interval_and_says_so() -> None:
    row = summary(study_tests(*made_up_study(1)), "sdlp", "within", "weak-rapid")
    assert (row.n, row.note) == (1, "one value: no interval")
    assert math.isfinite(row.mean)
    assert math.isnan(row.low)
