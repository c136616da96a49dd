"""Which windows are fitted on, and what stands in their rows."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.features import FEATURES, HEAD_YAW
from costeer.intention.predictors.variants import signals_of
from costeer.training.dataset import DatasetParameters
from costeer.training.labels import time_to_crossing
from costeer.training.predictors.samples import (
    ALL_COLUMNS,
    Answers,
    Table,
    chosen_rows,
    columns_of,
    feature_scaling,
    number_scaling,
    summary_table,
    table,
    thinned,
    with_columns,
)
from tests.training.synthetic import drive

DATASET = DatasetParameters()


def test_time_to_crossing_counts_down_to_the_next_one() -> None:
    crossing = np.array([0, 0, 0, -1, 0, 0, 1, 0], np.int8)
    side = np.array([-1, -1, -1, 1, 1, -1, -1, -1], np.int8)
    time = time_to_crossing(crossing, side)
    expected = [3.0, 2.0, 1.0, 3.0, 2.0, np.inf, np.inf, np.inf]
    np.testing.assert_allclose(time * 60.0, expected)


def test_time_to_crossing_agrees_with_the_labels() -> None:
    one = drive(3)
    time = time_to_crossing(one.crossing, one.side)
    np.testing.assert_array_equal(time <= 3.0, one.labels.positive)


def test_weights_make_up_for_what_is_left_out() -> None:
    rows, answers = chosen_rows(drive(1), DATASET)
    assert (rows >= 179).all()
    assert set(np.unique(answers.weight)) == {1.0, 3.0}
    # Each window stands for its stride: six samples, or eighteen.
    assert answers.weight.sum() * 6.0 == pytest.approx(rows[-1] - 179, rel=0.05)


def test_rows_without_a_signal_are_left_out() -> None:
    seen = drive(1)
    features = seen.features.copy()
    features[2000:, HEAD_YAW] = np.nan
    lost = seen._replace(features=features)
    scaling = feature_scaling([seen])
    data = summary_table([lost], scaling, DATASET)
    assert data.numbers.shape[1] == len(ALL_COLUMNS)
    full = with_columns(data, columns_of(FEATURES))
    headless = with_columns(data, columns_of(signals_of("no-head")))
    assert len(full.numbers) < len(headless.numbers) == len(data.numbers)
    absent = seen._replace(absent=("head_yaw",))
    blind = summary_table([absent], scaling, DATASET)
    assert len(with_columns(blind, columns_of(FEATURES)).numbers) == 0


def test_a_signal_that_is_never_there_has_no_scale() -> None:
    scaling = feature_scaling([drive(1)._replace(absent=("head_yaw",))])
    assert (scaling.mean[HEAD_YAW], scaling.scale[HEAD_YAW]) == (0.0, 1.0)
    assert (scaling.scale > 0.0).all()


def test_columns_are_scaled_by_weight() -> None:
    numbers = np.array([[0.0, 2.0], [4.0, 2.0]])
    mean, scale = number_scaling(numbers, np.array([3.0, 1.0]))
    np.testing.assert_allclose(mean, [1.0, 2.0])
    np.testing.assert_allclose(scale, [np.sqrt(3.0), 1.0])


def test_one_class_teaches_nothing() -> None:
    answers = Answers(np.zeros(3, bool), np.ones(3))
    with pytest.raises(ValueError, match="both kinds are needed"):
        table([np.zeros((3, 1))], [answers])


def test_thinning_keeps_rows_with_their_answers() -> None:
    numbers = np.arange(10.0)[:, None]
    data = Table(numbers, Answers(np.arange(10) % 2 == 0, np.arange(10.0)))
    kept = thinned(data, seed=1, most=4)
    assert len(kept.numbers) == 4
    np.testing.assert_array_equal(kept.numbers[:, 0], kept.answers.weight)
    np.testing.assert_array_equal(thinned(data, 1, 99).numbers, numbers)
