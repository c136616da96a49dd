"""Names of the conditions, and what a wrong one leads to."""

from __future__ import annotations

import math

import pytest

from costeer.methods.conditions import (
    CONDITION_NAMES,
    check_conditions,
    condition,
    parse_conditions,
)


def test_the_seven_conditions_are_those_of_table_4() -> None:
    assert CONDITION_NAMES == (
        "manual",
        "strong-rapid",
        "strong-normal",
        "strong-gentle",
        "weak-rapid",
        "weak-normal",
        "weak-gentle",
    )


def test_strength_and_duration_follow_from_the_name() -> None:
    weak_gentle = condition("weak-gentle")
    assert weak_gentle.strength_factor == 0.4
    assert weak_gentle.change_duration == 8.0
    assert condition("strong-rapid").strength_factor == 1.0
    assert condition("strong-rapid").change_duration == 4.0


def test_manual_has_no_strength_and_no_duration() -> None:
    manual = condition("manual")
    assert manual.strength_factor == 0.0
    assert math.isnan(manual.change_duration)


def test_conditions_come_out_in_the_order_of_the_table() -> None:
    assert parse_conditions("weak-rapid, manual") == ("manual", "weak-rapid")


def test_all_means_all() -> None:
    assert parse_conditions(" all ") == CONDITION_NAMES


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("strong-fast", r"unknown condition 'strong-fast' .*choose from manual, "),
        ("weak-gentel", r"did you mean weak-gentle\?"),
        ("manual,manual", "manual is given twice"),
        (",", "no condition given; choose from manual"),
    ],
)
def test_a_wrong_list_is_refused(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        parse_conditions(text)


def test_no_guess_is_made_for_a_word_unlike_all() -> None:
    with pytest.raises(ValueError, match=r"unknown condition 'x'; choose from"):
        check_conditions(["x"])
