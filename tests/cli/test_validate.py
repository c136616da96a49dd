"""Numbers on the command line are checked before anything runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st

from costeer.cli import validate

Callback = Callable[[Any], Any]

MAKERS: list[tuple[Callback, Any, Any, str]] = [
    (validate.positive("m/s"), 0.1, 0.0, "above 0 m/s"),
    (validate.at_least(1), 1, 0, "at least 1"),
    (validate.in_range(0, 2, "m"), 2.0, 2.1, "from 0 to 2 m"),
    (validate.fraction(), 1.0, -0.1, "from 0 to 1"),
    (validate.finite("m"), -5.0, math.nan, "a finite number m"),
    (validate.one_of(("weak", "strong")), "weak", "medium", "one of weak, strong"),
]


@pytest.mark.parametrize(("callback", "good", "bad", "allowed"), MAKERS)
def test_good_value_passes_and_bad_is_named(
    callback: Callback, good: object, bad: object, allowed: str
) -> None:
    assert callback(good) == good
    with pytest.raises(typer.BadParameter) as refusal:
        callback(bad)
    assert str(refusal.value) == f"{bad} is not allowed; give {allowed}."


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("callback", [case[0] for case in MAKERS[:5]])
def test_no_number_may_be_infinite_or_nan(callback: Callback, value: float) -> None:
    with pytest.raises(typer.BadParameter):
        callback(value)


@pytest.mark.parametrize("callback", [case[0] for case in MAKERS])
def test_an_option_that_is_not_given_passes(callback: Callback) -> None:
    assert callback(None) is None
    assert callback([]) == []


@given(st.lists(st.floats(0.0, 1.0)), st.floats(1.0, exclude_min=True))
def test_one_bad_member_of_a_repeated_option_is_refused(
    good: list[float], bad: float
) -> None:
    assert validate.fraction()(good) == good
    with pytest.raises(typer.BadParameter):
        validate.fraction()([*good, bad])


def test_words_are_no_numbers() -> None:
    with pytest.raises(typer.BadParameter, match="give a number"):
        validate.positive()("ten")
