"""The truth the network learns: a crossing to the adjacent side within 3 s."""

from __future__ import annotations

import numpy as np

from costeer.training.labels import crossings, labels


def crossing_at(row: int, side: int, length: int = 600) -> np.ndarray:
    crossing = np.zeros(length, np.int8)
    crossing[row] = side
    return crossing


def test_the_three_seconds_before_a_crossing_are_positive() -> None:
    truth = labels(crossing_at(400, -1), np.full(600, -1, np.int8))
    np.testing.assert_array_equal(np.flatnonzero(truth.positive), np.arange(220, 400))


def test_a_crossing_to_the_other_side_is_none() -> None:
    truth = labels(crossing_at(400, 1), np.full(600, -1, np.int8))
    assert not truth.positive.any()


def test_the_end_is_known_only_where_a_crossing_follows() -> None:
    quiet = labels(np.zeros(600, np.int8), np.full(600, -1, np.int8))
    np.testing.assert_array_equal(quiet.known, np.arange(600) < 420)
    ended = labels(crossing_at(599, -1), np.full(600, -1, np.int8))
    assert ended.known[419:599].all()
    assert not ended.known[599]


def test_only_the_next_crossing_counts() -> None:
    crossing = crossing_at(300, -1)
    crossing[360] = 1
    side = np.where(np.arange(600) < 300, -1, 1).astype(np.int8)
    truth = labels(crossing, side)
    np.testing.assert_array_equal(np.flatnonzero(truth.positive), np.arange(120, 360))


def test_labels_agree_with_a_search_sample_by_sample() -> None:
    rng = np.random.default_rng(3)
    crossing = rng.choice(np.array([-1, 0, 1], np.int8), 3000, p=[0.002, 0.996, 0.002])
    side = rng.choice(np.array([-1, 1], np.int8), 3000)
    truth = labels(crossing, side)
    for row in range(3000):
        ahead = np.flatnonzero(crossing[row + 1 : row + 181])
        positive = ahead.size > 0 and crossing[row + 1 + ahead[0]] == side[row]
        assert truth.positive[row] == positive
        assert truth.known[row] == (ahead.size > 0 or row + 180 < 3000)


def test_a_crossing_is_the_first_sample_in_the_new_lane() -> None:
    lane = np.array([1, 1, 0, 0, 1, 1], np.int8)
    np.testing.assert_array_equal(crossings(lane), [0, 0, -1, 0, 1, 0])
