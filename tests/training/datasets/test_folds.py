"""Cross-validation by driver."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.intention.features import NUM_FEATURES
from costeer.training.datasets.folds import folds
from costeer.training.labels import Labels
from costeer.training.recordings import Recording


def recordings(lengths: list[int]) -> list[Recording]:
    """Two recordings of each driver."""
    return [
        Recording(
            driver=f"d{k // 2}",
            name=f"{k}",
            features=np.zeros((length, NUM_FEATURES)),
            side=np.ones(length, np.int8),
            crossing=np.zeros(length, np.int8),
            intended=np.zeros(length, np.int8),
            labels=Labels(np.zeros(length, bool), np.ones(length, bool)),
        )
        for k, length in enumerate(lengths)
    ]


@given(
    st.lists(st.integers(1, 50), min_size=6, max_size=40), st.integers(2, 3), st.just(1)
)
def test_every_recording_is_judged_once_and_no_driver_is_split(
    lengths: list[int], num: int, seed: int
) -> None:
    every = recordings(lengths)
    dealt = folds(every, num, seed)
    assert sorted(r.name for _, judged in dealt for r in judged) == sorted(
        r.name for r in every
    )
    for trained, judged in dealt:
        assert len(trained) + len(judged) == len(every)
        assert not {r.driver for r in trained} & {r.driver for r in judged}


def test_folds_are_about_as_long_as_each_other() -> None:
    dealt = folds(recordings([10, 10, 30, 30, 20, 20, 40, 40]), 2, 1)
    assert [sum(len(r.side) for r in judged) for _, judged in dealt] == [100, 100]


def test_the_same_seed_deals_the_same_and_another_does_not() -> None:
    every = recordings([5] * 40)
    names = [[r.name for r in judged] for _, judged in folds(every, 4, 1)]
    assert names == [[r.name for r in judged] for _, judged in folds(every, 4, 1)]
    assert names != [[r.name for r in judged] for _, judged in folds(every, 4, 2)]


@pytest.mark.parametrize("num", [1, 4])
def test_more_folds_than_drivers_and_one_fold_are_refused(num: int) -> None:
    with pytest.raises(ValueError, match=rf"{num} folds of 3 driver.*at least 2"):
        folds(recordings([5] * 6), num, 1)
