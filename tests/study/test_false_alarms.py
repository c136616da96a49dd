"""How often each set of tests finds an effect that is not there."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from costeer.study.anova import FTest, pooled_f_tests
from costeer.study.contrasts import one_way
from costeer.study.repeated import repeated_f_test

pytestmark = pytest.mark.slow

NUM_STUDIES = 1000


def false_alarms(person: float, own_reaction: float, seed: int) -> tuple[float, float]:
    """Share of studies without a true effect in which p < 0.05.

    Args:
        person: Deviation between participants, over that between lane changes of one.
        own_reaction: Deviation of what a condition does to each participant, likewise.
        seed: Of the data.

    Returns:
        The share of the published test and that of the test within subjects.
    """
    rng = np.random.default_rng(seed)
    (effect,) = one_way("condition", 7)
    cells = np.tile(np.repeat(np.arange(7), 8), 12)
    pooled = within = 0
    for _ in range(NUM_STUDIES):
        mean = person * rng.normal(size=(12, 1)) + own_reaction * rng.normal(
            size=(12, 7)
        )
        values = mean[:, :, None] + rng.normal(size=(12, 7, 8))
        (test,) = pooled_f_tests(values.ravel(), cells, (effect,))
        pooled += p_value(test) < 0.05
        within += p_value(repeated_f_test(values.mean(axis=2), effect)) < 0.05
    return pooled / NUM_STUDIES, within / NUM_STUDIES


def p_value(test: FTest) -> float:
    df1, df2 = test.epsilon * test.df1, test.epsilon * test.df2
    return float(stats.f.sf(test.statistic, df1, df2))


# A share of 0.05 of 1,000 studies has a standard error of 0.007; three are allowed.
NOMINAL = 0.05 + 0.021


def test_pooling_sees_effects_where_participants_react_in_their_own_ways() -> None:
    pooled, within = false_alarms(person=1.0, own_reaction=0.5, seed=1)
    assert pooled > 0.15
    assert within < NOMINAL


def test_pooling_overlooks_effects_where_participants_merely_differ() -> None:
    pooled, within = false_alarms(person=1.0, own_reaction=0.0, seed=2)
    assert pooled < 0.01
    assert within < NOMINAL
