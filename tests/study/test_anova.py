from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.formula.api import ols
from statsmodels.stats.anova import anova_lm

from costeer.study.anova import pooled_f_tests
from costeer.study.contrasts import one_way, two_way

# R's data set PlantGrowth: dry weight of plants under a control and two treatments.
PLANT_GROWTH = (
    (4.17, 5.58, 5.18, 6.11, 4.50, 4.61, 5.17, 4.53, 5.33, 5.14),
    (4.81, 4.17, 4.41, 3.59, 5.87, 3.83, 6.03, 4.89, 4.32, 4.69),
    (6.31, 5.12, 5.54, 5.50, 5.37, 5.29, 4.92, 6.15, 5.80, 5.26),
)


def test_one_way_is_that_of_r() -> None:
    # R: summary(aov(weight ~ group, data = PlantGrowth)) prints F 4.846, p 0.0159.
    cells = np.repeat(np.arange(3), 10)
    (test,) = pooled_f_tests(np.ravel(PLANT_GROWTH), cells, one_way("group", 3))
    assert (test.df1, test.df2) == (2.0, 27.0)
    assert test.statistic == pytest.approx(4.846, abs=5e-4)
    assert stats.f.sf(test.statistic, 2, 27) == pytest.approx(0.0159, abs=5e-5)


@pytest.mark.parametrize("seed", range(5))
def test_one_way_of_unequal_groups_equals_scipy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    groups = [rng.normal(0.3 * i, size=rng.integers(2, 40)) for i in range(7)]
    cells = np.repeat(np.arange(7), [group.size for group in groups])
    (test,) = pooled_f_tests(np.concatenate(groups), cells, one_way("condition", 7))
    assert test.statistic == pytest.approx(stats.f_oneway(*groups).statistic, rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_two_way_of_unequal_cells_equals_type_iii_of_statsmodels(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(2, 20, size=6)
    cells = np.repeat(np.arange(6), counts)
    values = rng.normal(size=cells.size) + 0.3 * cells
    frame = pd.DataFrame({"y": values, "a": cells // 3, "b": cells % 3})
    fit = ols("y ~ C(a, Sum) * C(b, Sum)", frame).fit()
    expected = anova_lm(fit, typ=3)["F"].to_numpy()[1:4]
    tests = pooled_f_tests(values, cells, two_way("a", 2, "b", 3))
    assert [test.df1 for test in tests] == [1.0, 2.0, 2.0]
    assert {test.df2 for test in tests} == {float(cells.size - 6)}
    np.testing.assert_allclose([test.statistic for test in tests], expected, rtol=1e-10)


def test_empty_cell_gives_a_reason() -> None:
    cells = np.array([0, 0, 1, 1, 2, 2])
    for test in pooled_f_tests(np.arange(6.0), cells, two_way("a", 2, "b", 2)):
        assert math.isnan(test.statistic)
        assert test.note == "a cell is empty"


@pytest.mark.parametrize(
    ("values", "cells", "levels", "reason"),
    [
        ([], [], 3, "a cell is empty"),
        ([1.0, 2.0], [0, 0], 1, "fewer than two levels"),
        ([1.0, 2.0], [0, 1], 2, "one value per cell"),
        ([0.1] * 6, [0, 0, 0, 1, 1, 1], 2, "no variance within"),
        ([0.1] * 3 + [0.7] * 3, [0, 0, 0, 1, 1, 1], 2, "no variance within"),
    ],
)
def test_data_without_an_answer_give_a_reason(
    values: list[float], cells: list[int], levels: int, reason: str
) -> None:
    tests = pooled_f_tests(
        np.array(values), np.array(cells, dtype=np.intp), one_way("condition", levels)
    )
    assert math.isnan(tests[0].statistic)
    assert reason in tests[0].note
