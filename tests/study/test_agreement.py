"""People beside virtual drivers: intervals by closed forms of others."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from costeer.study.agreement import (
    agreement,
    prediction_half_width,
    welch_half_width,
)
from costeer.study.material import StudyMaterial

pytestmark = pytest.mark.slow


def test_the_interval_of_a_difference_is_that_of_scipy() -> None:
    rng = np.random.default_rng(1)
    first, second = rng.normal(0.0, 1.0, 7), rng.normal(1.0, 3.0, 15)
    wanted = stats.ttest_ind(first, second, equal_var=False).confidence_interval(0.95)
    sizes = [(float(each.std(ddof=1)), each.size) for each in (first, second)]
    half = welch_half_width(*sizes)
    assert 2.0 * half == pytest.approx(wanted.high - wanted.low)


def test_a_prediction_holds_as_often_as_it_says() -> None:
    rng = np.random.default_rng(2)
    inside = 0
    for _ in range(4000):
        known, new = rng.normal(5.0, 2.0, 8), rng.normal(5.0, 2.0, 5)
        reach = prediction_half_width(float(known.std(ddof=1)), 8, 5)
        inside += abs(known.mean() - new.mean()) <= reach
    # Four standard errors of a share of 0.95 in 4,000.
    assert inside / 4000 == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / 4000))


def test_single_drivers_give_no_interval() -> None:
    assert math.isnan(welch_half_width((0.0, 1), (1.0, 5)))
    assert math.isnan(prediction_half_width(math.nan, 1, 5))


def test_a_study_agrees_with_itself(material: StudyMaterial) -> None:
    rows = agreement(material, material)
    assert len(rows) == 7 * 7
    assert {row.difference for row in rows} == {0.0}
    assert {row.inside for row in rows} == {True}
    assert [row.correlation for row in rows] == pytest.approx([1.0] * 49)
    sdlp = material.trials.loc[material.trials["condition"] == "manual", "sdlp"]
    first = rows[0]
    assert (first.measure, first.condition, first.n_people) == ("sdlp", "manual", 3)
    assert first.mean_people == pytest.approx(float(sdlp.mean()))
    # Three known and three new: t of 2 degrees of freedom is 4.302653.
    reach = 4.302653 * float(sdlp.std()) * math.sqrt(2.0 / 3.0)
    assert first.prediction_high - first.mean_virtual == pytest.approx(reach, rel=1e-6)


def test_means_that_lie_apart_are_outside(material: StudyMaterial) -> None:
    shifted = material.tests._replace(
        summaries=tuple(
            row._replace(mean=row.mean + 100.0 * row.sd)
            for row in material.tests.summaries
        )
    )
    rows = agreement(material._replace(tests=shifted), material)
    assert {row.inside for row in rows} == {False}
    assert all(row.difference_low > 0.0 for row in rows)
