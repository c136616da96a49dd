"""The table of what adapting gives: same drivers in each row, all asked once."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.adaptation import ADAPTED, asked_once, difference, row, rows
from costeer.intention.gru import random_weights
from costeer.training.adapt import beside
from costeer.training.adaptation import DEFAULTS
from costeer.training.left_out import parts
from tests.training.synthetic import drives


def test_a_recording_is_asked_once() -> None:
    asked: list[int] = []

    def predict(
        features: NDArray[np.float64], absent: tuple[str, ...] = ()
    ) -> NDArray[np.float64]:
        asked.append(len(features))
        return np.zeros(len(features))

    one, other = np.zeros((4, 6)), np.zeros((7, 6))
    remembers = asked_once(predict)
    lengths = [len(remembers(each, ())) for each in (one, other, one)]
    assert lengths == [4, 7, 4]
    assert asked == [4, 7]


def test_a_difference_is_named_by_its_interval() -> None:
    def scores(low: float, high: float) -> dict[str, object]:
        ends = {f"minus_{ADAPTED}_interval_95": {"pr_auc": [low, high]}}
        return {"pr_auc": 0.5, **ends}

    first = {"pr_auc": 0.6}
    assert difference(first, scores(-0.3, -0.1)).endswith("worse")
    assert difference(first, scores(0.1, 0.2)).endswith("better")
    assert difference(first, scores(-0.1, 0.2)).endswith("undecided")
    assert difference(first, {"pr_auc": 0.5}) == ""


@pytest.mark.usefixtures("few_resamplings")
@pytest.mark.slow  # adapts in four folds
def test_every_row_is_judged_on_the_same_drivers() -> None:
    parameters = DEFAULTS._replace(
        fit=DEFAULTS.fit._replace(num_steps=0), outer_folds=4, false_per_km=50.0
    )
    whole = parts(drives(8, num_changes=2))
    found = rows(random_weights(3, seed=1), whole, parameters)
    assert next(iter(found)) == ADAPTED
    for said in found.values():
        assert [one.verdicts.driver for one in said] == whole.names
    table = beside(found, whole.kind)
    assert row("time to the line, adapted", table).count("|") == 8
