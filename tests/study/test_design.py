"""The Latin square is balanced in place and in what comes before what."""

from __future__ import annotations

import itertools
from collections import Counter

import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.design import (
    condition_order,
    guided_before,
    plan_trials,
    rows_needed,
    williams_square,
)

SIZES = range(2, 9)


@pytest.mark.parametrize("size", SIZES)
def test_every_row_holds_every_condition_once(size: int) -> None:
    for row in williams_square(size):
        assert sorted(row) == list(range(size))


@pytest.mark.parametrize("size", SIZES)
def test_every_condition_stands_equally_often_in_every_place(size: int) -> None:
    rows = williams_square(size)
    for place in range(size):
        counts = Counter(row[place] for row in rows)
        assert set(counts.values()) == {len(rows) // size}
        assert len(counts) == size


@pytest.mark.parametrize("size", SIZES)
def test_every_condition_follows_every_other_equally_often(size: int) -> None:
    rows = williams_square(size)
    pairs = Counter(pair for row in rows for pair in itertools.pairwise(row))
    assert len(pairs) == size * (size - 1)
    # An even square suffices alone; an odd one needs its mirror image too.
    assert set(pairs.values()) == {1 if size % 2 == 0 else 2}


def test_a_square_of_one_is_one_row() -> None:
    assert williams_square(1) == ((0,),)


@pytest.mark.parametrize("size", [0, 9])
def test_a_size_out_of_range_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match=f"1 to 8 conditions, not {size}"):
        williams_square(size)


def test_manual_always_comes_first() -> None:
    for participant in range(1, 13):
        assert condition_order(participant, CONDITION_NAMES)[0] == "manual"


def test_twelve_participants_go_through_the_square_twice() -> None:
    orders = [condition_order(p, CONDITION_NAMES) for p in range(1, 13)]
    assert orders[:6] == orders[6:]
    assert len(set(orders[:6])) == 6


def test_assisted_trials_of_twelve_are_balanced_in_place() -> None:
    trials = plan_trials(12, CONDITION_NAMES)
    counts = Counter((t.condition, t.order) for t in trials if t.order > 1)
    assert len(counts) == 36
    assert set(counts.values()) == {2}


def test_what_was_learnt_before_a_trial_follows_from_its_place() -> None:
    # Manual, then the practice of 300 s, then trials of 400 s each.
    day = plan_trials(1, CONDITION_NAMES)
    before = [guided_before(trial, CONDITION_NAMES, 400.0) for trial in day]
    assert before == [300.0, 300.0, 700.0, 1100.0, 1500.0, 1900.0, 2300.0]


def test_without_manual_the_first_trial_follows_the_practice() -> None:
    conditions = ("strong-rapid", "weak-rapid")
    day = plan_trials(2, conditions)
    before = [guided_before(trial, conditions, 50.0) for trial in day]
    assert before == [300.0, 350.0, 300.0, 350.0]


def test_the_order_does_not_depend_on_how_conditions_are_listed() -> None:
    listed = ("weak-rapid", "manual", "strong-gentle")
    assert condition_order(2, listed) == condition_order(2, tuple(sorted(listed)))


def test_manual_alone_is_one_trial_each() -> None:
    assert [t.condition for t in plan_trials(3, ("manual",))] == ["manual"] * 3


def test_without_manual_the_square_starts_at_once() -> None:
    assert condition_order(1, ("strong-rapid",)) == ("strong-rapid",)


def test_whole_squares_take_a_multiple_of_their_rows() -> None:
    assert rows_needed(CONDITION_NAMES) == 6
    assert rows_needed(("manual",)) == 1
    # Three assisted conditions take the square and its mirror image.
    assert rows_needed(CONDITION_NAMES[:4]) == 6
